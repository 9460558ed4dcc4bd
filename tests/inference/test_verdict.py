"""Verdicts on attempts that agree or not, and fit or not."""

from dataclasses import replace

import numpy as np
import pytest

from disorder_landscape.inference.optimum import Optimum, chi_square_excess, same_answer
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.posterior.samples import posterior_shares
from disorder_landscape.inference.posterior.weighted_samples import ImportanceSamples
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.verdict import (
    CONVERGED,
    NOT_CONVERGED,
    NOT_DESCRIBED,
    is_surely_right,
    verdict,
)
from linear_data import SIZE, Linear


def test_excess_looks_at_each_channel():
    class Channels:
        channel = np.repeat(np.arange(4), 100)
        variance, data = np.full(400, 0.01**2), np.zeros(400)

    simulated = np.full(400, 0.01)
    assert chi_square_excess(Channels, simulated) == pytest.approx(0.0)
    simulated[:100] *= np.sqrt(2.0)  # one channel is off
    assert chi_square_excess(Channels, simulated) == pytest.approx(100 / np.sqrt(200))


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
    """… and one that fits does not, but data as noisy as these need a start that agrees."""
    noisy = replace(linear, variance=np.full(40, 1.0))
    optima = [
        Optimum(
            answer=Gaussian(far * np.ones(SIZE), 1e-6 * np.eye(SIZE)),
            data=noisy.data + misfit,
            objective=40 * misfit**2,
            excess=(misfit**2 - 1) * np.sqrt(20),
            found_by=(far,),
        )
        for far, misfit in enumerate(misfits)
    ]
    assert verdict(noisy, Outcome(optima)) == expected
    same_attempt = [replace(one, found_by=(0,)) for one in optima]
    assert verdict(noisy, Outcome(same_attempt)) == NOT_CONVERGED


@pytest.mark.parametrize(("noise", "expected"), [(0.3, NOT_CONVERGED), (1e-3, CONVERGED)])
def test_one_answer_that_fits_is_enough_where_the_noise_hides_little(linear, noise, expected):
    measured = replace(linear, variance=np.full(40, noise**2))
    answer = Gaussian(np.zeros(SIZE), np.eye(SIZE))
    alone = Optimum(answer, measured.data, objective=0.0, excess=0.0)
    assert verdict(measured, Outcome([alone])) == expected
    few = Linear(measured.data[:20], linear.slope[:, :20], variance=measured.variance[:20])
    few_fit = Outcome([alone])
    assert verdict(few, few_fit) == NOT_CONVERGED  # a wrong answer may fit four for each unknown
    again = replace(alone, found_by=(0, 0))
    assert verdict(measured, Outcome([again])) == CONVERGED
    as_likely = Outcome([again, replace(alone, objective=1.0)])  # … which one start has found
    assert verdict(measured, as_likely) == expected


@pytest.mark.parametrize(("at_the_other", "expected"), [(1, CONVERGED), (40, NOT_CONVERGED)])
def test_samples_say_how_much_one_start_alone_has_found(linear, at_the_other, expected):
    """By Laplace's approximation half the posterior is at the optimum that one start has found."""
    noisy = replace(linear, variance=np.full(40, 0.3**2))
    there = [Gaussian(far * np.ones(SIZE), np.eye(SIZE)) for far in (0, 100)]
    optima = [
        Optimum(answer, noisy.data, objective=0.0, excess=0.0, found_by=(0,) * count)
        for answer, count in zip(there, (3, 1), strict=True)
    ]
    assert verdict(noisy, Outcome(optima)) == NOT_CONVERGED
    X = np.repeat([one.mean for one in there], [200 - at_the_other, at_the_other], axis=0)
    samples = ImportanceSamples(X, np.full(200, 1 / 200))
    share = posterior_shares(noisy, optima, samples)
    np.testing.assert_allclose(share, [1 - at_the_other / 200, at_the_other / 200])
    assert verdict(noisy, Outcome(optima, samples)) == expected


@pytest.mark.parametrize(("unknown", "expected"), [({}, True), ({"gamma": (0.1, 0.2)}, False)])
def test_no_answer_is_surely_right_with_several_parameters(linear, unknown, expected):
    given = replace(linear.unknowns.prior, alpha=(5.0, 15.0), **unknown)
    measured = replace(linear, unknowns=Unknowns(given), variance=np.full(40, 1e-6))
    assert is_surely_right(measured) == expected


def test_answers_are_the_same_that_error_bars_allow():
    """However small the distance is, along the axis that is known best it may be far."""
    covariance = np.diag([1.0, 1e-6, *np.ones(SIZE - 2)])
    about = Gaussian(np.zeros(SIZE), covariance)
    one = Optimum(about, np.zeros(40), 0.0, 0.0)
    observation = Linear(np.zeros(40), np.empty(0))
    for axis, far, same in [(0, 2.0, True), (1, 1e-3, True), (1, 0.1, False), (0, 6.0, False)]:
        other = replace(one, answer=Gaussian(far * np.eye(SIZE)[axis], covariance))
        assert same_answer(observation, one, other) == same
