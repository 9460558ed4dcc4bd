"""The verdict on an inversion: converged, not converged, or not described by the model."""

from __future__ import annotations

import numpy as np

from disorder_landscape.inference.optimum import TOLERATED, Optimum, relative_misfit, unseen
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.posterior.samples import posterior_shares
from disorder_landscape.inference.problem.observation import Observation

CONVERGED = "converged"
NOT_CONVERGED = "not converged"
NOT_DESCRIBED = "not described by the model"
"""The verdicts."""

WRONG_MISFIT = 0.001
"""The least root-mean-square difference in e²/h of a wrong answer and the data. If the noise hides
less, an answer that fits is right."""
FEW_DATA = 5
"""Data for each unknown; a wrong answer may fit fewer, whatever the noise is."""
UNSEEN = 0.1
"""There may be so much of the posterior at optima that only one start has found."""
SAME_MISFIT = 0.05
"""Two misfits are the same if what the noise leaves unexplained of them differs by less than this
part. If two attempts end equally far off the data, even in different places, the model can do no
better."""


def verdict(observation: Observation, outcome: Outcome) -> str:
    """Return the verdict on what an inversion has come to.

    - Converged: the best optimum explains the data, and either a wrong one could not, or several
      starts have led to it and to all others that are about as probable.
    - Not described by the model: no optimum explains the data, but two attempts have found the best
      one, or end as far off the data.
    - Not converged: otherwise. A better answer may have been missed.
    """
    chosen = outcome.best
    if chosen.fits:
        share = posterior_shares(observation, outcome.optima, outcome.importance_samples)
        agreed = len(chosen.found_by) > 1 and unseen(outcome.optima, share) <= UNSEEN
        known = agreed or is_surely_right(observation)
        return CONVERGED if known and outcome.is_posterior else NOT_CONVERGED
    as_bad = (one for one in outcome.optima if same_misfit(observation, chosen, one))
    attempts = {attempt for one in as_bad for attempt in one.found_by}
    return NOT_DESCRIBED if len(attempts) > 1 else NOT_CONVERGED


def is_surely_right(observation: Observation) -> bool:
    """Return whether the noise is so small that an answer that fits needs no other start.

    Of the whole landscape none is: there are optima some 10 µeV apart that fit all but as well. Nor
    is one of a device of which several parameters are unknown.
    """
    unknowns = observation.unknowns
    if unknowns.is_whole_landscape or unknowns.has_several_parameters:
        return False
    count = observation.data.size
    hidden = TOLERATED * np.sqrt(2 / count) * observation.variance.mean()
    return bool(hidden < WRONG_MISFIT**2 and count >= FEW_DATA * len(unknowns.names))


def same_misfit(observation: Observation, one: Optimum, other: Optimum) -> bool:
    """Return whether two optima are equally far off the data, by more than the noise is."""
    if one is other:
        return True
    squares = np.array([relative_misfit(observation, optimum) ** 2 for optimum in (one, other)])
    least, most = np.sqrt(np.sort(np.maximum(squares - 1, 0.0)))
    return bool(most < (1 + SAME_MISFIT) * least)
