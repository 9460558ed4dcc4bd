"""From one measurement to the disorder in the wire: guess, rounds, polish, verdict."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from disorder_landscape.inference.checkpoint import Checkpoint
from disorder_landscape.inference.first_guess import network_guess
from disorder_landscape.inference.observation import Observation, objective, squared_misfits
from disorder_landscape.inference.polish import polish
from disorder_landscape.inference.population import Population, population
from disorder_landscape.inference.rounds import WITH_WORD, Recall, RoundSettings, rounds
from disorder_landscape.inference.unknowns import Gaussian
from disorder_landscape.inference.word import Word, word_on
from disorder_landscape.learning.model import TrainedModel
from disorder_landscape.physics.parameters import BOLTZMANN, FloatArray

CONVERGED = "converged"
NOT_CONVERGED = "not converged"
NOT_DESCRIBED = "not described by the model"
"""The verdicts."""

TOLERATED = 3.5
"""χ² of all data, or of one channel's, may lie this many of its own deviations above its mean."""
WRONG_MISFIT = 0.001
"""Difference in e²/h, root mean square, that tells a wrong answer from the right one. If the noise
hides less, an answer that fits is right; otherwise a second attempt must agree: of 200 wires of ten
components with errors of 0.01 e²/h, three had a wrong answer that fitted."""
FEW_DATA = 5
"""For each unknown: a wrong answer may fit fewer, whatever the noise."""
SAME_ANSWER = 2.0
"""Two optima are the same if they are closer than this many of their own deviations, root mean
square over the principal axes (in valleys that bend they differ by one or so)."""
STRAIGHT = 1.0
"""An answer whose error bar is more than this many kT, or …"""
LEAST_WIDTH = 1e-3
"""… this in meV, about the width of levels, is a population's: conductances are peaks of that
width, and the posterior is no normal distribution about one optimum."""
SAME_MISFIT = 0.05
"""Two misfits are the same that differ by less than this part. If the best that can be found is
twice found to be so bad, in different places even, then it is the model that does no better."""


@dataclass(frozen=True)
class InversionSettings:
    """How many attempts there are, and how each goes about it."""

    rounds: RoundSettings = field(default_factory=RoundSettings)
    attempts: int = 3
    """The first starts from the network's guess, the others from the disorder model's prior."""
    more_members: float = 1.25
    """Each further attempt has so many times the members for each unknown, and shrinks their spread
    more slowly."""


@dataclass(frozen=True, eq=False)
class Attempt:
    """Where rounds and their polish have ended."""

    last: Gaussian
    """Where members of one more round would have been drawn."""
    answer: Gaussian
    data: FloatArray
    """What the most probable wire shows, shape (datum,)."""
    objective: float
    """−2 log of its posterior density, up to a constant."""
    excess: float
    """How many of its deviations χ² is above its mean: of all data, or of a channel, if more."""
    rounds: int
    """How many there were."""
    population: Population | None = None
    """Members of the posterior, where it is not the normal distribution of the answer."""

    @property
    def fits(self) -> bool:
        """Whether the noise explains what is left of the misfit."""
        return self.excess <= TOLERATED

    @property
    def is_posterior(self) -> bool:
        """Whether the error bars are those of the posterior, as far as is known."""
        return self.population is None or self.population.is_enough

    def draw(self, rng: np.random.Generator, members: int) -> FloatArray:
        """Return an even number of members of the posterior, shape (member, unknown)."""
        return (self.answer if self.population is None else self.population).draw(rng, members)


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
        count, more = 0, _with_more_members(settings, number)
        for one in rounds(observation, found, [seed, number], more, recall, word):
            told(Step(number, "round", count, one.misfit, one.spread))
            found, count = one.distribution, count + 1
        tell = partial(_tell, told, number, "polish")
        make = partial(polish, observation, found, told=tell)
        answer = _recalled(recall, f"polish.{number}", make)
        attempts.append(_attempt(observation, found, answer, count))
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


def _attempt(observation: Observation, last: Gaussian, answer: Gaussian, count: int) -> Attempt:
    data = observation.simulate(answer.mean[None])[0]
    squares = squared_misfits(observation, data)
    height = float(objective(observation, answer.mean, data))
    return Attempt(last, answer, data, height, chi_square_excess(observation, squares), count)


def judged(
    observation: Observation,
    attempts: list[Attempt],
    seed: Sequence[int],
    recall: Recall = lambda name, calculate: calculate(),
    told: Callable[[int, float, float], None] = lambda number, misfit, spread: None,
) -> list[Attempt]:
    """Return attempts whose best has the posterior's moments, where Laplace's are not those.

    The members that have them are drawn where all attempts that fit have ended (`population`).
    """
    chosen = best(attempts)
    width = max(STRAIGHT * BOLTZMANN * observation.measurement.temperature, LEAST_WIDTH)
    bar = observation.unknowns.site_deviation(chosen.answer.covariance)
    if not chosen.fits or bar < width:
        return attempts
    proposals = [attempt.last for attempt in attempts if attempt.fits]
    drawn = population(observation, proposals, seed, recall, told)
    instead = replace(chosen, answer=drawn.moments, population=drawn)
    return [instead if attempt is chosen else attempt for attempt in attempts]


def _with_more_members(settings: InversionSettings, number: int) -> RoundSettings:
    more, first = settings.more_members**number, settings.rounds
    return replace(
        first,
        members_per_unknown=first.members_per_unknown * more,
        least_shrinking=first.least_shrinking ** (1 / more),
    )


def chi_square_excess(observation: Observation, squares: FloatArray) -> float:
    """Return how far χ² is above its mean in its deviations, the most over channels and over all.

    Parameters
    ----------
    observation : Observation
    squares : array, shape (datum,)
        Squared misfits in units of the errors' variance.
    """
    sets = [np.ones(squares.size, dtype=bool)]
    sets += [observation.channel == c for c in np.unique(observation.channel)]
    return max(float((squares[s].sum() - s.sum()) / np.sqrt(2 * s.sum())) for s in sets)


def best(attempts: list[Attempt]) -> Attempt:
    """Return the attempt with the most probable answer."""
    return min(attempts, key=lambda attempt: attempt.objective)


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
    """Return whether two attempts are equally far off the data."""
    least, most = sorted(_misfit(observation, attempt) for attempt in (one, other))
    return most < (1 + SAME_MISFIT) * least


def _misfit(observation: Observation, attempt: Attempt) -> float:
    return float(np.sqrt(squared_misfits(observation, attempt.data).mean()))
