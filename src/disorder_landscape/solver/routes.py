"""How what is asked of a wire is solved: the only place that decides.

Bare conductances and det r come from the compiled core, which takes for each wire and energy the
arithmetic that it allows (core/bare.hpp), or from Kwant. Thermal averages are exact, in closed form
where they can be, or sums over a grid of energies, as the paper's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.arguments import ArgumentError, require, shown
from disorder_landscape.model.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.solver import compiled
from disorder_landscape.solver.quadrature import ThermalConductance, thermal_quadrature

SOLVERS = ("fast", "kwant")
BELOW_GAP: float = compiled.core.BELOW_GAP
"""Part of the gap up to which the thermal window is rational in energy all over."""
BLOCK_ENERGIES = {"fast": 2**18, "tilted": 2**14, "kwant": 2**8}
"""Energies that are solved at a time: about 16 MB and one second."""
BLOCK_SETS = {"fast": 2**12, "tilted": 2**9}
"""Sets (wire, μ, B) that are averaged exactly at a time: one or two seconds."""


def wires_of(wire: Nanowire | Sequence[Nanowire]) -> list[Nanowire]:
    """Return a list of wires of equal length, of one wire or of several."""
    must = "be a Nanowire or a sequence of them of equal length"
    try:
        wires = [wire] if isinstance(wire, Nanowire) else list(wire)
    except TypeError:
        raise ArgumentError("wire", must, f"it is {shown(wire)}") from None
    ok = bool(wires) and all(isinstance(w, Nanowire) for w in wires)
    require(ok, "wire", must, f"it is {type(wire).__name__!r} of {len(wires)}")
    lengths = sorted({w.sites for w in wires})
    require(len(lengths) == 1, "wire", must, f"they have {lengths} sites")
    return wires


def known_solver(name: str) -> str:
    """Return the name if it is one of SOLVERS."""
    known = isinstance(name, str) and name in SOLVERS
    require(known, "solver", "be 'fast' or 'kwant'", f"it is {shown(name)}")
    return name


def energies_at_once(solver: str, theta: float) -> int:
    """Return how many energies are solved in about a second."""
    return BLOCK_ENERGIES["tilted" if solver == "fast" and theta != 0 else solver]


def sets_at_once(theta: float) -> int:
    """Return how many sets (wire, μ, B) are averaged exactly in about a second."""
    return BLOCK_SETS["tilted" if theta != 0 else "fast"]


def bare_conductance(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    theta: float,
    solver: str = "fast",
) -> FloatArray:
    """Return the T = 0 conductances at ±ω, shape (wire, mu, B, omega, 2, 4), in e²/h."""

    def solve(some: Sequence[Nanowire], fields: FloatArray) -> tuple[FloatArray]:
        if solver == "fast":
            return (compiled.bare_conductance(some, mu, fields, omega, theta),)
        from disorder_landscape.solver import kwant_reference  # it takes a second to import

        return (kwant_reference.bare_conductance(some, mu, fields, omega, theta),)

    return in_fields(solve, wires, B, axis=2)[0]


def reflection_determinant(
    wires: Sequence[Nanowire], mu: FloatArray, B: FloatArray, theta: float, solver: str = "fast"
) -> FloatArray:
    """Return det r at ω = 0 of both ends of wires without dissipation, (wire, lead, mu, B)."""

    def solve(some: Sequence[Nanowire], fields: FloatArray) -> tuple[FloatArray]:
        if solver == "fast":
            return (compiled.reflection_determinant(some, mu, fields, theta),)
        from disorder_landscape.solver import kwant_reference

        return (kwant_reference.reflection_determinant(some, mu, fields, theta),)

    return in_fields(solve, wires, B, axis=3)[0]


def levels(
    wires: Sequence[Nanowire], mu: FloatArray, B: FloatArray, count: int, theta: float = 0.0
) -> FloatArray:
    """Return the lowest levels as `compiled.levels` does, shape (wire, mu, B, level)."""

    def solve(some: Sequence[Nanowire], fields: FloatArray) -> tuple[FloatArray]:
        return (compiled.levels(some, mu, fields, count, theta),)

    return in_fields(solve, wires, B, axis=2)[0]


def in_fields(
    solve: Callable[[Sequence[Nanowire], FloatArray], tuple[NDArray[Any], ...]],
    wires: Sequence[Nanowire],
    B: FloatArray,
    axis: int,
) -> tuple[NDArray[Any], ...]:
    """Return what is solved for all fields, one at a time where a gap depends on the field.

    Parameters
    ----------
    solve : callable
        Returns arrays for wires and fields.
    wires : sequence of Nanowire
    B : array, shape (B,)
    axis : int
        That of B in these arrays.
    """
    if all(np.isinf(wire.critical_field) for wire in wires):
        return solve(wires, B)
    each = [solve([w.in_field(float(b)) for w in wires], B[f : f + 1]) for f, b in enumerate(B)]
    return tuple(np.concatenate(parts, axis=axis) for parts in zip(*each, strict=True))


def thermal_average(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    bias: FloatArray,
    temperature: float,
    theta: float = 0.0,
) -> ThermalConductance:
    """Return the exact thermal average, its estimated error and the number of energies it took.

    In closed form where `closed_form_reaches`; by adaptive quadrature elsewhere, and for the rare
    set of which no model within the tolerance is found.
    """

    def solve(some: Sequence[Nanowire], fields: FloatArray) -> ThermalConductance:
        return _average(some, mu, fields, bias, temperature, theta)

    return ThermalConductance(*in_fields(solve, wires, B, axis=2))


def _average(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    bias: FloatArray,
    temperature: float,
    theta: float,
) -> ThermalConductance:
    """Return the average of wires whose gap does not depend on the field."""
    if not closed_form_reaches(wires, bias, temperature, theta):
        return thermal_quadrature(wires, mu, B, bias, temperature, theta=theta)
    G, error, energies = closed_form(wires, mu, B, bias, temperature, theta)
    for w, m, f in np.argwhere(~(error <= compiled.core.TOLERANCE)):
        point = [wires[w]], mu[m : m + 1], B[f : f + 1]
        one = thermal_quadrature(*point, bias, temperature, theta=theta)
        G[w, m, f], error[w, m, f] = one.conductance[0, 0, 0], one.error[0, 0, 0]
        energies[w, m, f] += one.energies[0, 0, 0]
    return ThermalConductance(G, error, energies)


def thermal_window(bias: FloatArray, temperature: float) -> float:
    """Return up to which energy in meV the core's closed form looks."""
    return float(abs(bias).max() + compiled.core.REACH * BOLTZMANN * temperature)


