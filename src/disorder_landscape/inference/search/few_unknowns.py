"""The optima of few unknowns: components, the mean and parameters of the device.

An attempt is a first guess, and Gauss–Newton steps from many starts about it, with regression
rounds in between that bring it nearer. There are attempts until the verdict is known.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from disorder_landscape.inference.checkpoint import cached_gaussian
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.first_guess import network_guess
from disorder_landscape.inference.search.network_features import network_features
from disorder_landscape.inference.search.optima import Optima
from disorder_landscape.inference.search.regression_rounds import (
    WITH_NETWORK_FEATURES,
    Round,
    RoundSettings,
    regression_rounds,
)
from disorder_landscape.inference.search.starts import Starts
from disorder_landscape.inference.search.steps import Steps
from disorder_landscape.inference.stages import ROUND, Step
from disorder_landscape.inference.streams import Stream
from disorder_landscape.learning.model import TrainedModel

TRIED_FROM = 0.15
"""Gauss–Newton steps are tried if the distribution of V is narrower than this in meV, and again
whenever it is half as wide."""


@dataclass(frozen=True)
class InversionSettings:
    """How many attempts there are, and how each goes about it."""

    rounds: RoundSettings = field(default_factory=RoundSettings)
    attempts: int = 3
    """The first starts from the network's guess, the others from the disorder model's prior."""
    more_samples: float = 1.25
    """Each further attempt has so many times the samples for each unknown, and its distribution
    shrinks more slowly."""


def starts_of_few_unknowns(
    observation: Observation,
    model: TrainedModel | None,
    steps: Steps,
    seed: int,
    settings: InversionSettings | None,
) -> tuple[Starts, int, int]:
    """Return starts that have led to optima, and how many attempts and rounds these have taken."""
    share = RoundSettings.share if settings is None else settings.rounds.share
    features, cache = network_features(model, observation, share), steps.cache
    if settings is None:
        settings = InversionSettings(RoundSettings() if features is None else WITH_NETWORK_FEATURES)
    prior, guess = observation.unknowns.white_noise, None
    if model is not None:
        rng = np.random.default_rng([seed, Stream.GUESS])
        guess = cached_gaussian(cache, "guess", partial(network_guess, model, observation, rng))
    rng = np.random.default_rng([seed, Stream.SEARCH])
    starts = Starts(Optima(observation, steps), rng)
    count = 0
    for number in range(settings.attempts):
        start = guess if guess is not None and number == 0 else prior
        more = _with_more_samples(settings, number)
        rounds = regression_rounds(observation, start, [seed, number], more, cache, features)
        count += _search(starts, start, rounds, seed, number)
        if starts.optima.is_done:
            break
    return starts, number + 1, count


def _search(
    starts: Starts,
    start: Gaussian,
    rounds: Iterator[Round],
    seed: int,
    number: int,
) -> int:
    """Add the optima of one attempt, and return how many rounds it has taken."""
    optima, found, count = starts.optima, start, 0
    spread = optima.observation.unknowns.site_std(start.covariance)
    next_try = TRIED_FROM
    while True:
        if spread < next_try:
            next_try = spread / 2
            starts.start_about(found, number, np.random.default_rng([seed, number, count, 2]))
            if optima.is_done:
                return count
        one = next(rounds, None)
        if one is None:
            optima.start_at(found.mean, number)
            # Perhaps V has never been known to TRIED_FROM, or the rounds have gone astray.
            rng = np.random.default_rng([seed, number, count, 3])
            if optima.fits:
                starts.start_about(start, number, rng)
            else:
                starts.start_at_best_of_draws(start, number, rng)
            return count
        optima.steps.progress(Step(number, ROUND, count, one.misfit, one.spread))
        found, count, spread = one.distribution, count + 1, one.spread


def _with_more_samples(settings: InversionSettings, number: int) -> RoundSettings:
    more, first = settings.more_samples**number, settings.rounds
    return replace(
        first,
        samples_per_unknown=first.samples_per_unknown * more,
        least_shrinking=first.least_shrinking ** (1 / more),
    )
