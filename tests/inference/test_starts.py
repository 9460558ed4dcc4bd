"""The way of a start: steps with some of the data, the same for all starts, then with all."""

from dataclasses import replace

import numpy as np
import pytest

from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.search.gauss_newton import gauss_newton
from disorder_landscape.inference.search.optima import AGREEING, STARTS_WHEN_WIDE, Optima
from disorder_landscape.inference.search.starts import MORE_STARTS, MOST_STARTS, STARTS, Starts
from linear_data import DATA, SIZE, Ending, Linear, posterior

AXIS = np.eye(SIZE)[0]


class Parts(Linear):
    """Linear data whose parts are all of them with other errors."""

    def on_some_lines(self, share, fewest, rng):
        return replace(self, data=self.data + 1e-4 * rng.normal(size=DATA))


@pytest.fixture
def parts(linear):
    return Parts(**vars(linear))


def starts_of(observation, steps):
    return Starts(Optima(observation, Ending(where=steps)), np.random.default_rng(0))


def test_steps_use_data_that_are_the_same_for_all_starts_and_then_all(parts):
    asked = []

    def steps(of, x, attempt, name, known, goal):
        asked.append((name, goal, of))
        return gauss_newton(of, x, known=known)

    starts = starts_of(parts, steps)
    for attempt in (0, 1):
        starts.start_from(np.zeros(SIZE), attempt)
    assert [one[:2] for one in asked] == [
        ("0.0.some", "place"),
        ("0.0", "optimum"),
        ("1.1.some", "place"),
    ]
    assert asked[0][2] is asked[2][2] is starts.some
    assert asked[1][2] is parts
    (one,) = starts.optima.found
    assert one.found_by == (0, 1)
    np.testing.assert_allclose(one.answer.mean, posterior(parts).mean, atol=1e-6)


def test_starts_far_above_the_best_are_left_with_some_of_the_data(parts):
    """What they would lead to with all data is not asked."""
    asked = []

    def steps(of, x, attempt, name, known, goal):
        asked.append(name)
        return Gaussian(x, 0.01 * np.eye(SIZE))

    starts = starts_of(parts, steps)
    starts.start_from(posterior(parts).mean, 0)
    for _ in range(2):
        starts.start_from(40 * AXIS, 0)
    assert [name for name in asked if name.count(".") == 1] == ["0.0"]
    assert len(starts.optima.found) == 1
    assert starts.optima.starts == 3


def test_where_no_start_fits_there_are_few(parts):
    """The first is at the mean of the distribution that they are drawn from."""
    begun = []

    def steps(of, x, attempt, name, known, goal):
        if name.endswith("some"):
            begun.append(x)
        return Gaussian(40 * AXIS, 0.01 * np.eye(SIZE))

    starts = starts_of(parts, steps)
    about = Gaussian(np.ones(SIZE), np.eye(SIZE))
    starts.start_about(about, 0, np.random.default_rng(1))
    assert len(begun) == STARTS[0]
    np.testing.assert_array_equal(begun[0], about.mean)
    assert starts.optima.found == []
    assert not starts.optima.fits


@pytest.mark.parametrize("right", [None, 2])
def test_starts_at_the_best_of_draws_end_with_one_that_fits(parts, right):
    """… or where there have been as many as are tried; then others come to the same optimum."""
    begun = []

    def steps(of, x, attempt, name, known, goal):
        if name.endswith("some"):
            begun.append(x)
        if right is None or len(begun) <= right:
            return Gaussian(40 * AXIS, 0.01 * np.eye(SIZE))
        return gauss_newton(of, x, known=known)

    starts = starts_of(parts, steps)
    starts.start_at_best_of_draws(parts.unknowns.white_noise, 1, np.random.default_rng(1))
    assert starts.optima.fits == starts.optima.is_settled == (right is not None)
    assert len(begun) == (MORE_STARTS if right is None else right + AGREEING[1])
    assert len(np.unique(begun, axis=0)) == len(begun)


def test_starts_go_on_about_the_same_distribution(parts):
    """… as many as before, and at most as many as are worth their time; its mean is tried once."""
    begun = []

    def steps(of, x, attempt, name, known, goal):
        if name.endswith("some"):
            begun.append((attempt, x))
        return gauss_newton(of, x, known=known)

    wide = replace(parts, variance=np.ones(DATA))
    starts = starts_of(wide, steps)
    about = Gaussian(np.ones(SIZE), np.eye(SIZE))
    starts.start_about(about, 3, np.random.default_rng(1))
    assert starts.optima.starts == len(begun) == STARTS_WHEN_WIDE[0]
    for number, count in enumerate((32, 64, MOST_STARTS)):
        assert starts.optima.is_settled
        assert starts.optima.is_exhausted == (count > STARTS_WHEN_WIDE[1])
        starts.go_on(np.random.default_rng([2, number]))
        assert starts.optima.starts == len(begun) == count
    assert starts.optima.is_exhausted
    assert {attempt for attempt, _ in begun} == {3}
    assert [np.array_equal(x, about.mean) for _, x in begun] == [True] + (count - 1) * [False]
    assert len(np.unique([x for _, x in begun], axis=0)) == count
