"""From one measurement to the disorder in the wire: guess, rounds, polish, verdict."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from typing import NamedTuple

import numpy as np

from disorder_landscape.inference.attempt import Attempt, attempt_at, best
from disorder_landscape.inference.checkpoint import Checkpoint
from disorder_landscape.inference.posterior.importance_sampling import population, widened
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.unknowns import Gaussian
from disorder_landscape.inference.search.first_guess import network_guess
from disorder_landscape.inference.search.gauss_newton import polish
from disorder_landscape.inference.search.network_features import Word, word_on
from disorder_landscape.inference.search.regression_rounds import (
    WITH_WORD,
    Recall,
    RoundSettings,
    rounds,
)
from disorder_landscape.inference.verdict import NOT_CONVERGED, is_surely_right, verdict
from disorder_landscape.learning.model import TrainedModel
from disorder_landscape.model.parameters import BOLTZMANN

STRAIGHT = 0.25
"""An answer whose error bar is more than this many kT, or …"""
LEAST_WIDTH = 1e-3
"""… this in meV, about the width of levels, is a population's: conductances are peaks of about that
width, and the posterior is no normal distribution about one optimum. By Mahalanobis' distances,
Laplace's error bars are right below that and too small above it."""


@dataclass(frozen=True)
class InversionSettings:
    """How many attempts there are, and how each goes about it."""

    rounds: RoundSettings = field(default_factory=RoundSettings)
    attempts: int = 3
    """The first starts from the network's guess, the others from the disorder model's prior."""
    more_samples: float = 1.25
    """Each further attempt has so many times the samples for each unknown, and shrinks their spread
    more slowly."""


class Step(NamedTuple):
    """What an inversion is about."""

    attempt: int
    stage: str
    """One of "round", "polish" and "population"."""
    number: int
    misfit: float
    """Root mean square in e²/h."""
    spread: float
    """The deviation of V in meV, root mean square over the sites."""


Told = Callable[[Step], None]


def invert(
    observation: Observation,
    model: TrainedModel | None,
    seed: int = 0,
    settings: InversionSettings | None = None,
    told: Told = lambda step: None,
    checkpoint: Checkpoint | None = None,
) -> list[Attempt]:
    """Return the attempts at explaining the data, the `best` of which is the answer.

    Parameters
    ----------
    observation : Observation
    model : TrainedModel, optional
        The network that guesses; without it the disorder model's prior is where attempts start.
        They do, too, where its word on each wire is heard (`word_heard`), better than a guess.
    seed : int
    settings : InversionSettings, optional
    told : callable
        Progress.
    checkpoint : Checkpoint, optional
        What an interrupted run has found.
    """
    recall = (checkpoint if checkpoint is not None else Checkpoint()).recall
    word = word_heard(model, observation)
    settings = settings or usual_settings(word)
    attempts: list[Attempt] = []
    prior, guess = observation.unknowns.prior, None
    if model is not None and word is None:
        rng = np.random.default_rng([seed, 2**31])
        make = partial(network_guess, model, observation, rng)
        guess = _recalled(recall, "guess", make)
    for number in range(settings.attempts):
        found = guess if guess is not None and number == 0 else prior
        count, more = 0, _with_more_samples(settings, number)
        for one in rounds(observation, found, [seed, number], more, recall, word):
            told(Step(number, "round", count, one.misfit, one.spread))
            found, count = one.distribution, count + 1
        tell = partial(_tell, told, number, "polish")
        make = partial(polish, observation, found, told=tell)
        answer = _recalled(recall, f"polish.{number}", make)
        attempts.append(attempt_at(observation, found, answer, count))
        outcome = attempts
        if number > 0 or settings.attempts == 1 or is_surely_right(observation):
            tell = partial(_tell, told, number, "population")
            outcome = judged(observation, attempts, [seed, number, 2**31 + 2], recall, tell)
        if verdict(observation, outcome) != NOT_CONVERGED:
            break
    return outcome


def usual_settings(word: Word | None) -> InversionSettings:
    """Return how an inversion goes about it that hears a network's word on each wire, or none."""
    return InversionSettings(RoundSettings() if word is None else WITH_WORD)


def word_heard(model: TrainedModel | None, observation: Observation) -> Word | None:
    """Return the network's word on each wire, if it needs no more data than rounds look at."""
    return word_on(model, observation, RoundSettings.share)


def _recalled(recall: Recall, name: str, make: Callable[[], Gaussian]) -> Gaussian:
    return Gaussian.from_dict(recall(name, lambda: make().to_dict()))


def _tell(told: Told, attempt: int, stage: str, number: int, misfit: float, spread: float) -> None:
    told(Step(attempt, stage, number, misfit, spread))


def judged(
    observation: Observation,
    attempts: list[Attempt],
    seed: Sequence[int],
    recall: Recall = lambda name, calculate: calculate(),
    told: Callable[[int, float, float], None] = lambda number, misfit, spread: None,
) -> list[Attempt]:
    """Return attempts whose best has the posterior's moments, where Laplace's are not those.

    The samples that have them are drawn where the rounds and the polishes of all attempts that
    fit have ended (`population`).
    """
    chosen = best(attempts)
    width = max(STRAIGHT * BOLTZMANN * observation.measurement.temperature, LEAST_WIDTH)
    bar = observation.unknowns.site_deviation(chosen.answer.covariance)
    if not chosen.fits or bar < width:
        return attempts
    ends = [(attempt.last, widened(attempt.answer)) for attempt in attempts if attempt.fits]
    drawn = population(observation, [*chain(*ends)], seed, recall, told)
    instead = replace(chosen, answer=drawn.moments, population=drawn)
    return [instead if attempt is chosen else attempt for attempt in attempts]


def _with_more_samples(settings: InversionSettings, number: int) -> RoundSettings:
    more, first = settings.more_samples**number, settings.rounds
    return replace(
        first,
        samples_per_unknown=first.samples_per_unknown * more,
        least_shrinking=first.least_shrinking ** (1 / more),
    )
