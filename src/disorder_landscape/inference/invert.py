"""From one measurement to attempts at explaining it.

An attempt is a first guess, regression rounds, Gauss–Newton steps and, where the posterior is wide,
importance sampling. There are attempts until the verdict is known.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from typing import NamedTuple

import numpy as np

from disorder_landscape.inference.attempt import Attempt, attempt_at, best
from disorder_landscape.inference.checkpoint import Cache, Checkpoint, uncached
from disorder_landscape.inference.posterior.importance_sampling import (
    importance_sampling,
    weighted_samples,
    widened,
)
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.agreed_optimum import agreed_optimum
from disorder_landscape.inference.search.first_guess import network_guess
from disorder_landscape.inference.search.gauss_newton import gauss_newton
from disorder_landscape.inference.search.network_features import NetworkFeatures, network_features
from disorder_landscape.inference.search.regression_rounds import (
    WITH_NETWORK_FEATURES,
    Round,
    RoundSettings,
    regression_rounds,
)
from disorder_landscape.inference.verdict import NOT_CONVERGED, is_surely_right, verdict
from disorder_landscape.learning.model import TrainedModel
from disorder_landscape.model.parameters import BOLTZMANN, FloatArray

TRIED_FROM = 0.1
"""Gauss–Newton steps are tried if the distribution of V is narrower than this in meV: they find the
truth from guesses of networks that are some 5 and 30 µeV off."""
STRAIGHT = 0.25
"""Whether the posterior is a normal distribution is asked if the error bar of V is more than this
many kT, or …"""
LEAST_WIDTH = 1e-3
"""… this in meV, about the width of levels. Conductances are peaks of about that width. By
Mahalanobis distances of the truth, Laplace's error bars are right below that width and often too
small above it."""
CHECKED = 64
"""Samples of Laplace's approximation that are weighted by the exact posterior to find out. …"""
NORMAL = 0.8
"""… It is the posterior if their effective sample size is this share of them. (Of a normal
posterior that is wider by 10 % in seven directions it is 0.86, by 20 % 0.47.)"""
ROUND, GAUSS_NEWTON, IMPORTANCE_SAMPLING = "round", "Gauss–Newton", "importance sampling"
"""The stages of an attempt."""


@dataclass(frozen=True)
class InversionSettings:
    """How many attempts there are, and how each goes about it."""

    rounds: RoundSettings = field(default_factory=RoundSettings)
    attempts: int = 3
    """The first starts from the network's guess, the others from the disorder model's prior."""
    more_samples: float = 1.25
    """Each further attempt has so many times the samples for each unknown, and its distribution
    shrinks more slowly."""


class Step(NamedTuple):
    """What an inversion is at, for a progress callback."""

    attempt: int
    stage: str
    """One of ROUND, GAUSS_NEWTON and IMPORTANCE_SAMPLING."""
    number: int
    misfit: float
    """Root mean square in e²/h."""
    spread: float
    """The standard deviation of V in meV, root mean square over the sites."""


Progress = Callable[[Step], None]
"""A progress callback: called after each round and each iteration of importance sampling, and
before each Gauss–Newton step."""


def silent(step: Step) -> None:
    """Do nothing: the progress callback where there is none."""


def invert(
    observation: Observation,
    model: TrainedModel | None,
    seed: int = 0,
    settings: InversionSettings | None = None,
    progress: Progress = silent,
    checkpoint: Checkpoint | None = None,
) -> list[Attempt]:
    """Return the attempts at explaining the data, the `best` of which is the answer.

    Parameters
    ----------
    observation : Observation
    model : TrainedModel, optional
        The network that guesses. Attempts start from the disorder model's prior without it, and
        where its predictions serve as features instead (`usable_network_features`).
    seed : int
    settings : InversionSettings, optional
    progress : callable
    checkpoint : Checkpoint, optional
        What an interrupted run has found.
    """
    cache = (checkpoint if checkpoint is not None else Checkpoint()).cached
    features = usable_network_features(model, observation)
    settings = settings or usual_settings(features)
    attempts: list[Attempt] = []
    prior, guess = observation.unknowns.prior, None
    if model is not None and features is None:
        rng = np.random.default_rng([seed, 2**31])
        make = partial(network_guess, model, observation, rng)
        guess = _cached_gaussian(cache, "guess", make)
    for number in range(settings.attempts):
        start = guess if guess is not None and number == 0 else prior
        more = _with_more_samples(settings, number)
        rounds = regression_rounds(observation, start, [seed, number], more, cache, features)
        attempts.append(_attempt(observation, start, rounds, seed, number, cache, progress))
        outcome = attempts
        if number > 0 or settings.attempts == 1 or is_surely_right(observation):
            report = partial(_report, progress, number, IMPORTANCE_SAMPLING)
            seeds = [seed, number, 2**31 + 2]
            outcome = with_importance_samples(observation, attempts, seeds, cache, report)
        if verdict(observation, outcome) != NOT_CONVERGED:
            break
    return outcome


