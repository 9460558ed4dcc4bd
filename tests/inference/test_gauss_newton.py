"""Gauss–Newton steps end at optima that are known, with their width."""

from dataclasses import replace

import numpy as np

from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.search.gauss_newton import (
    gauss_newton,
    laplace,
    linearise,
)
from linear_data import SIZE, UNKNOWNS, Linear, posterior


def test_gauss_newton_ends_at_the_posterior(linear):
    exact = posterior(linear)
    found = gauss_newton(linear, Gaussian(exact.mean + 0.01, 1e-4 * np.eye(SIZE)))
    np.testing.assert_allclose(found.mean, exact.mean, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(found.covariance, exact.covariance, rtol=1e-5, atol=1e-12)


def test_gauss_newton_ends_with_slopes_of_its_own_width(linear):
    """From so wide a start that the first are others, even if it is at the optimum."""
    waves = replace(linear, bend=0.05)
    truth = Gaussian(UNKNOWNS.prior.mean, np.eye(SIZE))
    waves = replace(waves, data=waves.simulate(truth.mean[None])[0])
    narrow = replace(truth, covariance=1e-8 * np.eye(SIZE))
    wide, expected = (
        laplace(waves, truth.mean, linearise(waves, one)[1]) for one in (truth, narrow)
    )
    found = gauss_newton(waves, truth)
    assert found.squared_distance(truth.mean) < 0.5
    apart = [abs(one.covariance / expected.covariance - 1).max() for one in (wide, found)]
    assert apart[0] > 0.3
    assert apart[1] < 0.05


def test_gauss_newton_follows_a_valley_that_bends():
    """On its floor, far from its end; steps as long as the tangent allows would not get there."""
    scale = np.sqrt(np.diag(UNKNOWNS.prior.covariance))

    class Valley(Linear):
        def simulate(self, X):
            z = (X - UNKNOWNS.prior.mean) / scale
            Y = np.zeros((len(X), 40))
            Y[:, 0], Y[:, 1] = z[:, 0], 5 * (z[:, 1] - z[:, 0] ** 2 + z[:, 0])
            return Y

    valley = Valley(1.5 * np.eye(40)[0], np.empty(0), variance=np.full(40, 0.3**2))
    floor = np.zeros(SIZE)
    floor[:2] = -1.5, 3.75
    start = Gaussian(UNKNOWNS.prior.mean + floor * scale, 1e-4 * np.diag(scale**2))
    Y = valley.simulate(gauss_newton(valley, start).mean[None])[0]
    assert ((Y - valley.data) ** 2 / valley.variance).sum() < 0.5


def test_slopes_are_the_derivatives(linear):
    value, slope = linearise(linear, Gaussian(np.ones(SIZE), 1e-2 * np.eye(SIZE)))
    np.testing.assert_allclose(value, linear.slope.sum(axis=0), rtol=1e-12)
    np.testing.assert_allclose(slope, linear.slope, atol=1e-9)
