"""From far to near: the unknowns regressed on the data, round after round.

The conductances are peaks of a few kT in the space of the unknowns: on the scale of a guess's error
they are too rough for lines through them. But what the unknowns are can be learned from the
conductances even so: as the network does for all wires, ridge regression does it for those that are
drawn about the present answer, a few hundred. Its error, by leaving out one wire at a time, says
how far to trust it, and the next wires are drawn accordingly, until the conductances are straight
lines over the answer's spread, which is where Gauss–Newton steps end it (`polish`). So a
measurement leads from the network's guess, or from the disorder model's prior, to the answer.

This is sequential neural posterior estimation (Papamakarios and Murray, NIPS 2016) with a linear
network: the wires of a round are drawn from a proposal, and what the regression learns from the
data is put back upon the prior, so that no datum counts twice. The linear network is the gain of an
ensemble Kalman filter (Evensen, Ocean Dynamics 53, 343 (2003)), in which data that lines through
the members do not explain count little, and the error is not the filter's own, which is far too
small, but that of members which were left out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Self

import numpy as np

from disorder_landscape.inference.observation import Observation
from disorder_landscape.inference.unknowns import Gaussian
from disorder_landscape.physics.parameters import FloatArray

Recall = Callable[[str, Callable[[], dict[str, Any]]], dict[str, Any]]
"""`Checkpoint.recall`: returns the result of a name, calculated now or before."""
RIDGES = np.logspace(-1, 1.5, 6)
"""Strengths of the ridge to choose from, in units of the noise and of what lines leave."""


@dataclass(frozen=True)
class RoundSettings:
    """How the rounds go about it."""

    members_per_unknown: float = 12.0
    """Wires that are simulated in each round, for each unknown, …"""
    least_members: int = 120
    """… and of how many there are at least."""
    share: float = 0.16
    """Of the data, the same in all rounds, …"""
    fine: float = 2.0
    """… until these stand still with less than this many times the noise unexplained. Then it is
    the noise that hides the rest, and they go on with all data."""
    wider: float = 1.2
    """The next round's wires are drawn this much more widely than the answer says, …"""
    nearer: float = 0.9
    farther: float = 4.0
    """… and as much more, or less, as the data lie farther out than this round's members, or nearer
    to the middle; between these factors in variance."""
    least_shrinking: float = 0.35
    """A round makes no direction's deviation smaller than this part of what it was."""
    unexplained: float = 0.3
    """Done when lines through the conductances leave less unexplained than this part of the noise,
    …"""
    patience: int = 8
    """… or when in so many rounds neither that has become less nor the spread, …"""
    narrower: float = 0.95
    """… by this factor at least: these lead nowhere."""
    rounds: int = 30


@dataclass(frozen=True, eq=False)
class Round:
    """What one round has found."""

    distribution: Gaussian
    misfit: float
    """Root-mean-square difference of the data and the members' mean, in e²/h."""
    unexplained: float
    """Root-mean-square difference of the members and the lines, in units of the noise."""
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
) -> Iterator[Round]:
    """Yield round after round, until the conductances are straight or rounds no longer help.

    Each is a function of the one before and of (seed, its number).
    """
    share, distribution = settings.share, start
    least, narrowest, since = np.inf, np.inf, 0
    for number in range(settings.rounds):
        part = observation.on_some_lines(share, np.random.default_rng(seed))
        rng = np.random.default_rng([*seed, number, 1])
        make = partial(_round, part, distribution, rng, settings)
        one = Round.from_dict(recall(f"round.{'.'.join(map(str, seed))}.{number}", make))
        yield one
        if one.unexplained < settings.unexplained:
            return
        narrower = one.spread < settings.narrower * narrowest
        since = 0 if narrower or one.unexplained < least else since + 1
        least, narrowest = min(least, one.unexplained), one.spread if narrower else narrowest
        if since == settings.patience:
            if share == 1 or least > settings.fine:
                return
            share, since = 1.0, 0
        distribution = one.distribution


