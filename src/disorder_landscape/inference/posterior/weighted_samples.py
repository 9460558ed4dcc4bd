"""Samples that are weighted with the exact posterior, and what they tell of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from disorder_landscape.inference.problem.gaussian import Gaussian, log_density
from disorder_landscape.inference.problem.observation import Observation, objective
from disorder_landscape.model.parameters import FloatArray

ENOUGH = 100.0
"""The least effective sample size that is enough, …"""
ENOUGH_PER_UNKNOWN = 12.0
"""… and for each unknown."""


@dataclass(frozen=True, eq=False)
class ImportanceSamples:
    """Samples (sample, unknown), and weights (sample,) whose sum is one."""

    samples: FloatArray
    weight: FloatArray
    power: float = 1.0
    """To which the weights are raised. If it is less than one, the samples are those of a wider
    distribution than the posterior."""
    log_mean_weight: float = np.nan
    """The logarithm of the mean of the weights before they are normalised: of the evidence, where
    these are densities."""
    height: FloatArray | None = None
    """−2 log of the posterior density at each, up to the constant of `objective`."""

    @property
    def effective_sample_size(self) -> float:
        """As many independent samples have the same variance (Kish): 1 / Σ weight²."""
        return float(1 / (self.weight**2).sum())

    @property
    def is_enough(self) -> bool:
        """Whether these are samples of the posterior, and as many as are needed."""
        return self.power == 1 and self.effective_sample_size >= self._needed

    @property
    def _needed(self) -> float:
        return float(max(ENOUGH, ENOUGH_PER_UNKNOWN * self.samples.shape[1]))

    @property
    def still_needed(self) -> int:
        """How many more samples will be enough, if they are as effective as these."""
        return int(np.ceil(len(self.samples) * (self._needed / self.effective_sample_size - 1)))

    @property
    def moments(self) -> Gaussian:
        """The normal distribution of the same mean and covariance."""
        own = self.uncorrected_moments
        return Gaussian(own.mean, own.covariance / (1 - 1 / self.effective_sample_size))

    @property
    def uncorrected_moments(self) -> Gaussian:
        """The same without the correction for the finite number of samples."""
        mean = self.weight @ self.samples
        off = self.samples - mean
        covariance = (off.T * self.weight) @ off
        return Gaussian(mean, (covariance + covariance.T) / 2)

    def moments_of(self, values: FloatArray) -> tuple[float, float]:
        """Return mean and standard deviation of something of each sample, values (sample,)."""
        of = replace(self, samples=values[:, None]).moments
        return float(of.mean[0]), float(np.sqrt(of.covariance[0, 0]))

    def draw(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return samples (count, unknown) of equal weight, by systematic resampling."""
        share = np.cumsum(self.weight)
        at = np.searchsorted(share / share[-1], (rng.random() + np.arange(count)) / count)
        return self.samples[at]


def weighted_samples(
    observation: Observation, answer: Gaussian, X: FloatArray
) -> ImportanceSamples:
    """Return samples X (sample, unknown) of an answer, weighted with the exact posterior."""
    height = objective(observation, X, observation.simulate(X))
    return tempered(X, -0.5 * height - log_density(answer, X), 0.0)


def tempered(X: FloatArray, log_weight: FloatArray, least: float) -> ImportanceSamples:
    """Return samples with weights to the largest power that leaves this effective sample size.

    The power is one if the weights themselves have it. Weights of zero, of which the logarithm is
    −∞, stay zero.
    """
    log_mean = float(np.logaddexp.reduce(log_weight) - np.log(log_weight.size))
    counts = np.isfinite(log_weight)

    def to_the(power: float) -> ImportanceSamples:
        weight = np.zeros(log_weight.size)
        weight[counts] = np.exp(power * (log_weight[counts] - log_weight.max()))
        return ImportanceSamples(X, weight / weight.sum(), power, log_mean)

    whole = to_the(1.0)
    if whole.effective_sample_size >= least:
        return whole
    return to_the(
        float(brentq(lambda power: to_the(power).effective_sample_size - least, 0.0, 1.0))
    )
