"""From one measurement to the optima that explain it, and samples of the posterior.

The optima are those of few unknowns (`search.few_unknowns`) or of a whole landscape
(`search.whole_landscape`). Importance sampling follows where the posterior is wide. There are more
starts if it tells that optima which only one start has found have much of the posterior, or if it
has too few effective samples.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.posterior.samples import posterior_samples
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.few_unknowns import (
    InversionSettings,
    starts_of_few_unknowns,
)
from disorder_landscape.inference.search.optima import Optima
from disorder_landscape.inference.search.starts import MOST_STARTS
from disorder_landscape.inference.search.steps import Steps
from disorder_landscape.inference.search.whole_landscape import optima_of_whole_landscape
from disorder_landscape.inference.stages import IMPORTANCE_SAMPLING, within
from disorder_landscape.inference.streams import Stream
from disorder_landscape.inference.verdict import CONVERGED, verdict
from disorder_landscape.learning.model import TrainedModel


def invert(
    observation: Observation,
    model: TrainedModel | None,
    seed: int = 0,
    settings: InversionSettings | None = None,
    steps: Steps | None = None,
) -> Outcome:
    """Return the optima of the posterior that explain the data best, and samples of it.

    Parameters
    ----------
    observation : Observation
    model : TrainedModel, optional
        The network that guesses, for the first attempt. Where it needs few of the data, its
        predictions serve as features of the rounds, too (`search.network_features`).
    seed : int
    settings : InversionSettings, optional
        Of few unknowns; the whole landscape has its own search.
    steps : Steps, optional
        Whom they tell, and what an interrupted run has found.
    """
    steps = steps or Steps()
    seeds = [seed, Stream.IMPORTANCE_SAMPLES]
    if observation.unknowns.is_whole_landscape:
        optima, attempts = optima_of_whole_landscape(observation, steps, seed)
        optima.look_at_mirror_images(attempts - 1)
        return _outcome(observation, optima, attempts, 0, seeds)
    starts, attempts, rounds = starts_of_few_unknowns(observation, model, steps, seed, settings)
    optima = starts.optima
    while True:
        optima.look_at_mirror_images(attempts - 1)
        outcome = _outcome(observation, optima, attempts, rounds, seeds)
        is_enough = verdict(observation, outcome) == CONVERGED or not optima.is_wide
        if is_enough or optima.starts >= MOST_STARTS:
            return outcome
        seeds = [*seeds[:2], optima.starts]
        starts.go_on(np.random.default_rng([seed, Stream.MORE_STARTS, optima.starts]))


def _outcome(
    observation: Observation,
    optima: Optima,
    attempts: int,
    rounds: int,
    seeds: Sequence[int],
) -> Outcome:
    """Return what optima come to, with samples where the posterior is no normal distribution."""
    report = within(optima.steps.progress, attempts - 1, IMPORTANCE_SAMPLING)
    drawn = posterior_samples(observation, optima.found, seeds, optima.steps.cache, report)
    return Outcome(tuple(optima.found), drawn, attempts, rounds)
