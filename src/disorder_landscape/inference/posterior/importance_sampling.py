"""Samples of a posterior that is wider than conductances are straight: importance sampling.

Where the noise hides much, the posterior is as wide as a peak of the conductances or wider. Then it
is no normal distribution about one optimum: it bends, and has valleys beside valleys. But there the
answers of rounds and polishes are nearly as wide, so that samples of these, weighted with the exact
posterior, are samples of the posterior. If few of them have most of the weight, the next samples
are drawn from a normal distribution with the moments of the weighted ones, and so on; all count, as
if drawn from the mixture of all proposals (adaptive multiple importance sampling: Cornuet et al.,
Scand. J. Stat. 39, 798 (2012)). As long as a few samples have all the weight, their weights are
raised to a power below one (Koblents and Míguez, Stat. Comput. 25, 407 (2015)).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import brentq

from disorder_landscape.inference.problem.observation import Observation, objective, overall_misfit
from disorder_landscape.inference.problem.unknowns import Gaussian
from disorder_landscape.inference.search.proposals import log_mixture
from disorder_landscape.inference.search.regression_rounds import Recall
from disorder_landscape.model.parameters import FloatArray

AT_A_TIME = 128
"""Samples that are drawn before the next proposal is made, at least, …"""
PER_UNKNOWN = 12
"""… and for each unknown."""
WORTH = 150.0
"""Done when the samples are worth so many independent ones, …"""
WORTH_PER_UNKNOWN = 12.0
"""… and for each unknown, or …"""
ITERATIONS = 10
"""… after so many iterations."""
LEAST_SHARE = 0.25
"""Of the samples that are drawn at a time: what those that the next proposal comes from must be
worth."""
KEPT = 0.3
"""Proposals are drawn from again whose samples are worth this part of their number. Those that have
been fitted to few samples miss what these miss: with each fitted to those before, populations of a
normal posterior of eleven unknowns were too narrow by 4 %, and are right within 1 % now."""
WIDER = 1.2
"""Samples are drawn this much more widely than weighted ones lie, or an answer says."""


@dataclass(frozen=True, eq=False)
class Population:
    """Samples (sample, unknown), and weights (sample,) whose sum is one."""

    samples: FloatArray
    weight: FloatArray
    power: float = 1.0
    """To which the weights were raised: where it is less, the samples are of a wider distribution
    than the posterior."""

    @property
    def worth(self) -> float:
        """How many independent samples these are worth."""
        return float(1 / (self.weight**2).sum())

    @property
    def is_enough(self) -> bool:
        """Whether these are samples of the posterior, and as many as are needed."""
        needed = max(WORTH, WORTH_PER_UNKNOWN * self.samples.shape[1])
        return self.power == 1 and self.worth >= needed

    @property
    def moments(self) -> Gaussian:
        """The normal distribution of the same mean and covariance."""
        mean = self.weight @ self.samples
        off = self.samples - mean
        covariance = (off.T * self.weight) @ off / (1 - 1 / self.worth)
        return Gaussian(mean, (covariance + covariance.T) / 2)

    def draw(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return samples (count, unknown) of equal weight, by systematic resampling."""
        share = np.cumsum(self.weight)
        at = np.searchsorted(share / share[-1], (rng.random() + np.arange(count)) / count)
        return self.samples[at]


def population(
    observation: Observation,
    proposals: Sequence[Gaussian],
    seed: Sequence[int],
    recall: Recall = lambda name, calculate: calculate(),
    told: Callable[[int, float, float], None] = lambda number, misfit, spread: None,
) -> Population:
    """Draw samples of the posterior, or of a wider one if these are too few for that (`power`).

    Parameters
    ----------
    observation : Observation
    proposals : sequence of Gaussian
        Where the first samples come from, which must be about as wide as the posterior.
    seed : sequence of int
    recall : callable, optional
        `Checkpoint.recall`.
    told : callable, optional
        Told the number of each iteration, the root-mean-square misfit of its best sample in e²/h
        and the deviation of V in meV.
    """
    unknowns = observation.unknowns
    count = max(AT_A_TIME, PER_UNKNOWN * len(unknowns.names))
    drawn: list[tuple[Gaussian, int]] = []
    X, height = np.empty((0, len(unknowns.names))), np.empty(0)
    for number in range(ITERATIONS):
        rng = np.random.default_rng([*seed, number])
        each = 2 * -(-count // (2 * len(proposals)))
        drawn += [(proposal, each) for proposal in proposals]
        new = np.concatenate([proposal.draw(rng, each) for proposal in proposals])
        name = f"population.{'.'.join(map(str, seed))}.{number}"
        shown = recall(name, partial(_shown, observation, new))
        X, height = np.concatenate([X, new]), np.append(height, shown["height"])
        found = tamed(X, -0.5 * height - log_mixture(drawn, X), LEAST_SHARE * count)
        moments = found.moments
        told(number, shown["misfit"], unknowns.site_deviation(moments.covariance))
        if found.is_enough:
            break
        if found.worth < KEPT * len(X):
            proposals = [widened(moments)]
    return found


def widened(answer: Gaussian) -> Gaussian:
    """Return a wider distribution, as proposals of importance sampling have to be."""
    return Gaussian(answer.mean, WIDER**2 * answer.covariance)


def _shown(observation: Observation, X: FloatArray) -> dict[str, Any]:
    Y = observation.simulate(X)
    height = objective(observation, X, Y)
    return {
        "height": height.tolist(),
        "misfit": overall_misfit(observation, Y[int(height.argmin())]),
    }


def tamed(X: FloatArray, log_weight: FloatArray, worth: float) -> Population:
    """Return samples with weights to the highest power up to one that leaves them this worth."""

    def to_the(power: float) -> Population:
        weight = np.exp(power * (log_weight - log_weight.max()))
        return Population(X, weight / weight.sum(), power)

    whole = to_the(1.0)
    if whole.worth >= worth:
        return whole
    return to_the(float(brentq(lambda power: to_the(power).worth - worth, 0.0, 1.0)))
