"""From far to near: the unknowns regressed on the data, round after round.

The conductances are peaks of a few kT in the space of the unknowns. On the scale of a guess's error
they are far from linear in the unknowns. The converse works: the unknowns can be regressed on the
conductances. The network does so for all wires. Each round does it for some hundred wires that are
drawn about the present answer, by ridge regression. Wires of earlier rounds are used again with
weights (`proposals`). The error of the regression, from leaving out one wire at a time, is the
width of the distribution from which the next wires are drawn. Rounds end when the conductances are
linear across that width. Gauss–Newton steps go on from there (`gauss_newton`).

This is sequential neural posterior estimation (Papamakarios and Murray, NIPS 2016) with a linear
network. The wires of a round are drawn from a proposal instead of the prior, and the posterior is
corrected for that, so that no datum counts twice. The linear network is the gain of an ensemble
Kalman filter (Evensen, Ocean Dynamics 53, 343 (2003)), with two differences. Data that a linear fit
to the samples does not explain weigh little. The error is not the filter's own, which is far too
small, but that of samples which are left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Self

import numpy as np

from disorder_landscape.inference.checkpoint import Cache, uncached
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation, overall_misfit
from disorder_landscape.inference.search.gauss_newton import linearise, precision_of
from disorder_landscape.inference.search.network_features import NetworkFeatures
from disorder_landscape.inference.search.proposals import ProposalSamples
from disorder_landscape.inference.search.regression import residual_variance, ridge_regression


@dataclass(frozen=True)
class RoundSettings:
    """How many wires a round simulates, how far it trusts its answer, and when rounds end.

    Of 5+1 components answers do not depend on any of it; the time does (docs/design/decisions.md,
    "Rounds").
    """

    samples_per_unknown: float = 10.0
    """Wires that are simulated in each round, for each unknown, …"""
    least_samples: int = 100
    """… and at least so many in all."""
    share: float = 0.25
    """Share of the data that the first rounds use. When these end, rounds go on with all data. So
    close to the answer there may be several optima again, some standard deviations apart. …"""
    fewest: int = 7
    """… It has so many lines of μ and of B at least. …"""
    share_of_samples: float = 0.5
    """… Then this share of the samples is enough, since the data are nearly linear."""
    nearly_noise: float = 2.0
    """Rounds go on with all data also where they no longer help and a linear fit leaves less than
    this many times the noise: then it is the noise that hides the rest."""
    wider: float = 1.2
    """The next samples are drawn with this many times the standard deviation of the answer, …"""
    least_widening: float = 0.8
    most_widening: float = 4.0
    """… and with more if the data lie farther out than those of this round's samples, or less if
    they lie nearer to the middle. These limit that factor on the variance."""
    least_shrinking: float = 0.35
    """A round makes no principal axis of the distribution shorter than by this factor."""
    unexplained: float = 0.3
    """Rounds end when a linear fit to the conductances leaves less than this part of the noise and
    …"""
    times_gauss_newton: float = 2.0
    """… the distribution is less than this many times as wide as that of a Gauss–Newton step, root
    mean square over the unknowns' directions. Much noise hides that the conductances are not
    linear, and such steps would end in another optimum. …"""
    patience: int = 8
    """… They also end when for so many rounds neither residual nor spread has decreased, …"""
    least_improvement: float = 0.95
    """… the spread by this factor at least, …"""
    patience_when_straight: int = 3
    """… or in so many rounds, if the residual is already small enough."""
    rounds: int = 50
    most: int = 2000
    """Samples of this and of earlier rounds that are kept."""


WITH_NETWORK_FEATURES = RoundSettings(samples_per_unknown=20.0, most=4000, wider=1.1)
"""With features from a network, which is where components are many. Of twice the samples the error
of the regression is known better, so that the next samples can be drawn less widely."""


@dataclass(frozen=True, eq=False)
class Round:
    """What one round has found."""

    distribution: Gaussian
    """From which the next samples are drawn."""
    misfit: float
    """Root-mean-square difference of the data and the samples' mean, in e²/h."""
    unexplained: float
    """Root-mean-square residual of a linear fit to the samples' data, in units of the noise."""
    spread: float
    """The standard deviation of V in meV, root mean square over the sites."""

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold, to the last bit."""
        return {**vars(self), "distribution": self.distribution.to_dict()}

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Return the round that `to_dict` described."""
        return cls(**{**content, "distribution": Gaussian.from_dict(content["distribution"])})


