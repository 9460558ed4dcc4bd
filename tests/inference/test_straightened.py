"""Posteriors of which the data fix only the sum of a normal and a uniform unknown."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from disorder_landscape.inference.optimum import SAME_ANSWER, optimum_at, same_answer
from disorder_landscape.inference.posterior import samples
from disorder_landscape.inference.posterior.importance_sampling import Part, importance_sampling
from disorder_landscape.inference.posterior.samples import posterior_samples
from disorder_landscape.inference.problem.distributions import Uniform
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.straightened import Straightened
from linear_data import DATA, SIZE, UNKNOWNS, Linear

UNIFORM = SIZE - 1
"""α, the only uniform unknown."""
MEAN = UNKNOWNS.names.index("mean")
BELIEF = UNKNOWNS.parameters["alpha"]
WHOLE = Straightened({UNIFORM: BELIEF})
WALL = np.sqrt(3.0)


class Ridge(Linear):
    """Data that are linear in α itself, by the sum of the mean of V and α."""

    def simulate(self, X):
        return WHOLE.of_white_noise(X) @ self.slope


def ridge(total):
    """Return the observation of a sum, to a hundredth of a standard deviation, and its optimum."""
    rng = np.random.default_rng(0)
    slope = rng.normal(size=(SIZE, DATA))
    slope[UNIFORM] = slope[MEAN]
    truth = np.zeros(SIZE)
    truth[MEAN], truth[UNIFORM] = total, 0.0
    one = Ridge(truth @ slope, slope)
    x = np.zeros(SIZE)
    x[MEAN] = total / 2
    x[UNIFORM] = WHOLE.white_noise(x + (total / 2) * np.eye(SIZE)[UNIFORM])[UNIFORM]
    stretch = np.ones(SIZE)
    stretch[UNIFORM] = BELIEF.slope(x[UNIFORM]) / BELIEF.std
    of_noise = stretch[:, None] * slope
    covariance = np.linalg.inv(of_noise @ of_noise.T / 0.01**2 + np.eye(SIZE))
    return one, optimum_at(one, Gaussian(x, (covariance + covariance.T) / 2))


@pytest.mark.parametrize("total", [0.0, 1.0, -2.0])
def test_samples_of_a_ridge_are_those_of_the_exact_posterior(total):
    """α then is a normal distribution about the sum, between the walls of its prior."""
    observation, optimum = ridge(total)
    found = posterior_samples(observation, [optimum], [0])
    assert found.is_enough
    alpha = WHOLE.of_white_noise(found.samples)[:, UNIFORM]
    mean = found.weight @ alpha
    std = np.sqrt(found.weight @ (alpha - mean) ** 2)
    grid = np.linspace(-WALL, WALL, 20_001)
    density = norm.pdf(grid - total)
    exact = (grid * density).sum() / density.sum()
    width = np.sqrt(((grid - exact) ** 2 * density).sum() / density.sum())
    assert mean == pytest.approx(exact, abs=0.3 * width)
    assert std == pytest.approx(width, rel=0.15)
    assert abs(alpha[found.weight > 0]).max() < WALL


def test_the_evidence_is_that_of_the_exact_posterior():
    """Against a sum over a grid of α, of data that are linear in all else."""
    observation, optimum = ridge(1.0)
    straightened = Straightened.about(optimum.answer, UNKNOWNS)
    *_, found = importance_sampling(
        observation, [Part(optimum.answer, 1.0)], [1], straightened=straightened
    )
    grid = np.linspace(-WALL, WALL, 4001)
    slope = observation.slope[:UNIFORM]
    precision = slope @ slope.T / 0.01**2 + np.eye(UNIFORM)
    left = observation.data - grid[:, None] * observation.slope[UNIFORM]
    weighted = left @ slope.T / 0.01**2
    chi = (left**2).sum(axis=1) / 0.01**2 - np.einsum(
        "ki,ki->k", weighted, np.linalg.solve(precision, weighted.T).T
    )
    at_grid = -0.5 * (chi + np.linalg.slogdet(precision)[1])
    exact = np.logaddexp.reduce(at_grid) + np.log((grid[1] - grid[0]) / (2 * WALL))
    assert found.log_mean_weight == pytest.approx(exact, abs=0.3)


def test_a_ridge_is_no_normal_distribution_however_well_v_is_known(monkeypatch):
    """Here nothing else would ask for samples."""
    observation, optimum = ridge(0.5)
    monkeypatch.setattr(samples, "STRAIGHT", np.inf)
    assert posterior_samples(observation, [optimum], [0]) is not None


def test_without_it_many_more_samples_are_needed():
    observation, optimum = ridge(1.0)
    straight = posterior_samples(observation, [optimum], [0])
    *_, bent = importance_sampling(observation, [Part(optimum.answer, 1.0)], [0])
    assert len(bent.samples) > 3 * len(straight.samples)


def test_only_ridges_are_straightened():
    _, optimum = ridge(0.5)
    assert Straightened.about(optimum.answer, UNKNOWNS).parameters == {UNIFORM: BELIEF}
    assert isinstance(BELIEF, Uniform)
    known = replace(optimum.answer, covariance=1e-4 * np.eye(SIZE))
    assert Straightened.about(known, UNKNOWNS).parameters == {}
    assert Straightened.about(UNKNOWNS.white_noise, UNKNOWNS).parameters == {}


@pytest.mark.parametrize("along", [-0.9, 0.9])
def test_ends_of_steps_that_creep_along_a_ridge_are_one_optimum(along):
    observation, optimum = ridge(0.5)

    def end(*moved):
        straight = WHOLE.of_white_noise(optimum.answer.mean)
        straight[[MEAN, UNIFORM]] += moved
        mean = WHOLE.white_noise(straight)
        return optimum_at(observation, replace(optimum.answer, mean=mean))

    there = end(along, -along)
    assert same_answer(observation, optimum, there)
    assert not same_answer(observation, optimum, end(along, 0.1 - along))
    apart = optimum.answer.squared_distance(there.answer.mean) / SIZE
    assert apart > SAME_ANSWER**2  # in white noise


def test_straight_variables_and_white_noise_are_the_same():
    X = np.random.default_rng(2).normal(size=(500, SIZE))
    straight = WHOLE.of_white_noise(X)
    np.testing.assert_allclose(WHOLE.white_noise(straight), X, atol=1e-9)
    np.testing.assert_array_equal(straight[:, :UNIFORM], X[:, :UNIFORM])
    assert straight[:, UNIFORM].std() == pytest.approx(1.0, abs=0.1)
    step = 1e-6 * np.eye(SIZE)[UNIFORM]
    slope = (WHOLE.white_noise(straight + step) - WHOLE.white_noise(straight - step))[:, UNIFORM]
    near = abs(X[:, UNIFORM]) < 3
    np.testing.assert_allclose(
        WHOLE.log_stretch(straight)[near], np.log(slope / 2e-6)[near], atol=1e-4
    )
    beyond = WHOLE.log_stretch(np.full((1, SIZE), 2.0))
    assert np.isneginf(beyond).all()
