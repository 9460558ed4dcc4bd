"""Unknowns in which a posterior is straight that is bent in white noise.

Where the data fix only the sum of two parameters, the posterior is a narrow ridge. It is straight
if both are normal. A uniform one is Φ(ξ) of the white noise ξ, so that the ridge bends there, and
no normal distribution is like it. In the parameter itself it is straight again, between two walls.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from disorder_landscape.inference.problem.distributions import Uniform
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.model.parameters import FloatArray

WIDE = 0.2
"""A uniform parameter is straightened if its ξ is uncertain by more than this …"""
RIDGE = 0.3
"""… and by less than this part of that if all other unknowns were known."""


@dataclass(frozen=True, eq=False)
class Straightened:
    """White noise, but for some uniform parameters: these in units of their standard deviation."""

    parameters: dict[int, Uniform]
    """By their place among the unknowns."""

    @classmethod
    def about(cls, answer: Gaussian, unknowns: Unknowns) -> Self:
        """Return the variables in which a posterior is straight that is about like this."""
        std = np.sqrt(np.diag(answer.covariance))
        alone = 1 / np.sqrt(np.diag(np.linalg.inv(answer.covariance)))
        bent = (std > WIDE) & (alone < RIDGE * std)
        places = ((unknowns.names.index(name), of) for name, of in unknowns.parameters.items())
        return cls({k: of for k, of in places if isinstance(of, Uniform) and bent[k]})

    def of_white_noise(self, X: FloatArray) -> FloatArray:
        """Return the straight variables of white noise, both of shape (…, unknown)."""
        found = X.copy()
        for k, of in self.parameters.items():
            found[..., k] = (of.value(X[..., k]) - of.mean) / of.std
        return found

    def white_noise(self, straight: FloatArray) -> FloatArray:
        """Return the white noise of straight variables; beyond a wall, that of the wall."""
        found = straight.copy()
        for k, of in self.parameters.items():
            found[..., k] = of.standard(of.mean + of.std * straight[..., k])
        return found

    def log_stretch(self, straight: FloatArray) -> FloatArray:
        """Return log |dξ/d(straight)|, shape (sample,); −∞ beyond a wall."""
        X, total = self.white_noise(straight), np.zeros(len(straight))
        for k, of in self.parameters.items():
            inside = abs(straight[:, k]) < (of.high - of.low) / (2 * of.std)
            total += np.where(inside, np.log(of.std / of.slope(X[:, k])), -np.inf)
        return total

    def of_gaussian(self, answer: Gaussian) -> Gaussian:
        """Return a normal distribution of white noise in straight variables, to first order."""
        stretch = np.ones(answer.mean.size)
        for k, of in self.parameters.items():
            stretch[k] = float(of.slope(answer.mean[k])) / of.std
        return Gaussian(
            self.of_white_noise(answer.mean), stretch[:, None] * answer.covariance * stretch
        )
