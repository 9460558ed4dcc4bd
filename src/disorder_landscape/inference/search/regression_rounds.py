"""From far to near: the unknowns regressed on the data, round after round.

The conductances are peaks of a few kT in the space of the unknowns: on the scale of a guess's error
they are too rough for lines through them. But what the unknowns are can be learned from the
conductances even so: as the network does for all wires, ridge regression does it for those that are
drawn about the present answer, a few hundred (and those of earlier rounds, as far as they would
have been drawn, `samples`). Its error, by leaving out one wire at a time, says
how far to trust it, and the next wires are drawn accordingly, until the conductances are straight
lines over the answer's spread, which is where Gauss–Newton steps end it (`polish`). So a
measurement leads from the network's guess, or from the disorder model's prior, to the answer.

This is sequential neural posterior estimation (Papamakarios and Murray, NIPS 2016) with a linear
network: the wires of a round are drawn from a proposal, and what the regression learns from the
data is put back upon the prior, so that no datum counts twice. The linear network is the gain of an
ensemble Kalman filter (Evensen, Ocean Dynamics 53, 343 (2003)), in which data that lines through
the samples do not explain count little, and the error is not the filter's own, which is far too
small, but that of samples which were left out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Self

import numpy as np

from disorder_landscape.inference.problem.observation import Observation, overall_misfit
from disorder_landscape.inference.problem.unknowns import Gaussian
from disorder_landscape.inference.search.gauss_newton import laplace, linearise
from disorder_landscape.inference.search.network_features import Word
from disorder_landscape.inference.search.proposals import ProposalSamples
from disorder_landscape.inference.search.regression import learn, variance_about_lines

Recall = Callable[[str, Callable[[], dict[str, Any]]], dict[str, Any]]
"""`Checkpoint.recall`: returns the result of a name, calculated now or before."""


@dataclass(frozen=True)
class RoundSettings:
    """How the rounds go about it."""

    samples_per_unknown: float = 10.0
    """Wires that are simulated in each round, for each unknown, …"""
    least_samples: int = 100
    """… and of how many there are at least."""
    share: float = 0.25
    """Of the data, the same in all rounds until these are done, when they go on with all data: far
    closer, where there may be more than one optimum again, some deviations apart. …"""
    share_on_all_data: float = 0.5
    """… Then this part of the samples is enough: so close by, lines explain nearly all."""
    nearly_noise: float = 2.0
    """Rounds go on with all data, too, where they stand still with less than this many times the
    noise unexplained: then it is the noise that hides the rest."""
    wider: float = 1.2
    """The next round's wires are drawn this much more widely than the answer says, …"""
    least_widening: float = 0.8
    most_widening: float = 4.0
    """… and as much more, or less, as the data lie farther out than this round's samples, or nearer
    to the middle; between these factors in variance."""
    least_shrinking: float = 0.35
    """A round makes no direction's deviation smaller than this part of what it was."""
    unexplained: float = 0.3
    """Done when lines through the conductances leave less unexplained than this part of the noise
    and …"""
    times_gauss_newton: float = 2.0
    """… the spread is less than this many times that of Gauss–Newton steps: much noise hides that
    conductances are not straight, and such steps would end in the next valley, …"""
    patience: int = 8
    """… or when in so many rounds neither that has become less nor the spread, …"""
    progress: float = 0.95
    """… by this factor at least: these lead nowhere, …"""
    patience_when_straight: int = 3
    """… or in so many where lines leave no more unexplained than was said."""
    rounds: int = 50
    most: int = 2000
    """Samples of this and of earlier rounds that are kept."""


WITH_WORD = RoundSettings(samples_per_unknown=20.0, most=4000, wider=1.1)
"""Where a network's word on each wire is heard, which is where components are many. With twice the
samples the error of what they teach is known well enough to draw the next ones less widely."""


@dataclass(frozen=True, eq=False)
class Round:
    """What one round has found."""

    distribution: Gaussian
    misfit: float
    """Root-mean-square difference of the data and the samples' mean, in e²/h."""
    unexplained: float
    """Root-mean-square difference of the samples and the lines, in units of the noise."""
    spread: float
    """The deviation of V in meV, root mean square over the sites."""

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold, to the last bit."""
        return {**vars(self), "distribution": self.distribution.to_dict()}

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Return the round that `to_dict` described."""
        return cls(**{**content, "distribution": Gaussian.from_dict(content["distribution"])})


