"""An optimum of the posterior, and whether the noise explains the misfit there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import softmax

from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation, objective, squared_misfits
from disorder_landscape.inference.problem.straightened import Straightened
from disorder_landscape.model.parameters import FloatArray

TOLERATED = 3.5
"""χ² of all data, or of one channel's, may be this many of its standard deviations above its
mean."""
SAME_ANSWER = 2.0
"""Two optima are the same if they are closer than this many of their standard deviations, root mean
square over the principal axes, where the posterior is straight. (Where it bends they differ by
about one.)"""
AS_GOOD = 3.0
"""Starts have led to one optimum where they end with −2 log(posterior) no further apart than this.
(Ends that error bars allow to be the same may be 80 apart where there are 150 unknowns.)"""
NEGLIGIBLE = 1e-3
"""Optima with less than this share of the posterior are left out of it."""


@dataclass(frozen=True, eq=False)
class Optimum:
    """Where Gauss–Newton steps have ended."""

    answer: Gaussian
    """Laplace's approximation of the posterior there."""
    data: FloatArray
    """Simulated data of the wire, shape (datum,)."""
    objective: float
    """−2 log of its posterior density, up to a constant."""
    excess: float
    """(χ² − its mean) / its standard deviation: of all data, or of one channel, if that is more."""
    found_by: tuple[int, ...] = (0,)
    """The attempt of each of the starts that have led here."""

    @property
    def fits(self) -> bool:
        """Whether the noise explains the misfit."""
        return is_noise(self.excess)

    @property
    def log_evidence(self) -> float:
        """The logarithm of the posterior's integral over this maximum, up to a constant."""
        return 0.5 * float(np.linalg.slogdet(self.answer.covariance)[1] - self.objective)


def optimum_at(
    observation: Observation, answer: Gaussian, found_by: tuple[int, ...] = (0,)
) -> Optimum:
    """Return the optimum where starts of these attempts have ended."""
    data = observation.simulate(answer.mean[None])[0]
    height = float(objective(observation, answer.mean, data))
    return Optimum(answer, data, height, chi_square_excess(observation, data), found_by)


def is_noise(excess: float) -> bool:
    """Return whether the noise explains such an excess of χ²."""
    return excess <= TOLERATED


def chi_square_excess(observation: Observation, data: FloatArray) -> float:
    """Return (χ² − its mean) / its standard deviation, the largest over all data and each channel.

    Parameters
    ----------
    observation : Observation
    data : array, shape (datum,)
        Simulated.
    """
    squares = squared_misfits(observation, data)
    sets = [np.ones(squares.size, dtype=bool)]
    sets += [observation.channel == c for c in np.unique(observation.channel)]
    return max(float((squares[s].sum() - s.sum()) / np.sqrt(2 * s.sum())) for s in sets)


def best(optima: Sequence[Optimum]) -> Optimum:
    """Return the most probable optimum."""
    return min(optima, key=lambda one: one.objective)


def shares(optima: Sequence[Optimum]) -> FloatArray:
    """Return the share of the posterior that each optimum has by Laplace's approximation."""
    return np.asarray(softmax([one.log_evidence for one in optima]))


def unseen(optima: Sequence[Optimum], share: FloatArray) -> float:
    """Return an estimate of how much of the posterior is at optima that no start has found.

    As much as is at those that only one start has found (Good, Biometrika 40, 237 (1953)).

    Parameters
    ----------
    optima : sequence of Optimum
    share : array, shape (optimum,)
        Of the posterior.
    """
    alone = np.array([len(one.found_by) == 1 for one in optima])
    return float(share[alone].sum())


def same_answer(observation: Observation, one: Optimum, other: Optimum) -> bool:
    """Return whether two optima are the same."""
    scatter = max(1.0, relative_misfit(observation, one))
    squares = _squared_distance(observation, one, other) / one.answer.mean.size
    return bool(squares < (SAME_ANSWER * scatter) ** 2)


def _squared_distance(observation: Observation, one: Optimum, other: Optimum) -> float:
    """Return Mahalanobis' distance of two optima squared, in variables in which it is straight.

    In others, the ends of steps that creep along one bent ridge seem far apart.
    """
    straightened = Straightened.about(one.answer, observation.unknowns)
    answer = straightened.of_gaussian(one.answer)
    return float(answer.squared_distance(straightened.of_white_noise(other.answer.mean)))


def add(observation: Observation, found: list[Optimum], new: Optimum) -> int:
    """Add an optimum to those found, and return which of them it is.

    It is the nearest of those that it is the same as. The better one of the two stays.
    """
    same = [k for k, one in enumerate(found) if same_answer(observation, one, new)]
    if not same:
        found.append(new)
        return len(found) - 1
    k = min(same, key=lambda k: _squared_distance(observation, found[k], new))
    better = best([found[k], new])
    if abs(found[k].objective - new.objective) <= AS_GOOD:
        better = replace(better, found_by=found[k].found_by + new.found_by)
    found[k] = better
    return k


def relative_misfit(observation: Observation, optimum: Optimum) -> float:
    """Return its root-mean-square misfit in units of the data's errors."""
    return float(np.sqrt(squared_misfits(observation, optimum.data).mean()))
