"""Verdicts on attempts that agree or not, and fit or not."""

from dataclasses import replace

import numpy as np
import pytest

from disorder_landscape.inference.attempt import Attempt, chi_square_excess
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.verdict import (
    CONVERGED,
    NOT_CONVERGED,
    NOT_DESCRIBED,
    same_answer,
    verdict,
)
from linear_data import SIZE, UNKNOWNS, Linear


def test_excess_looks_at_each_channel():
    class Channels:
        channel = np.repeat(np.arange(4), 100)

    squares = np.ones(400)
    assert chi_square_excess(Channels, squares) == pytest.approx(0.0)
    squares[:100] = 2.0  # one channel is off
    assert chi_square_excess(Channels, squares) == pytest.approx(100 / np.sqrt(200))


@pytest.mark.parametrize(
    ("misfits", "expected"),
    [
        ((2.0, 2.05), NOT_DESCRIBED),
        ((2.3, 2.0), NOT_CONVERGED),
        ((1.0, 2.0), NOT_CONVERGED),
        ((1.35, 1.39), NOT_CONVERGED),  # but for the noise, 0.91 and 0.97
        ((1.35, 1.36), NOT_DESCRIBED),
    ],
)
def test_answers_that_are_equally_bad_say_that_the_model_is(linear, misfits, expected):
    """… and one that fits does not, but data as noisy as these need a second that agrees."""
    noisy = replace(linear, variance=np.full(40, 1.0))
    attempts = [
        Attempt(
            last_proposal=UNKNOWNS.prior,
            answer=Gaussian(far * np.ones(SIZE), 1e-6 * np.eye(SIZE)),
            data=noisy.data + misfit,
            objective=40 * misfit**2,
            excess=(misfit**2 - 1) * np.sqrt(20),
            rounds=5,
        )
        for far, misfit in enumerate(misfits)
    ]
    assert verdict(noisy, attempts) == expected


@pytest.mark.parametrize(("noise", "expected"), [(0.3, NOT_CONVERGED), (1e-3, CONVERGED)])
def test_one_answer_that_fits_is_enough_where_the_noise_hides_little(linear, noise, expected):
    measured = replace(linear, variance=np.full(40, noise**2))
    answer = Gaussian(np.zeros(SIZE), np.eye(SIZE))
    alone = Attempt(answer, answer, measured.data, objective=0.0, excess=0.0, rounds=5)
    assert verdict(measured, [alone]) == expected
    few = Linear(measured.data[:20], linear.slope[:, :20], variance=measured.variance[:20])
    assert verdict(few, [alone]) == NOT_CONVERGED  # a wrong answer may fit four for each unknown
    assert verdict(measured, [alone, replace(alone, objective=1.0)]) == CONVERGED


def test_answers_are_the_same_that_error_bars_allow():
    """However small the distance is, along the axis that is known best it may be far."""
    covariance = np.diag([1.0, 1e-6, *np.ones(SIZE - 2)])
    about = Gaussian(np.zeros(SIZE), covariance)
    one = Attempt(about, about, np.zeros(40), 0.0, 0.0, 5)
    observation = Linear(np.zeros(40), np.empty(0))
    for axis, far, same in [(0, 2.0, True), (1, 1e-3, True), (1, 0.1, False), (0, 6.0, False)]:
        other = replace(one, answer=Gaussian(far * np.eye(SIZE)[axis], covariance))
        assert same_answer(observation, one, other) == same
