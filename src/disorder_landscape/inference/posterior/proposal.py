"""What samples are drawn from: Student's t distributions, whose tails are heavier than normal ones.

A normal distribution that is narrower than the posterior draws next to nothing where much of the
posterior is, and the effective sample size does not tell. The tails of a t distribution go on, so
that such regions are found, and have a large weight then (Cappé et al., Stat. Comput. 18, 447). (Of
two wires of ten components with noise of 0.01 e²/h and a posterior that bends, Mahalanobis'
distance squared of the truth was 34 and 28 with normal proposals, and is 12 and 26 like this; with
several times the samples it is 6 and 18. Of a posterior that bends this distance is not χ²: 8 and
76 % of these posteriors are more probable than the truth.)
"""

from __future__ import annotations

import numpy as np
from scipy.special import gammaln

from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.model.parameters import FloatArray

FEWEST_DEGREES = 8
"""Degrees of freedom are as many as unknowns, at least these."""


def draw(scale: Gaussian, rng: np.random.Generator, count: int) -> FloatArray:
    """Return an even number of samples, shape (sample, unknown), in pairs about the mean.

    Parameters
    ----------
    scale : Gaussian
        Whose covariance is the scale matrix of the t distribution.
    rng : Generator
    count : int
    """
    off = scale.draw(rng, count) - scale.mean
    degrees = _degrees(scale)
    shrink = np.sqrt(rng.chisquare(degrees, size=count // 2) / degrees)
    return np.asarray(scale.mean + off / np.concatenate([shrink, shrink])[:, None])


def log_density(scale: Gaussian, X: FloatArray) -> FloatArray:
    """Return the logarithm of the density at X (sample, unknown), shape (sample,).

    The constant with the power of 2π is left out, as it is of normal densities.
    """
    n, degrees = scale.mean.size, _degrees(scale)
    constant = gammaln((degrees + n) / 2) - gammaln(degrees / 2) - n / 2 * np.log(degrees / 2)
    determinant = np.linalg.slogdet(scale.covariance)[1]
    tail = (degrees + n) / 2 * np.log1p(scale.squared_distance(X) / degrees)
    return np.asarray(constant - 0.5 * determinant - tail)


def _degrees(scale: Gaussian) -> int:
    return max(FEWEST_DEGREES, scale.mean.size)
