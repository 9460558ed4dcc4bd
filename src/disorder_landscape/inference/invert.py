"""From one measurement to the optima that explain it, and samples of the posterior.

An attempt is a first guess, and Gauss–Newton steps from many starts about it, with regression
rounds in between that bring it nearer. There are attempts until the verdict is known. Importance
sampling follows where the posterior is wide. There are more starts if it tells that optima which
only one start has found have much of the posterior, or if it has too few effective samples.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from disorder_landscape.inference.checkpoint import Cache, Checkpoint, cached_gaussian
from disorder_landscape.inference.optimum import Optimum
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.posterior.samples import posterior_samples
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.first_guess import network_guess
from disorder_landscape.inference.search.gauss_newton import Goal, gauss_newton
from disorder_landscape.inference.search.network_features import NetworkFeatures, network_features
from disorder_landscape.inference.search.optima import Optima, Steps
from disorder_landscape.inference.search.regression_rounds import (
    WITH_NETWORK_FEATURES,
    Round,
    RoundSettings,
    regression_rounds,
)
from disorder_landscape.inference.search.starts import MOST_STARTS, Starts
from disorder_landscape.inference.search.whole_landscape import optima_of_whole_landscape
from disorder_landscape.inference.stages import (
    GAUSS_NEWTON,
    IMPORTANCE_SAMPLING,
    ROUND,
    Progress,
    Step,
    silent,
    within,
)
from disorder_landscape.inference.verdict import CONVERGED, verdict
from disorder_landscape.learning.model import TrainedModel
from disorder_landscape.model.parameters import FloatArray

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


def invert(
    observation: Observation,
    model: TrainedModel | None,
    seed: int = 0,
    settings: InversionSettings | None = None,
    progress: Progress = silent,
    checkpoint: Checkpoint | None = None,
) -> Outcome:
    """Return the optima of the posterior that explain the data best, and samples of it.

    Parameters
    ----------
    observation : Observation
    model : TrainedModel, optional
        The network that guesses, for the first attempt. Where it needs few of the data, its
        predictions serve as features of the rounds, too (`usable_network_features`).
    seed : int
    settings : InversionSettings, optional
        Of few unknowns; the whole landscape has its own search.
    progress : callable
    checkpoint : Checkpoint, optional
        What an interrupted run has found.
    """
    cache = (checkpoint if checkpoint is not None else Checkpoint()).cached
    steps = partial(_steps, cache, progress)
    seeds = [seed, 2**31 + 2]
    if observation.unknowns.is_whole_landscape:
        optima, attempts = optima_of_whole_landscape(observation, steps, seed, cache)
        optima.look_at_mirror_images(attempts - 1)
        return _outcome(observation, optima, attempts, 0, seeds, progress, cache)
    found = _starts_of_few_unknowns(observation, model, steps, seed, settings, progress, cache)
    starts, attempts, rounds = found
    optima = starts.optima
    while True:
        optima.look_at_mirror_images(attempts - 1)
        outcome = _outcome(observation, optima, attempts, rounds, seeds, progress, cache)
        is_enough = verdict(observation, outcome) == CONVERGED or not optima.is_wide
        if is_enough or optima.starts >= MOST_STARTS:
            return outcome
        seeds = [*seeds[:2], optima.starts]
        starts.go_on(np.random.default_rng([seed, 2**31 + 5, optima.starts]))


def _outcome(
    observation: Observation,
    optima: Optima,
    attempts: int,
    rounds: int,
    seeds: Sequence[int],
    progress: Progress,
    cache: Cache,
) -> Outcome:
    """Return what optima come to, with samples where the posterior is no normal distribution."""
    report = within(progress, attempts - 1, IMPORTANCE_SAMPLING)
    drawn = posterior_samples(observation, optima.found, seeds, cache, report)
    return Outcome(tuple(optima.found), drawn, attempts, rounds)


def _starts_of_few_unknowns(
    observation: Observation,
    model: TrainedModel | None,
    steps: Steps,
    seed: int,
    settings: InversionSettings | None,
    progress: Progress,
    cache: Cache,
) -> tuple[Starts, int, int]:
    """Return starts that have led to optima, and how many attempts and rounds these have taken."""
    features = usable_network_features(model, observation)
    settings = settings or usual_settings(features)
    prior, guess = observation.unknowns.prior, None
    if model is not None:
        rng = np.random.default_rng([seed, 2**31])
        guess = cached_gaussian(cache, "guess", partial(network_guess, model, observation, rng))
    rng = np.random.default_rng([seed, 2**31 + 3])
    starts = Starts(Optima(observation, steps), rng, cache)
    count = 0
    for number in range(settings.attempts):
        start = guess if guess is not None and number == 0 else prior
        more = _with_more_samples(settings, number)
        rounds = regression_rounds(observation, start, [seed, number], more, cache, features)
        count += _search(starts, start, rounds, seed, number, progress)
        if starts.optima.is_done:
            break
    return starts, number + 1, count


def _steps(
    cache: Cache,
    progress: Progress,
    observation: Observation,
    x: FloatArray,
    attempt: int,
    name: str | None,
    known: Sequence[Optimum],
    goal: Goal,
) -> Gaussian:
    """Return where Gauss–Newton steps from x (unknown,) end."""
    report = within(progress, attempt, GAUSS_NEWTON)
    make = partial(gauss_newton, observation, x, report, known, goal)
    if name is None:
        return make()
    return cached_gaussian(cache, f"gauss_newton.{name}", make)


def _search(
    starts: Starts,
    start: Gaussian,
    rounds: Iterator[Round],
    seed: int,
    number: int,
    progress: Progress,
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
            rng, fits = np.random.default_rng([seed, number, count, 3]), optima.fits
            starts.start_about(start, number, rng, tried=0 if fits else 1, best_of_many=not fits)
            return count
        progress(Step(number, ROUND, count, one.misfit, one.spread))
        found, count, spread = one.distribution, count + 1, one.spread


def usual_settings(features: NetworkFeatures | None) -> InversionSettings:
    """Return the settings of an inversion with features from a network, or without."""
    return InversionSettings(RoundSettings() if features is None else WITH_NETWORK_FEATURES)


def usable_network_features(
    model: TrainedModel | None, observation: Observation
) -> NetworkFeatures | None:
    """Return a network as a source of features, if it needs no more data than the first rounds."""
    return network_features(model, observation, RoundSettings.share)


def _with_more_samples(settings: InversionSettings, number: int) -> RoundSettings:
    more, first = settings.more_samples**number, settings.rounds
    return replace(
        first,
        samples_per_unknown=first.samples_per_unknown * more,
        least_shrinking=first.least_shrinking ** (1 / more),
    )
