"""What has become of an inversion: converged, not converged, or not described by the model."""

from __future__ import annotations

import numpy as np

from disorder_landscape.inference.attempt import TOLERATED, Attempt, best
from disorder_landscape.inference.problem.observation import Observation, squared_misfits

CONVERGED = "converged"
NOT_CONVERGED = "not converged"
NOT_DESCRIBED = "not described by the model"
"""The verdicts."""

WRONG_MISFIT = 0.001
"""Difference in e²/h, root mean square, that tells a wrong answer from the right one. If the noise
hides less, an answer that fits is right; otherwise a second attempt must agree: of 200 wires of ten
components with errors of 0.01 e²/h, three had a wrong answer that fitted."""
FEW_DATA = 5
"""For each unknown: a wrong answer may fit fewer, whatever the noise."""
SAME_ANSWER = 2.0
"""Two optima are the same if they are closer than this many of their own deviations, root mean
square over the principal axes (in valleys that bend they differ by one or so)."""
SAME_MISFIT = 0.05
"""Two misfits are the same of which what the noise leaves unexplained differs by less than this
part. If the best that can be found is twice found to be so bad, in different places even, then it
is the model that does no better."""


def verdict(observation: Observation, attempts: list[Attempt]) -> str:
    """Say what became of it.

    An answer that explains the data has converged, if a wrong one could not or another attempt
    agrees. Where none explains the data but attempts agree on one, or on how far off the best of
    them are, it is the model that cannot; where they do not agree either, a better answer may have
    been missed.
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
    """Return whether the noise hides so little that an answer that fits needs no second attempt."""
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
    """Return the root mean square of what the answer leaves of the data, in their errors."""
    return float(np.sqrt(squared_misfits(observation, attempt.data).mean()))