def rounds(
    observation: Observation,
    start: Gaussian,
    seed: list[int],
    settings: RoundSettings,
    recall: Recall = lambda name, calculate: calculate(),
    word: Word | None = None,
) -> Iterator[Round]:
    """Yield round after round, until the conductances are straight or rounds no longer help.

    Each is a function of the one before and of (seed, its number).

    Parameters
    ----------
    observation : Observation
    start : Gaussian
    seed : list of int
    settings : RoundSettings
    recall : callable, optional
        `Checkpoint.recall`.
    word : Word, optional
        Of a network, to regress on besides the data; these are then those on its grid.
    """
    least, narrowest, since = np.inf, np.inf, 0
    key = ".".join(map(str, seed))
    share, distribution = settings.share, start
    count = max(settings.least_samples, round(settings.samples_per_unknown * start.mean.size))
    samples = _samples(observation, share, seed, settings, word)
    for number in range(settings.rounds):
        samples.draw(distribution, count, np.random.default_rng([*seed, number, 1]))
        make = partial(_round, samples, distribution, settings)
        one = Round.from_dict(recall(f"round.{key}.{number}", make))
        yield one
        straight = one.unexplained < settings.unexplained
        if straight and share == 1:
            make = partial(_gauss_newton, observation, one)
            step = recall(f"near.{key}.{number}", make)
            if one.spread < settings.times_gauss_newton * step["spread"]:
                return
        narrower = one.spread < settings.progress * narrowest
        since = 0 if narrower or one.unexplained < least else since + 1
        least, narrowest = min(least, one.unexplained), one.spread if narrower else narrowest
        patience = settings.patience_when_straight if straight else settings.patience
        if (straight and share < 1) or since >= patience:
            if share == 1 or least > settings.nearly_noise:
                return
            share, since, least, narrowest = 1.0, 0, np.inf, np.inf
            count = round(settings.share_on_all_data * count)
            samples = _samples(observation, share, seed, settings, word)
        distribution = one.distribution


def _gauss_newton(observation: Observation, one: Round) -> dict[str, Any]:
    """Return the `spread` in meV that a Gauss–Newton step from a round's answer ends with."""
    slope = linearise(observation, one.distribution)[1]
    step = laplace(observation, one.distribution.mean, slope)
    return {"spread": observation.unknowns.site_deviation(step.covariance)}


def _samples(
    observation: Observation,
    share: float,
    seed: list[int],
    settings: RoundSettings,
    word: Word | None,
) -> ProposalSamples:
    if word is not None and share < 1:
        return ProposalSamples(word.seen, settings.most, word)
    some = observation.on_some_lines(share, np.random.default_rng(seed))
    return ProposalSamples(some, settings.most)


def _round(samples: ProposalSamples, proposal: Gaussian, settings: RoundSettings) -> dict[str, Any]:
    """Simulate the samples, and regress the unknowns on what they show: `Round.to_dict`."""
    observation = samples.observation
    unknowns, prior = observation.unknowns, observation.unknowns.prior
    X, Y, weight, said = samples.weighted()
    root = np.linalg.cholesky(proposal.covariance)
    z = np.linalg.solve(root, (X - proposal.mean).T).T
    left = variance_about_lines(z, Y, weight)
    at, error = learn(observation, z, Y, left, weight, said)
    share, directions = np.linalg.eigh(error)
    share = np.clip(share, settings.least_shrinking**2, 1 - 1e-3)
    error = (directions * share) @ directions.T
    # samples' own answers have the variance 1 − error: do the data lie as far out as these?
    outside = (at**2).mean() / (1 - share).mean()
    widening = settings.wider**2 * float(
        np.clip(outside, settings.least_widening, settings.most_widening)
    )
    learned = Gaussian(proposal.mean + root @ at, root @ error @ root.T)
    answer = _upon_the_prior(learned, proposal, prior)
    wider = Gaussian(answer.mean, answer.covariance * widening)
    one = Round(
        distribution=wider,
        misfit=overall_misfit(observation, weight @ Y / weight.sum()),
        unexplained=float(np.sqrt((left / observation.variance).mean())),
        spread=unknowns.site_deviation(wider.covariance),
    )
    return one.to_dict()


def _upon_the_prior(learned: Gaussian, proposal: Gaussian, prior: Gaussian) -> Gaussian:
    """Put what was learned about samples of a proposal upon the prior instead."""
    new, old, first = (np.linalg.inv(one.covariance) for one in (learned, proposal, prior))
    covariance = np.linalg.inv(first + new - old)
    mean = covariance @ (first @ prior.mean + new @ learned.mean - old @ proposal.mean)
    return Gaussian(mean, np.asarray((covariance + covariance.T) / 2))
