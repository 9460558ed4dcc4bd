"""Optima that starts have led to: which are the same, and when there have been enough starts."""

from dataclasses import replace

import numpy as np
import pytest

from disorder_landscape.inference.optimum import Optimum, add
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.search import optima as search_optima
from disorder_landscape.inference.search.gauss_newton import gauss_newton
from disorder_landscape.inference.search.optima import Optima
from linear_data import DATA, SIZE, Ending, Linear, posterior

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
    measured = Folds(np.zeros(DATA), slope, variance=np.ones(DATA))
    return replace(measured, data=measured.simulate((2 * AXIS)[None])[0])


def optima_of(observation):
    def steps(of, x, attempt, name, known, goal):
        return gauss_newton(of, x, known=known)

    return Optima(observation, Ending(where=steps))


def test_both_signs_are_found_and_counted(folds):
    """… with as many starts as a posterior needs that is wide."""
    optima = optima_of(folds)
    for side in [1.9, -2.2, 2.1, -1.8, 1.5] * 3:
        optima.start_at(side * AXIS, 0)
        assert not optima.is_settled
    assert optima.is_wide
    optima.start_at(2 * AXIS, 1)
    assert optima.is_settled
    one, other = optima.found
    np.testing.assert_allclose(one.answer.mean[0], 2, atol=0.3)
    np.testing.assert_allclose(other.answer.mean[0], -2, atol=0.3)
    assert (one.found_by, other.found_by) == (9 * (0,) + (1,), 6 * (0,))


def test_an_optimum_found_once_is_a_sign_of_more(folds):
    optima = optima_of(folds)
    for side in [2.0] * 15 + [-2.0]:
        optima.start_at(side * AXIS, 0)
    assert not optima.is_settled
    for side in (-2.2, -2.1):
        optima.start_at(side * AXIS, 0)
    assert optima.is_settled


def test_a_narrow_posterior_takes_three_starts_that_agree(folds, monkeypatch):
    monkeypatch.setattr(search_optima, "WIDE", 1.0)
    optima = optima_of(folds)
    settled = []
    for _ in range(3):
        optima.start_at(2 * AXIS, 0)
        settled.append(optima.is_settled)
    assert settled == [False, False, True]
    assert not optima.is_wide
    assert optima.is_settled


def test_several_optima_are_wide_however_narrow_each_is(folds, monkeypatch):
    monkeypatch.setattr(search_optima, "WIDE", 1.0)
    optima = optima_of(folds)
    for side in 3 * [2.0, -2.0]:
        assert not optima.is_settled
        optima.start_at(side * AXIS, 0)
    assert optima.is_wide
    one, other = optima.found
    optima.found[1] = replace(other, objective=one.objective + 20)
    assert not optima.is_wide


def test_ends_that_are_near_but_not_as_good_do_not_agree(linear):
    """… though error bars allow them to be the same: the better one is kept."""
    exact = posterior(linear)
    off = exact.mean + 1.5 * np.sqrt(np.diag(exact.covariance))
    ends = [off, exact.mean, exact.mean, off]

    def steps(of, x, attempt, name, known, goal):
        return Gaussian(x, exact.covariance)

    optima = Optima(linear, Ending(where=steps))
    for attempt, end in enumerate(ends):
        optima.start_at(end, attempt)
    (one,) = optima.found
    assert one.found_by == (1, 2)
    assert one.answer.mean is ends[2]


def test_data_that_no_optimum_explains_are_not_settled(linear):
    off = replace(linear, data=linear.data + 10 * (-1.0) ** np.arange(DATA))
    optima = optima_of(off)
    for _ in range(20):
        optima.start_at(posterior(off).mean, 0)
    assert len(optima.found) == 1
    assert not optima.fits
    assert not optima.is_settled
    assert not optima.is_exhausted


def test_little_noise_takes_two_starts_that_agree(linear):
    """However wide the posterior is for what the data do not tell."""
    quiet = replace(linear, variance=np.full(DATA, 1e-8))
    optima = optima_of(replace(quiet, data=quiet.slope.sum(axis=0)))
    for settled in (False, True):
        optima.start_at(np.zeros(SIZE), 0)
        assert optima.is_settled == settled
    assert not optima.is_wide


def test_an_optimum_is_found_again_and_not_twice(linear):
    """… where the error bars of another, which is found first, allow it to be that one too."""
    near = Gaussian(AXIS, 0.01 * np.eye(SIZE))
    wide, sharp = (
        Optimum(answer, linear.data, height, 0.0)
        for answer, height in [(Gaussian(np.zeros(SIZE), np.eye(SIZE)), 2.0), (near, 1.0)]
    )
    found = [wide, sharp]
    assert add(linear, found, sharp) == 1
    assert found[0] is wide
    assert found[1].found_by == (0, 0)
