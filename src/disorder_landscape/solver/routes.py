"""The two solvers behind one signature, and the wires they take."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.solver import compiled

BareConductance = Callable[[Sequence[Nanowire], FloatArray, FloatArray, FloatArray], FloatArray]
Determinant = Callable[[Sequence[Nanowire], FloatArray, FloatArray], FloatArray]


def solver_functions(
    name: str, theta: float = 0.0, dissipative: bool = False
) -> tuple[BareConductance, Determinant]:
    """Return `bare_conductance` and `reflection_determinant` of "fast" or "kwant" at the angle θ.

    The determinant is that of wires without dissipation. Kwant is imported only when it is asked
    for: it takes a second or two.
    """
    if name == "fast" and theta != 0:
        return (
            partial(compiled.tilted_conductance, theta=theta),
            partial(compiled.tilted_determinant, theta=theta),
        )
    if name == "fast":
        bare = compiled.complex_conductance if dissipative else compiled.real_conductance
        return bare, compiled.reflection_determinant
    if name == "kwant":
        from disorder_landscape.solver import kwant_reference

        return (
            partial(kwant_reference.bare_conductance, theta=theta),
            partial(kwant_reference.reflection_determinant, theta=theta),
        )
    raise ArgumentError("solver", "be 'fast' or 'kwant'", f"it is {name!r}")


def wires_of(wire: Nanowire | Sequence[Nanowire]) -> list[Nanowire]:
    """Return a list of wires of equal length, of one wire or of several."""
    must = "be a Nanowire or a sequence of them of equal length"
    require(isinstance(wire, Nanowire | Iterable), "wire", must, f"it is {wire!r}")
    wires = [wire] if isinstance(wire, Nanowire) else list(wire)
    ok = bool(wires) and all(isinstance(w, Nanowire) for w in wires)
    require(ok, "wire", must, f"it is {type(wire).__name__!r} of {len(wires)}")
    lengths = sorted({w.sites for w in wires})
    require(len(lengths) == 1, "wire", must, f"they have {lengths} sites")
    return wires
