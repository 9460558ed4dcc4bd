"""Where an attempt at explaining the data has ended, and whether the noise explains the rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from disorder_landscape.inference.posterior.importance_sampling import Population
from disorder_landscape.inference.problem.observation import Observation, objective, squared_misfits
from disorder_landscape.inference.problem.unknowns import Gaussian
from disorder_landscape.model.parameters import FloatArray

TOLERATED = 3.5
"""χ² of all data, or of one channel's, may lie this many of its own deviations above its mean."""


@dataclass(frozen=True, eq=False)
class Attempt:
    """Where rounds and their polish have ended."""

    last: Gaussian
    """Where samples of one more round would have been drawn."""
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
    """Samples of the posterior, where it is not the normal distribution of the answer."""

    @property
    def fits(self) -> bool:
        """Whether the noise explains what is left of the misfit."""
        return self.excess <= TOLERATED

    @property
    def is_posterior(self) -> bool:
        """Whether the error bars are those of the posterior, as far as is known."""
        return self.population is None or self.population.is_enough

    def draw(self, rng: np.random.Generator, samples: int) -> FloatArray:
        """Return an even number of samples of the posterior, shape (sample, unknown)."""
        return (self.answer if self.population is None else self.population).draw(rng, samples)


def attempt_at(observation: Observation, last: Gaussian, answer: Gaussian, count: int) -> Attempt:
    """Return the attempt whose rounds and polish have ended there."""
    data = observation.simulate(answer.mean[None])[0]
    squares = squared_misfits(observation, data)
    height = float(objective(observation, answer.mean, data))
    return Attempt(last, answer, data, height, chi_square_excess(observation, squares), count)


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
