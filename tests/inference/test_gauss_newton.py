"""Gauss–Newton steps end at optima that are known, with their width."""

from dataclasses import replace

import numpy as np
import pytest

from disorder_landscape import ArgumentError
from disorder_landscape.inference.optimum import optimum_at
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.search.gauss_newton import (
    CREEPING,
    FEW_STEPS,
    LATELY,
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


def test_steps_end_at_an_optimum_that_is_known():
    """… if they come near it from above, and not where they come out below."""
    slope = np.eye(SIZE, 40)
    measured = Linear(np.zeros(40), slope, variance=np.ones(40))
    exact = optimum_at(measured, posterior(measured))
    near = Gaussian(exact.answer.mean + 0.1, exact.answer.covariance)
    known = optimum_at(measured, near)
    assert gauss_newton(measured, np.ones(SIZE), known=[known]).mean == pytest.approx(0.0, abs=1e-6)
    higher = replace(known, objective=-1.0)
    assert gauss_newton(measured, np.ones(SIZE), known=[higher]) is near


def test_steps_that_creep_end_where_only_a_place_is_asked_for():
    """Data are along a parabola so narrow that each step is short."""

    class Gorge(Linear):
        def simulate(self, X):
            Y = np.zeros((len(X), 40))
            Y[:, 0], Y[:, 1] = X[:, 0], 300 * (X[:, 1] - X[:, 0] ** 2)
            return Y

    gorge = Gorge(200 * np.eye(40)[0], np.empty(0), variance=np.full(40, 0.1**2))
    steps = {}
    for goal in ("optimum", "place", "few"):
        count = []
        gauss_newton(gorge, np.zeros(SIZE), lambda *step, c=count: c.append(step[1]), (), goal)
        steps[goal] = count
    rough = steps["place"]
    assert len(rough) == LATELY < len(steps["optimum"])
    assert rough == steps["optimum"][: len(rough)]
    assert rough[-1] ** 2 > CREEPING * rough[0] ** 2
    assert steps["few"] == rough[:FEW_STEPS]


def test_steps_to_where_nothing_can_be_simulated_are_damped():
    class Walled(Linear):
        walls = 0

        def simulate(self, X):
            if abs(X).max() > 3:
                Walled.walls += 1
                raise ArgumentError("potential", "stay within 3", "it does not")
            return np.sinh(X @ self.slope)

    walled = Walled(np.full(40, 5.0), np.eye(SIZE, 40), variance=np.full(40, 1e-4))
    found = gauss_newton(walled, np.zeros(SIZE))
    assert Walled.walls > 0
    np.testing.assert_allclose(found.mean, np.arcsinh(5.0), atol=0.01)


def test_few_steps_ask_for_no_slopes_that_they_do_not_use():
    class Bent(Linear):
        slopes_asked_for = 0

        def closed_form_slopes(self, x, roughly=False):
            Bent.slopes_asked_for += 1
            return super().closed_form_slopes(x, roughly)

        def simulate(self, X):
            return np.arctan(X @ self.slope)

    bent = Bent(np.full(40, 1.2), np.eye(SIZE, 40), variance=np.full(40, 1e-4))
    steps = []
    gauss_newton(bent, np.zeros(SIZE), lambda *step: steps.append(step), (), "few")
    assert Bent.slopes_asked_for == len(steps) == FEW_STEPS


def test_slopes_are_the_derivatives(linear):
    value, slope = linearise(linear, np.ones(SIZE))
    np.testing.assert_allclose(value, linear.slope.sum(axis=0), rtol=1e-12)
    np.testing.assert_allclose(slope, linear.slope, atol=1e-9)
