"""The end of one attempt at explaining the data, and whether the noise explains the misfit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from disorder_landscape.inference.posterior.importance_sampling import ImportanceSamples
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import (
    Observation,
    objective,
    squared_misfits,
)
from disorder_landscape.model.parameters import FloatArray

TOLERATED = 3.5
"""χ² of all data, or of one channel's, may be this many of its standard deviations above its
mean."""


@dataclass(frozen=True, eq=False)
class Attempt:
    """The end of the rounds and of the Gauss–Newton steps that follow them."""

    last_proposal: Gaussian
    """From which one more round would have drawn its samples."""
    answer: Gaussian
    """The posterior: Laplace's approximation, or mean and covariance of the importance samples."""
    data: FloatArray
    """Simulated data of the most probable wire, shape (datum,)."""
    objective: float
    """−2 log of its posterior density, up to a constant."""
    excess: float
    """(χ² − its mean) / its standard deviation: of all data, or of one channel, if that is more."""
    rounds: int
    """How many there were."""
    importance_samples: ImportanceSamples | None = None
    """Of the posterior, where it is no normal distribution."""

    @property
    def fits(self) -> bool:
        """Whether the noise explains the misfit."""
        return self.excess <= TOLERATED

    @property
    def is_posterior(self) -> bool:
        """Whether the error bars are those of the posterior, as far as is known."""
        return self.importance_samples is None or self.importance_samples.is_enough

    def draw(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return an even number of samples of the posterior, shape (sample, unknown)."""
        posterior = self.answer if self.importance_samples is None else self.importance_samples
        return posterior.draw(rng, count)


def attempt_at(
    observation: Observation, last_proposal: Gaussian, answer: Gaussian, rounds: int
) -> Attempt:
    """Return the attempt whose rounds and Gauss–Newton steps end there."""
    data = observation.simulate(answer.mean[None])[0]
    squares = squared_misfits(observation, data)
    height = float(objective(observation, answer.mean, data))
    excess = chi_square_excess(observation, squares)
    return Attempt(last_proposal, answer, data, height, excess, rounds)


def chi_square_excess(observation: Observation, squares: FloatArray) -> float:
    """Return (χ² − its mean) / its standard deviation, the largest over all data and each channel.

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
