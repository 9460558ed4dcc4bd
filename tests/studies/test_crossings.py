"""Crossings of learning curves and the power law through them, where both are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from disorder_landscape.studies.crossings import (
    LearningCurve,
    fit_power_law,
    learning_curves,
    resampled_needed,
)
from disorder_landscape.studies.trainings_table import Result

RESULT = Result(
    name="n", key="", dataset="", components=5, amplitude="sum", realizations=100,
    test_realizations=50, architecture="convolutional", width_fraction=0.1, weights=10,
    compress_inputs=True, mirror=True, noise=0.0, seed=0, R2=0.5, delta_V=0.1, delta_alpha=None,
    minutes=1.0,
)  # fmt: skip


def test_a_curve_that_is_straight_in_the_logarithm_crosses_where_it_must():
    sizes = np.array([10.0, 100.0, 1000.0])
    R2 = 0.25 * np.log10(sizes) + np.array([[0.1], [0.2]])  # 0.77 at 10^2.68 and 10^2.28
    curve = LearningCurve(5, (0, 1), sizes, R2)
    np.testing.assert_allclose(curve.crossings(0.77), [10**2.68, 10**2.28])


def test_a_curve_that_does_not_cross_says_so():
    R2 = np.array([[0.8, 0.9], [0.5, 0.6], [0.7, 0.8]])
    crossings = LearningCurve(5, (0, 1, 2), np.array([10.0, 20.0]), R2).crossings(0.77)
    assert np.isnan(crossings).tolist() == [True, True, False]


def test_the_first_crossing_of_a_curve_that_is_not_monotonous_counts():
    R2 = np.array([[0.7, 0.8, 0.7, 0.9]])
    curve = LearningCurve(5, (0,), np.array([1.0, 10.0, 100.0, 1000.0]), R2)
    assert 1 < curve.crossings(0.75)[0] < 10


def test_a_power_law_is_found_again():
    x = np.array([3.0, 5.0, 8.0, 10.0])
    law = fit_power_law(x, 0.0672 * x**4.9232)
    assert (law.prefactor, law.exponent) == pytest.approx((0.0672, 4.9232))
    assert law.R2 == pytest.approx(1.0)
    np.testing.assert_allclose(law(x), 0.0672 * x**4.9232)


def test_results_become_curves_of_the_sizes_that_all_seeds_have():
    results = [
        replace(RESULT, seed=seed, realizations=size, R2=seed + size / 1000)
        for seed in (0, 1)
        for size in (200, 100, 50)
    ]
    results.append(replace(RESULT, realizations=400))
    results.append(replace(RESULT, components=3))
    three, five = learning_curves(results)
    assert (three.components, five.components) == (3, 5)
    assert five.realizations.tolist() == [50, 100, 200]
    np.testing.assert_allclose(five.R2, [[0.05, 0.1, 0.2], [1.05, 1.1, 1.2]])


def test_resampled_seeds_give_the_spread_of_a_mean():
    """The standard deviation of a mean of three, drawn with replacement."""
    logs = np.array([[1.0, 2.0, 6.0], [3.0, 3.0, 3.0]])
    sizes = np.exp([0.0, 10.0])
    low = 0.77 - logs / 10  # straight from there to one more, R² = 0.77 at exp(logs)
    curves = [
        LearningCurve(n, (0, 1, 2), sizes, np.column_stack([of, of + 1]))
        for n, of in zip((3, 5), low, strict=True)
    ]
    drawn = np.log(resampled_needed(curves, 20_000))
    np.testing.assert_allclose(drawn.mean(axis=0), [3.0, 3.0], atol=0.03)
    np.testing.assert_allclose(drawn.std(axis=0), [np.std(logs[0]) / np.sqrt(3), 0.0], atol=0.03)