def _round(
    observation: Observation,
    proposal: Gaussian,
    rng: np.random.Generator,
    settings: RoundSettings,
) -> dict[str, Any]:
    """Draw members, simulate them, and regress the unknowns on what they show: `Round.to_dict`."""
    unknowns, prior = observation.unknowns, observation.unknowns.prior
    root = np.linalg.cholesky(proposal.covariance)
    members = max(settings.least_members, round(settings.members_per_unknown * prior.mean.size))
    z = rng.normal(size=(members, prior.mean.size))
    Y = observation.simulate(proposal.mean + z @ root.T)
    left = variance_about_lines(z, Y)
    at, error = learn(observation, z, Y, left)
    share, directions = np.linalg.eigh(error)
    share = np.clip(share, settings.least_shrinking**2, 1 - 1e-3)
    error = (directions * share) @ directions.T
    # members' own answers have the variance 1 − error: do the data lie as far out as these?
    outside = (at**2).mean() / (1 - share).mean()
    widening = settings.wider**2 * float(np.clip(outside, settings.nearer, settings.farther))
    learned = Gaussian(proposal.mean + root @ at, root @ error @ root.T)
    answer = _upon_the_prior(learned, proposal, prior)
    wider = Gaussian(answer.mean, answer.covariance * widening)
    one = Round(
        distribution=wider,
        misfit=float(np.sqrt(((observation.data - Y.mean(axis=0)) ** 2).mean())),
        unexplained=float(np.sqrt((left / observation.variance).mean())),
        spread=unknowns.site_deviation(wider.covariance),
    )
    return one.to_dict()


def variance_about_lines(X: FloatArray, Y: FloatArray) -> FloatArray:
    """Return the variance (datum,) of Y (member, datum) about linear functions of X."""
    at, value = X.mean(axis=0), Y.mean(axis=0)
    slope = np.linalg.lstsq(X - at, Y - value, rcond=None)[0]
    left = Y - value - (X - at) @ slope
    degrees_of_freedom = max(1, len(X) - X.shape[1] - 1)
    return np.asarray((left**2).sum(axis=0) / degrees_of_freedom)


def learn(
    observation: Observation, z: FloatArray, Y: FloatArray, left: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Learn what members z (member, unknown) are from what they show, Y (member, datum).

    Ridge regression in the space of the members, on data in units of their noise and of what lines
    leave of them, `left` (datum,). The members show no noise of their own: what the measurement's
    does to the answer is known without drawing any.

    Returns
    -------
    at : array, shape (unknown,)
        What the measurement's are.
    error : array, shape (unknown, unknown)
        Mean product of the errors for members that were left out, and shown with noise.
    """
    members, middle = len(z), Y.mean(axis=0)
    scale = np.sqrt(observation.variance + left)
    A = (Y - middle) / scale
    of_noise = (A * (observation.variance / scale**2)) @ A.T
    values, vectors = np.linalg.eigh(A @ A.T)
    found: list[tuple[FloatArray, FloatArray]] = []
    for ridge in members * RIDGES:
        inverse = (vectors / (values + ridge)) @ vectors.T
        weights = inverse @ (z - z.mean(axis=0))
        left_out = ridge * weights / (ridge * np.diag(inverse) - 1 / members)[:, None]
        error = left_out.T @ left_out / members + weights.T @ of_noise @ weights
        found.append((weights, error))
    weights, error = min(found, key=lambda one: float(np.trace(one[1])))
    shown = A @ ((observation.data - middle) / scale)
    return np.asarray(z.mean(axis=0) + shown @ weights), error


def _upon_the_prior(learned: Gaussian, proposal: Gaussian, prior: Gaussian) -> Gaussian:
    """Put what was learned about members of a proposal upon the prior instead."""
    new, old, first = (np.linalg.inv(one.covariance) for one in (learned, proposal, prior))
    covariance = np.linalg.inv(first + new - old)
    mean = covariance @ (first @ prior.mean + new @ learned.mean - old @ proposal.mean)
    return Gaussian(mean, np.asarray((covariance + covariance.T) / 2))
