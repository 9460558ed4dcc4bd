"""Gauss–Newton steps end at optima that are known, with their width."""

import numpy as np

from disorder_landscape.inference.search.gauss_newton import (
    gauss_newton,
    linearise,
)
from linear_data import SIZE, Linear, posterior


def test_gauss_newton_ends_at_the_posterior(linear):
    exact = posterior(linear)
    found = gauss_newton(linear, exact.mean + 0.01)
    np.testing.assert_allclose(found.mean, exact.mean, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(found.covariance, exact.covariance, rtol=1e-5, atol=1e-12)


def test_gauss_newton_follows_a_valley_that_bends():
    """On its floor, far from its end; steps as long as the tangent allows would not get there."""

    class Valley(Linear):
        def simulate(self, X):
            Y = np.zeros((len(X), 40))
            Y[:, 0], Y[:, 1] = X[:, 0], 5 * (X[:, 1] - X[:, 0] ** 2 + X[:, 0])
            return Y

    valley = Valley(1.5 * np.eye(40)[0], np.empty(0), variance=np.full(40, 0.3**2))
    floor = np.zeros(SIZE)
    floor[:2] = -1.5, 3.75
    Y = valley.simulate(gauss_newton(valley, floor).mean[None])[0]
    assert ((Y - valley.data) ** 2 / valley.variance).sum() < 0.5


def test_slopes_are_the_derivatives(linear):
    value, slope = linearise(linear, np.ones(SIZE))
    np.testing.assert_allclose(value, linear.slope.sum(axis=0), rtol=1e-12)
    np.testing.assert_allclose(slope, linear.slope, atol=1e-9)