def stays_below_gap(wires: Sequence[Nanowire], bias: FloatArray, temperature: float) -> bool:
    """Return whether the thermal window stays below the gap of all wires."""
    return thermal_window(bias, temperature) <= BELOW_GAP * min(w.delta0 for w in wires)


def closed_form_reaches(
    wires: Sequence[Nanowire], bias: FloatArray, temperature: float, theta: float
) -> bool:
    """Return whether averages of some wires are taken in closed form.

    In a field along the wire those of all that are as dissipative as their parents; else of those
    without dissipation whose window stays below the gap.
    """
    if theta != 0:
        lossless = all(w.lossless for w in wires)
        return lossless and stays_below_gap(wires, bias, temperature)
    return all(w.dissipation == w.dissipation_of_parent for w in wires)


def closed_form(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    bias: FloatArray,
    temperature: float,
    theta: float,
) -> tuple[FloatArray, FloatArray, NDArray[np.int64]]:
    """Return the average of a rational model, its error (infinite without one) and energies.

    Where `closed_form_reaches`; shapes are those of `thermal_average`.
    """
    if theta == 0:
        return compiled.thermal_conductance(wires, mu, B, bias, temperature)
    from disorder_landscape.solver import tilted_average

    shape = len(wires), mu.size, B.size
    G, error = np.empty((*shape, bias.size, 4)), np.empty(shape)
    energies = np.empty(shape, dtype=np.int64)
    for w, wire in enumerate(wires):
        tilted = tilted_average.field_counts(wire, B, temperature)
        for f in np.flatnonzero(tilted):
            G[w, :, f], error[w, :, f], energies[w, :, f] = tilted_average.thermal_conductance(
                wire, mu, B[f], bias, temperature, theta
            )
        for f in np.flatnonzero(~tilted):
            straight = compiled.thermal_conductance([wire], mu, B[f : f + 1], bias, temperature)
            G[w, :, f], error[w, :, f], energies[w, :, f] = (part[0, :, 0] for part in straight)
    return G, error, energies
