"""What an inversion has come to: the optima that it has found, and samples of the posterior."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2, norm

from disorder_landscape.inference.optimum import Optimum, best
from disorder_landscape.inference.posterior.importance_sampling import ImportanceSamples
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

    def more_probable(self, height: float) -> float:
        """Return how much of the posterior is more probable than this −2 log of its density.

        It is uniform over [0, 1] where the density is that of the truth: with samples whatever the
        posterior's shape, and without where it is normal about the best optimum. NaN if the samples
        are those of a wider distribution.
        """
        drawn = self.importance_samples
        if drawn is None:
            return float(chi2.cdf(height - self.best.objective, self.best.answer.mean.size))
        if drawn.height is None or drawn.power < 1:
            return float(np.nan)
        return float(drawn.weight[drawn.height < height].sum())

    def z_scores(self, truth: FloatArray) -> FloatArray:
        """Return the standard normal deviates of the truth's quantiles, shape (unknown,).

        They are normally distributed over measurements if the posteriors are right, whatever their
        shape. Of a normal distribution they are the distances from the mean in standard deviations.
        """
        drawn, answer = self.importance_samples, self.answer
        if drawn is None:
            return np.asarray((truth - answer.mean) / np.sqrt(np.diag(answer.covariance)))
        least = 0.5 / drawn.effective_sample_size
        return np.asarray(norm.ppf((drawn.weight @ (drawn.samples < truth)).clip(least, 1 - least)))

    def draw(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return an even number of samples of the posterior, shape (sample, unknown)."""
        drawn = self.importance_samples
        posterior = self.best.answer if drawn is None else drawn
        return posterior.draw(rng, count)
