"""Optima that starts have led to: which are the same, and when there have been enough starts."""

from dataclasses import replace

import numpy as np
import pytest

from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.search.gauss_newton import gauss_newton
from disorder_landscape.inference.search.optima import Optima
from disorder_landscape.model.parameters import BOLTZMANN
from linear_data import DATA, SIZE, Linear, Measured, posterior

COLD = Measured(temperature=1e-3)
AXIS = np.eye(SIZE)[0]


class Folds(Linear):
    """Data that do not depend on the sign of the first unknown."""

    def simulate(self, X):
        folded = X.copy()
        folded[:, 0] = X[:, 0] ** 2
        return super().simulate(folded)


@pytest.fixture
def folds():
    slope = np.random.default_rng(2).normal(size=(SIZE, DATA))
    measured = Folds(np.zeros(DATA), slope, variance=np.ones(DATA), measurement=COLD)
    return replace(measured, data=measured.simulate((2 * AXIS)[None])[0])


def optima_of(observation, **options):
    def steps(of, x, attempt, name, known, goal):
        return gauss_newton(of, x, known=known)

    return Optima(observation, observation, steps, **options)


def test_both_signs_are_found_and_counted(folds):
    """… with as many starts as a posterior needs that is much wider than kT."""
    optima = optima_of(folds)
    for side in (1.9, -2.2, 2.1, -1.8, 1.5, 2.3, -2.1):
        optima.start_from(side * AXIS, 0)
        assert not optima.is_settled
    assert optima.is_wide
    optima.start_from(2 * AXIS, 1)
    assert optima.is_settled
    one, other = optima.found
    np.testing.assert_allclose(one.answer.mean[0], 2, atol=0.3)
    np.testing.assert_allclose(other.answer.mean[0], -2, atol=0.3)
    assert (one.found_by, other.found_by) == ((0, 0, 0, 0, 1), (0, 0, 0))


def test_an_optimum_found_once_is_a_sign_of_more(folds):
    optima = optima_of(folds)
    for side in [2.0] * 9 + [-2.0]:
        optima.start_from(side * AXIS, 0)
    assert not optima.is_settled
    optima.start_from(-2.2 * AXIS, 0)
    assert optima.is_settled


def test_a_narrow_posterior_takes_three_starts_that_agree(folds):
    warm = replace(folds, measurement=Measured(temperature=1.0 / BOLTZMANN))
    optima = optima_of(warm)
    settled = []
    for _ in range(3):
        optima.start_from(2 * AXIS, 0)
        settled.append(optima.is_settled)
    assert settled == [False, False, True]
    assert not optima.is_wide
    assert optima.is_settled


def test_starts_far_above_the_best_are_left_with_some_of_the_data(folds):
    """What they would lead to with all data is not asked."""
    asked = []

    def steps(of, x, attempt, name, known, goal):
        asked.append((name, goal))
        covariance = 0.01 * np.eye(SIZE)
        return Gaussian(x, covariance)

    optima = Optima(folds, folds, steps)
    optima.start_from(2 * AXIS, 0)
    optima.start_from(40 * AXIS, 0)
    assert asked == [("0.0.some", "place"), ("0.0", "optimum"), ("0.1.some", "place")]
    assert len(optima.found) == 1
    optima.start_from(40 * AXIS, 0)  # again
    assert len(optima.found) == 1
    assert optima.starts == 3


def test_data_that_no_optimum_explains_are_not_settled(linear):
    """Steps that do not explain some of them are not continued; at last they are, with all."""
    off = replace(linear, data=linear.data + 10 * (-1.0) ** np.arange(DATA))
    optima = optima_of(off)
    for _ in range(20):
        optima.start_from(posterior(off).mean, 0)
    assert optima.found == []
    assert not optima.fits
    optima.end_at(posterior(off).mean, 0)
    assert len(optima.found) == 1
    assert not optima.fits
    assert not optima.is_settled
    assert not optima.is_exhausted


def test_little_noise_takes_two_starts_that_agree(linear):
    """However wide the posterior is for what the data do not tell."""
    quiet = replace(linear, variance=np.full(DATA, 1e-8), measurement=COLD)
    optima = optima_of(replace(quiet, data=quiet.slope.sum(axis=0)))
    for settled in (False, True):
        optima.start_from(np.zeros(SIZE), 0)
        assert optima.is_settled == settled
    assert not optima.is_wide
