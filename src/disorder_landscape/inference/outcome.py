"""What an inversion has come to: the optima that it has found, and samples of the posterior."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from disorder_landscape.inference.optimum import Optimum, best
from disorder_landscape.inference.posterior.weighted_samples import ImportanceSamples
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.model.parameters import FloatArray


@dataclass(frozen=True, eq=False)
class Outcome:
    """What an inversion has come to."""

    optima: Sequence[Optimum]
    """In the order in which they were found."""
    importance_samples: ImportanceSamples | None = None
    """Of the posterior, where it is no normal distribution."""
    attempts: int = 1
    rounds: int = 0

    @property
    def best(self) -> Optimum:
        """The most probable optimum."""
        return best(self.optima)

    @property
    def answer(self) -> Gaussian:
        """The posterior, or the normal distribution of the importance samples' moments."""
        drawn = self.importance_samples
        return self.best.answer if drawn is None else drawn.moments

    @property
    def is_posterior(self) -> bool:
        """Whether the error bars are those of the posterior, as far as is known."""
        return self.importance_samples is None or self.importance_samples.is_enough

    def draw(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return an even number of samples of the posterior, shape (sample, unknown)."""
        drawn = self.importance_samples
        posterior = self.best.answer if drawn is None else drawn
        return posterior.draw(rng, count)
