"""Normal distributions of the unknowns, and their densities."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from disorder_landscape.model.parameters import FloatArray


@dataclass(frozen=True, eq=False)
class Gaussian:
    """A normal distribution: mean (unknown,), covariance (unknown, unknown)."""

    mean: FloatArray
    covariance: FloatArray

    def squared_distance(self, x: FloatArray) -> FloatArray:
        """Return the squared Mahalanobis distance of x (…, unknown) from the mean, shape (…,)."""
        off, precision = x - self.mean, np.linalg.inv(self.covariance)
        return np.asarray(np.einsum("...i,ij,...j->...", off, precision, off))

    def draw(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return an even number of samples, shape (sample, unknown), in pairs about the mean."""
        half = rng.normal(size=(count // 2, self.mean.size))
        spread = np.concatenate([half, -half]) @ np.linalg.cholesky(self.covariance).T
        return np.asarray(self.mean + spread)

    def draw_apart(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return samples, shape (sample, unknown), of which no two are a pair."""
        return self.draw(rng, 2 * count)[:count]

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold, to the last bit."""
        return {"mean": self.mean.tolist(), "covariance": self.covariance.tolist()}

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Return the distribution that `to_dict` described."""
        return cls(np.array(content["mean"]), np.array(content["covariance"]))


def log_density(gaussian: Gaussian, X: FloatArray) -> FloatArray:
    """Return the logarithm of a normal density at X (sample, unknown), shape (sample,).

    The constant with the power of 2π is left out.
    """
    determinant = np.linalg.slogdet(gaussian.covariance)[1]
    return np.asarray(-0.5 * (gaussian.squared_distance(X) + determinant))


def log_mixture(
    drawn: Sequence[tuple[Gaussian, int]],
    X: FloatArray,
    density: Callable[[Gaussian, FloatArray], FloatArray] = log_density,
) -> FloatArray:
    """Return the logarithm of the density of a mixture, shape (sample,).

    Parameters
    ----------
    drawn : sequence of (Gaussian, int)
        The normal distributions, and how many samples were drawn from each, which is its weight.
    X : array, shape (sample, unknown)
    density : callable
        The logarithm of the density of each, if they are no normal distributions.
    """
    count = np.array([number for _, number in drawn])
    log = np.array([density(gaussian, X) for gaussian, _ in drawn])
    return np.asarray(np.logaddexp.reduce(log + np.log(count / count.sum())[:, None], axis=0))