def regression_rounds(
    observation: Observation,
    start: Gaussian,
    seed: list[int],
    settings: RoundSettings,
    cache: Cache = uncached,
    features: NetworkFeatures | None = None,
) -> Iterator[Round]:
    """Yield round after round, until the conductances are linear or rounds no longer help.

    Each is a function of the one before and of (seed, its number).

    Parameters
    ----------
    observation : Observation
    start : Gaussian
        From which the first samples are drawn.
    seed : list of int
    settings : RoundSettings
    cache : callable, optional
        `Checkpoint.cached`.
    features : NetworkFeatures, optional
        A network whose predictions are regressed on as well. The first rounds then use the data on
        the network's grid.
    """
    least, narrowest, since = np.inf, np.inf, 0
    key = ".".join(map(str, seed))
    share, distribution = settings.share, start
    count = max(settings.least_samples, round(settings.samples_per_unknown * start.mean.size))
    samples = _no_samples(observation, share, seed, settings, features)
    for number in range(settings.rounds):
        samples.draw(distribution, count, np.random.default_rng([*seed, number, 1]))
        make = partial(_round, samples, distribution, settings)
        one = Round.from_dict(cache(f"round.{key}.{number}", make))
        yield one
        straight = one.unexplained < settings.unexplained
        if straight and share == 1:
            make = partial(_times_laplace, observation, one)
            if cache(f"laplace.{key}.{number}", make)["times"] < settings.times_gauss_newton:
                return
        narrower = one.spread < settings.least_improvement * narrowest
        since = 0 if narrower or one.unexplained < least else since + 1
        least, narrowest = min(least, one.unexplained), one.spread if narrower else narrowest
        patience = settings.patience_when_straight if straight else settings.patience
        if (straight and share < 1) or since >= patience:
            if share == 1 or least > settings.nearly_noise:
                return
            share, since, least, narrowest = 1.0, 0, np.inf, np.inf
            count = round(settings.share_of_samples * count)
            samples = _no_samples(observation, share, seed, settings, features)
        distribution = one.distribution


def _times_laplace(observation: Observation, one: Round) -> dict[str, Any]:
    """Return how many `times` a round is as wide as the posterior if data were linear there."""
    precision = precision_of(observation, linearise(observation, one.distribution.mean)[1])
    ratios = precision @ one.distribution.covariance
    return {"times": float(np.sqrt(np.trace(ratios) / len(ratios)))}


def _no_samples(
    observation: Observation,
    share: float,
    seed: list[int],
    settings: RoundSettings,
    features: NetworkFeatures | None,
) -> ProposalSamples:
    """Return where the samples of rounds on a share of the data are collected, still empty."""
    if features is not None and share < 1:
        return ProposalSamples(features.on_grid, settings.most, features)
    some = observation.on_some_lines(share, settings.fewest, np.random.default_rng(seed))
    return ProposalSamples(some, settings.most)


def _round(samples: ProposalSamples, proposal: Gaussian, settings: RoundSettings) -> dict[str, Any]:
    """Simulate the samples, and regress the unknowns on their data: `Round.to_dict`."""
    observation = samples.observation
    unknowns, prior = observation.unknowns, observation.unknowns.white_noise
    X, Y, weight, features = samples.weighted()
    root = np.linalg.cholesky(proposal.covariance)
    z = np.linalg.solve(root, (X - proposal.mean).T).T
    residual = residual_variance(z, Y, weight)
    predicted, error = ridge_regression(observation, z, Y, residual, weight, features)
    share, directions = np.linalg.eigh(error)
    share = np.clip(share, settings.least_shrinking**2, 1 - 1e-3)
    error = (directions * share) @ directions.T
    # predictions for the samples have the variance 1 − error: is the data's as far out as these?
    outside = (predicted**2).mean() / (1 - share).mean()
    widening = settings.wider**2 * float(
        np.clip(outside, settings.least_widening, settings.most_widening)
    )
    found = Gaussian(proposal.mean + root @ predicted, root @ error @ root.T)
    answer = _with_the_prior_instead(found, proposal, prior)
    wider = Gaussian(answer.mean, answer.covariance * widening)
    one = Round(
        distribution=wider,
        misfit=overall_misfit(observation, weight @ Y / weight.sum()),
        unexplained=float(np.sqrt((residual / observation.variance).mean())),
        spread=unknowns.site_std(wider.covariance),
    )
    return one.to_dict()


def _with_the_prior_instead(found: Gaussian, proposal: Gaussian, prior: Gaussian) -> Gaussian:
    """Return found · prior / proposal: the posterior of a proposal turned into that of the prior.

    In precisions, the product of normal densities is a sum, and the quotient a difference.
    """
    new, old, first = (np.linalg.inv(one.covariance) for one in (found, proposal, prior))
    covariance = np.linalg.inv(first + new - old)
    mean = covariance @ (first @ prior.mean + new @ found.mean - old @ proposal.mean)
    return Gaussian(mean, np.asarray((covariance + covariance.T) / 2))
