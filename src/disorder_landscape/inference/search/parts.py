"""Wires that have V from others, except for a part: drawn anew, another wire's, or moved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.search.wires import Wire, best_of
from disorder_landscape.model.parameters import FloatArray, hopping

BEST = 0.6
"""How often the best wire gets another part, and not any of them."""
KINETIC = 3.0, 7.0
"""Kinetic energies of the wavelength by half of which parts move, in standard deviations of V. (Of
two wires V was right at one end, and behind a well 2 meV too deep it was seven sites too far from
there for more than 100 sites. Small steps do not change that. After such a move of one of them they
led to the true V from three starts of eight.)"""
ENDS = 0.4
"""How often the wire of the best left end then gets the right end of the wire of the best one."""
LEAST_END = 0.15
"""In shares of the wire. Ends are no shorter."""
DEPTH = 0.55
"""Parts that are drawn anew are in this share of the wire, from one end on: …"""
LEAST_EXCESS = 0.02
"""… more often from the one whose conductance is explained worse. Misfits are the noise's up to
this excess of their mean square."""
KEPT = 0.03
"""V of the other sites may differ by this at first, in standard deviations of the prior."""


class Cut(NamedTuple):
    """How parts are cut: the least and the most of each length, in shares of the wire."""

    redrawn: tuple[float, float]
    """What is drawn anew."""
    taken: tuple[float, float]
    """What is another wire's, or moves, …"""
    seam: tuple[float, float]
    """… and what is free on either side of its ends."""
    held: float
    """All other V may change by this, in standard deviations of the prior."""


class Start(NamedTuple):
    """Where steps start that change one part, above all."""

    x: FloatArray
    """The unknowns, shape (unknown,)."""
    prior: Gaussian
    """Of all unknowns, given those that are to change little."""


class Given(NamedTuple):
    """V (site,) and the unknowns (unknown,) of a wire, and which sites are free."""

    V: FloatArray
    x: FloatArray
    free: NDArray[np.bool_]


Kind = Callable[[Unknowns, Sequence[Wire], Cut, np.random.Generator], Given]
"""What gives one of the wires another part."""


def with_another_part(
    kind: Kind, unknowns: Unknowns, wires: Sequence[Wire], cut: Cut, rng: np.random.Generator
) -> Start:
    """Return a start at one of the wires with another part: drawn from the prior given the rest."""
    given = kind(unknowns, wires, cut, rng)
    x = _prior_given(unknowns, given, KEPT).draw_apart(rng, 1)[0]
    return Start(x, _prior_given(unknowns, given, cut.held))


def redrawn(unknowns: Unknowns, wires: Sequence[Wire], cut: Cut, rng: np.random.Generator) -> Given:
    """Free a part of one wire, where its data say that V may be wrong."""
    wire = _one_of(wires, rng)
    left, right = (max(end - 1, LEAST_EXCESS) for end in wire.ends)
    depth, half = DEPTH * rng.random(), _length(cut.redrawn, rng) / 2
    middle = depth if rng.random() < left / (left + right) else 1 - depth
    V = unknowns.potential(wire.x)
    return Given(V, wire.x, _between(V.size, middle - half, middle + half))


def exchanged(
    unknowns: Unknowns, wires: Sequence[Wire], cut: Cut, rng: np.random.Generator
) -> Given:
    """Put a part of one wire into another, and free the sites about its ends."""
    if rng.random() < ENDS:
        wire, other = (min(wires, key=lambda one: one.ends[end]) for end in range(2))
        begin, end = rng.uniform(LEAST_END, 1 - LEAST_END), 1.0
    else:
        wire, length = _one_of(wires, rng), _length(cut.taken, rng)
        other = wires[int(rng.integers(len(wires)))]
        begin = rng.uniform(-length, 1.0)
        end = begin + length
    V, seam = unknowns.potential(wire.x), _length(cut.seam, rng)
    taken = _between(V.size, begin, end)
    V[taken] = unknowns.potential(other.x)[taken]
    return Given(V, wire.x, _about(V.size, begin, seam) | _about(V.size, end, seam))


def moved(unknowns: Unknowns, wires: Sequence[Wire], cut: Cut, rng: np.random.Generator) -> Given:
    """Move a part of one wire half a wavelength into a deep well at its end; free both ends."""
    wire, length, seam = _one_of(wires, rng), rng.uniform(*cut.taken), _length(cut.seam, rng)
    V, prior = unknowns.potential(wire.x), unknowns.prior
    kinetic = rng.uniform(*KINETIC) * unknowns.site_std(unknowns.white_noise.covariance)
    by = round(np.pi * np.sqrt(hopping(prior.mass, prior.lattice) / kinetic))
    odds = np.maximum(-V, 0.0) ** 4 + np.finfo(np.float64).tiny
    well = (rng.choice(V.size, p=odds / odds.sum()) + 0.5) / V.size
    towards = rng.choice([-1, 1])
    begin, end = sorted((well, well - towards * length))
    taken = _between(V.size, begin + towards * by / V.size, end + towards * by / V.size)
    from_there = np.clip(np.arange(V.size) - towards * by, 0, V.size - 1)
    reach = seam + by / V.size
    free = _about(V.size, begin, reach) | _about(V.size, end, reach)
    return Given(np.where(taken, V[from_there], V), wire.x, free)


def _one_of(wires: Sequence[Wire], rng: np.random.Generator) -> Wire:
    if rng.random() < BEST:
        return best_of(wires)
    return wires[int(rng.integers(len(wires)))]


def _length(least_and_most: tuple[float, float], rng: np.random.Generator) -> float:
    """Draw a length: as often from one to two times the least as from two to four times."""
    return float(np.exp(rng.uniform(*np.log(least_and_most))))


def _between(sites: int, begin: float, end: float) -> NDArray[np.bool_]:
    """Return which sites are between these shares of the wire, shape (site,)."""
    at = (np.arange(sites) + 0.5) / sites
    return (begin < at) & (at < end)


def _about(sites: int, end: float, reach: float) -> NDArray[np.bool_]:
    """Return which sites are about the end of a part, shape (site,): none if it is the wire's."""
    return _between(sites, end - reach, end + reach) & (0 < end < 1)


def _prior_given(unknowns: Unknowns, given: Given, held: float) -> Gaussian:
    """Return the prior of all unknowns, given V of the sites that are not free, and parameters.

    All of these may change by `held` standard deviations of the prior.
    """
    prior, n = unknowns.white_noise, unknowns.of_disorder
    error = held * unknowns.site_std(prior.covariance)
    sites, parameters = unknowns.to_potential[~given.free], np.eye(given.x.size - n)
    known = block_diag(sites / error, parameters / held)
    value = np.concatenate([given.V[~given.free] / error, given.x[n:] / held])
    precision = np.linalg.inv(prior.covariance)
    covariance = np.linalg.inv(precision + known.T @ known)
    mean = covariance @ (known.T @ value + precision @ prior.mean)
    return Gaussian(mean, (covariance + covariance.T) / 2)