def _attempt(
    observation: Observation,
    start: Gaussian,
    rounds: Iterator[Round],
    seed: int,
    number: int,
    cache: Cache,
    progress: Progress,
) -> Attempt:
    """Return what rounds and Gauss–Newton steps come to.

    Steps are tried as soon as the distribution is narrow enough, and whenever it is half as wide as
    it was then. Their optimum ends the rounds if it fits.
    """

    def steps(of: Observation, x: FloatArray, name: str) -> Gaussian:
        report = partial(_report, progress, number, GAUSS_NEWTON)
        make = partial(gauss_newton, of, x, progress=report)
        return _cached_gaussian(cache, f"gauss_newton.{number}.{name}", make)

    found, count = start, 0
    spread = observation.unknowns.site_std(start.covariance)
    next_try = TRIED_FROM
    while True:
        if spread < next_try:
            next_try = spread / 2
            rng = np.random.default_rng([seed, number, count, 2])
            near = agreed_optimum(observation, found, rng, steps, f"{count}")
            if near is not None:
                answer = steps(observation, near, f"{count}")
                attempt = attempt_at(observation, found, answer, count)
                if attempt.fits:
                    return attempt
        one = next(rounds, None)
        if one is None:
            return attempt_at(observation, found, steps(observation, found.mean, "last"), count)
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


def _cached_gaussian(cache: Cache, name: str, make: Callable[[], Gaussian]) -> Gaussian:
    return Gaussian.from_dict(cache(name, lambda: make().to_dict()))


def _report(
    progress: Progress, attempt: int, stage: str, number: int, misfit: float, spread: float
) -> None:
    progress(Step(attempt, stage, number, misfit, spread))


def with_importance_samples(
    observation: Observation,
    attempts: list[Attempt],
    seed: Sequence[int],
    cache: Cache = uncached,
    progress: Callable[[int, float, float], None] = lambda number, misfit, spread: None,
) -> list[Attempt]:
    """Return the attempts, the best with importance samples if its posterior is wide.

    The first proposals are those with which the rounds and the Gauss–Newton steps of all attempts
    that fit have ended.
    """
    chosen = best(attempts)
    width = max(STRAIGHT * BOLTZMANN * observation.measurement.temperature, LEAST_WIDTH)
    bar = observation.unknowns.site_std(chosen.answer.covariance)
    if not chosen.fits or bar < width:
        return attempts
    name = f"is_normal.{'.'.join(map(str, seed))}"
    make = partial(_effective_share, observation, chosen.answer, [*seed, CHECKED])
    if cache(name, make)["share"] > NORMAL:
        return attempts
    ends = [(one.last_proposal, widened(one.answer)) for one in attempts if one.fits]
    drawn = importance_sampling(observation, [*chain(*ends)], seed, cache, progress)
    instead = replace(chosen, answer=drawn.moments, importance_samples=drawn)
    return [instead if attempt is chosen else attempt for attempt in attempts]


def _effective_share(
    observation: Observation, answer: Gaussian, seed: Sequence[int]
) -> dict[str, float]:
    """Return the effective `share` of an answer's samples if weighted by the exact posterior."""
    X = answer.draw(np.random.default_rng(seed), CHECKED)
    found = weighted_samples(observation, answer, X)
    return {"share": found.effective_sample_size / CHECKED}


def _with_more_samples(settings: InversionSettings, number: int) -> RoundSettings:
    more, first = settings.more_samples**number, settings.rounds
    return replace(
        first,
        samples_per_unknown=first.samples_per_unknown * more,
        least_shrinking=first.least_shrinking ** (1 / more),
    )
