"""The wires of a population, and which of them stay."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from disorder_landscape.inference.problem.observation import Observation, objective, squared_misfits
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.model.parameters import FloatArray

STAY = 4, 2, 2
"""So many of the best wires stay, and of others those with the best left and right ends."""


@dataclass(frozen=True, eq=False)
class Wire:
    """One of a population."""

    x: FloatArray
    """The unknowns, shape (unknown,)."""
    data: FloatArray
    """Simulated, shape (datum,): few data, by which wires are compared."""
    objective: float
    """−2 log of its posterior density with these, up to a constant."""
    ends: tuple[float, float]
    """Mean square misfits of G_LL and of G_RR in units of the noise's."""

    @classmethod
    def at(cls, few: Observation, x: FloatArray) -> Wire:
        """Return the wire of unknowns (unknown,)."""
        y = few.simulate(x[None])[0]
        squares = squared_misfits(few, y)
        of_ends = [squares[few.channel == end] for end in range(2)]
        left, right = (float((of if of.size else squares).mean()) for of in of_ends)
        return cls(x, y, float(objective(few, x, y)), (left, right))


def objective_of(wire: Wire) -> float:
    """Return by what wires are compared."""
    return wire.objective


def best_of(wires: Sequence[Wire]) -> Wire:
    """Return the most probable wire."""
    return min(wires, key=objective_of)


def that_stay(unknowns: Unknowns, wires: Sequence[Wire], apart: float) -> list[Wire]:
    """Return the best of wires, and of others those with the best ends, none of them alike.

    Parameters
    ----------
    unknowns : Unknowns
    wires : sequence of Wire
    apart : float
        Wires are alike if their V differs by less, in standard deviations of the prior, root mean
        square over the sites; and their ends are if this is so of half of the wire.
    """
    least = apart * unknowns.site_std(unknowns.white_noise.covariance)
    half = unknowns.prior.sites // 2
    ends = partial(_misfit_of_end, 0), partial(_misfit_of_end, 1)
    ranks: list[Callable[[Wire], float]] = [objective_of, *ends]
    parts = [slice(None), slice(half), slice(half, None)]
    stay = list[Wire]()
    for rank, part, count in zip(ranks, parts, STAY, strict=True):
        most = len(stay) + count
        for wire in sorted(wires, key=rank):
            off = [unknowns.potential(one.x - wire.x)[part] for one in stay]
            if len(stay) < most and all(np.sqrt((V**2).mean()) >= least for V in off):
                stay.append(wire)
    return stay


def _misfit_of_end(end: int, wire: Wire) -> float:
    return wire.ends[end]
