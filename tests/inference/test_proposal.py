"""Student's t distributions, from which importance sampling draws."""

import numpy as np
import pytest
from scipy.stats import kstest, multivariate_t

from disorder_landscape.inference.posterior import proposal
from disorder_landscape.inference.problem.gaussian import Gaussian, log_density, log_mixture

RNG = np.random.default_rng(3)


def scale_of(size):
    root = RNG.normal(size=(size, size))
    return Gaussian(RNG.normal(size=size), root @ root.T + np.eye(size))


@pytest.mark.parametrize("size", [3, 12])
def test_the_density_is_that_of_scipy(size):
    scale, degrees = scale_of(size), max(8, size)
    X = proposal.draw(scale, RNG, 50)
    exact = multivariate_t(scale.mean, scale.covariance, df=degrees).logpdf(X)
    ours = proposal.log_density(scale, X) - size / 2 * np.log(2 * np.pi)
    np.testing.assert_allclose(ours, exact, rtol=1e-10)


@pytest.mark.parametrize("size", [3, 12])
def test_samples_have_that_density(size):
    """Their squared distances over their number of directions have an F distribution."""
    scale, degrees = scale_of(size), max(8, size)
    X = proposal.draw(scale, RNG, 4000)
    squares = scale.squared_distance(X)[:2000] / size  # the others are their mirror images
    assert kstest(squares, "f", (size, degrees)).pvalue > 0.01
    np.testing.assert_allclose(X[:2000] - scale.mean, scale.mean - X[2000:], atol=1e-12)


def test_a_mixture_has_the_mean_density_of_its_parts():
    one, other = scale_of(4), scale_of(4)
    X = one.draw(RNG, 10)
    of_both = log_mixture([(one, 30), (other, 10)], X, proposal.log_density)
    each = [np.exp(proposal.log_density(of, X)) for of in (one, other)]
    np.testing.assert_allclose(np.exp(of_both), 0.75 * each[0] + 0.25 * each[1])
    normal = log_mixture([(one, 5)], X)
    np.testing.assert_allclose(normal, log_density(one, X))
