"""Where observables are asked for: checked grids of μ, B and bias."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from numpy.typing import ArrayLike

from disorder_landscape.arguments import grid_in
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.model.ranges import B_RANGE, MU_RANGE

BELOW_GAP = 1 - 1e-6
"""Biases are at most this part of the gap: at the gap itself the self-energy diverges."""

Progress = Callable[[int, int], None]
"""Is told how much has just been done, and how much there is in all."""


def checked_mu_and_B(mu: ArrayLike, B: ArrayLike) -> dict[str, FloatArray]:
    """Return the grids of chemical potentials in meV and of fields in T.

    Raises
    ------
    ArgumentError
        If one is empty, unsorted or out of range.
    """
    return {"mu": grid_in("mu", mu, *MU_RANGE), "B": grid_in("B", B, *B_RANGE)}


def checked_grids(
    wires: Sequence[Nanowire], mu: ArrayLike, B: ArrayLike, bias: ArrayLike
) -> dict[str, FloatArray]:
    """Return these grids and that of biases in meV, below the gaps of all wires in all fields.

    Raises
    ------
    ArgumentError
        If one is empty, unsorted or out of range.
    """
    grids = checked_mu_and_B(mu, B)
    edge = BELOW_GAP * least_gap(wires, grids["B"])
    return {**grids, "bias": grid_in("bias", bias, -edge, edge, "meV")}


def least_gap(wires: Sequence[Nanowire], B: FloatArray) -> float:
    """Return the smallest gap in meV that a parent of these wires has in these fields in T."""
    return min(wire.in_field(abs(B).max()).delta0 for wire in wires)
