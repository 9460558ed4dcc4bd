"""The verdict on an inversion: converged, not converged, or not described by the model."""

from __future__ import annotations

import numpy as np

from disorder_landscape.inference.attempt import TOLERATED, Attempt, best
from disorder_landscape.inference.problem.observation import Observation, squared_misfits

CONVERGED = "converged"
NOT_CONVERGED = "not converged"
NOT_DESCRIBED = "not described by the model"
"""The verdicts."""

WRONG_MISFIT = 0.001
"""The least root-mean-square difference in e²/h of a wrong answer and the data. If the noise hides
less, an answer that fits is right. Otherwise a second attempt must agree: of 200 wires of ten
components with errors of 0.01 e²/h, three had a wrong answer that fitted."""
FEW_DATA = 5
"""Data for each unknown; a wrong answer may fit fewer, whatever the noise is."""
SAME_ANSWER = 2.0
"""Two optima are the same if they are closer than this many of their standard deviations, root mean
square over the principal axes. (Where the posterior bends they differ by about one.)"""
SAME_MISFIT = 0.05
"""Two misfits are the same if what the noise leaves unexplained of them differs by less than this
part. If two attempts end equally far off the data, even in different places, the model can do no
better."""


def verdict(observation: Observation, attempts: list[Attempt]) -> str:
    """Return the verdict on the attempts at explaining the data.

    - Converged: the best answer explains the data, and either a wrong answer could not, or another
      attempt agrees.
    - Not described by the model: no answer explains the data, but another attempt agrees with the
      best one, or is as far off the data.
    - Not converged: otherwise. A better answer may have been missed.
    """
    chosen = best(attempts)
    others = [attempt for attempt in attempts if attempt is not chosen]
    agreed = any(same_answer(observation, chosen, other) for other in others)
    if chosen.fits:
        known = agreed or is_surely_right(observation)
        return CONVERGED if known and chosen.is_posterior else NOT_CONVERGED
    as_bad = any(same_misfit(observation, chosen, other) for other in others)
    return NOT_DESCRIBED if agreed or as_bad else NOT_CONVERGED


def is_surely_right(observation: Observation) -> bool:
    """Return whether the noise is so small that an answer that fits needs no second attempt."""
    count = observation.data.size
    hidden = TOLERATED * np.sqrt(2 / count) * observation.variance.mean()
    return bool(hidden < WRONG_MISFIT**2 and count >= FEW_DATA * len(observation.unknowns.names))


def same_answer(observation: Observation, one: Attempt, other: Attempt) -> bool:
    """Return whether two attempts have ended in the same optimum."""
    scatter = max(1.0, _misfit(observation, one))
    squares = one.answer.squared_distance(other.answer.mean) / one.answer.mean.size
    return bool(squares < (SAME_ANSWER * scatter) ** 2)


def same_misfit(observation: Observation, one: Attempt, other: Attempt) -> bool:
    """Return whether two attempts are equally far off the data, by more than the noise is."""
    squares = np.array([_misfit(observation, attempt) ** 2 for attempt in (one, other)])
    least, most = np.sqrt(np.sort(np.maximum(squares - 1, 0.0)))
    return bool(most < (1 + SAME_MISFIT) * least)


def _misfit(observation: Observation, attempt: Attempt) -> float:
    """Return the answer's root-mean-square misfit in units of the data's errors."""
    return float(np.sqrt(squared_misfits(observation, attempt.data).mean()))
