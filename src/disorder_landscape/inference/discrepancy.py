"""Data that no wire of the model explains: the best effort, and how much is left unexplained.

Each channel gets an error of its own besides the noise, normal and independent from datum to datum:
the discrepancy. Its size is the most probable one (MacKay, Neural Comput. 4, 415 (1992)): after
Gauss–Newton steps the variance of a channel's errors is its mean square misfit, over the share of
the data that is more than the unknowns which the data fix. Steps and variances take turns.

What a model lacks is not independent from datum to datum. So the error bars are those of an answer
with so much noise. They do not say how far off the missing part of the model leads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray as xr

from disorder_landscape.inference.optimum import Optimum, add, best, optimum_at
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.posterior.samples import posterior_samples
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.steps import Steps
from disorder_landscape.inference.stages import IMPORTANCE_SAMPLING, within
from disorder_landscape.model.parameters import FloatArray

TURNS = 10
"""Of steps and variances, at most."""
SETTLED = 0.02
"""They end when no channel's error changes by more than this part."""
MOST_EXPLAINED = 0.9
"""Share of the data that unknowns may explain by their number alone."""
KEPT = 4
"""So many optima are taken along, the most probable ones: with more noise another may be best."""


class BestEffort(NamedTuple):
    """What explains data best with errors of the channels beside the noise."""

    observation: Observation
    """Its noise includes the discrepancy."""
    outcome: Outcome
    is_settled: bool
    """Whether further turns or samples are not expected to change anything."""


def best_effort(
    observation: Observation,
    outcome: Outcome,
    seed: Sequence[int],
    steps: Steps,
) -> BestEffort:
    """Return what explains the data best if their errors include the discrepancy.

    Parameters
    ----------
    observation : Observation
    outcome : Outcome
        What its inversion has come to. If that explains the data, it is returned as it is.
    seed : sequence of int
        Of the samples.
    steps : Steps
    """
    if outcome.best.fits:
        return BestEffort(observation, outcome, True)
    last = outcome.attempts - 1
    optima = sorted(outcome.optima, key=lambda one: one.objective)[:KEPT]
    with_errors, is_settled = observation, False
    for turn in range(TURNS):
        before = with_errors.noise
        errors = errors_of(observation, best(optima))
        with_errors = replace(observation, noise=errors)
        optima = _optima(with_errors, optima, steps, last, f"discrepancy.{turn}")
        is_settled = np.allclose(before, errors, rtol=SETTLED, atol=0.0)
        if is_settled:
            break
    report = within(steps.progress, last, IMPORTANCE_SAMPLING)
    drawn = posterior_samples(with_errors, optima, seed, steps.cache, report)
    found = Outcome(optima, drawn, outcome.attempts, outcome.rounds)
    return BestEffort(with_errors, found, is_settled and found.is_posterior)


def errors_of(observation: Observation, optimum: Optimum) -> FloatArray:
    """Return the standard deviations of all errors, the noise included, in e²/h, shape (channel,).

    Each unknown counts by how much the data fix it: one less its variance, since that of the prior
    is one.
    """
    fixed = len(observation.unknowns.names) - np.trace(optimum.answer.covariance)
    misfit = np.nan_to_num(observation.misfit(optimum.data))
    misfit = misfit / np.sqrt(1 - min(fixed / optimum.data.size, MOST_EXPLAINED))
    return np.asarray(np.maximum(misfit, observation.noise))


def discrepancy_of(observation: Observation, effort: BestEffort) -> xr.DataArray:
    """Return the standard deviation of the discrepancy alone in e²/h, dims (channel,).

    NaN where nothing was measured. The attribute settled is 1 or 0.
    """
    measured = np.isfinite(observation.misfit(observation.data))
    squares = effort.observation.noise**2 - observation.noise**2
    alone = np.where(measured, np.sqrt(squares), np.nan)
    attrs = {
        "long_name": "error beside the noise",
        "units": "e²/h",
        "settled": int(effort.is_settled),
    }
    return xr.DataArray(alone, dims="channel", attrs=attrs)


def _optima(
    observation: Observation, starts: Sequence[Optimum], steps: Steps, attempt: int, name: str
) -> list[Optimum]:
    """Return the optima to which steps from others lead, each once."""
    found: list[Optimum] = []
    for k, start in enumerate(starts):
        end = steps.end(observation, start.answer.mean, attempt, f"{name}.{k}")
        add(observation, found, optimum_at(observation, end, start.found_by))
    return found
