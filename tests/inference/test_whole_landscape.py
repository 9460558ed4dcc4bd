"""V of every site from conductances alone, over lower and lower μ."""

from dataclasses import replace

import numpy as np
import pytest

import disorder_landscape as dl
from disorder_landscape.inference.checkpoint import Checkpoint
from disorder_landscape.inference.invert import invert
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.problem.observation import Observation, noise_of_channels
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.search.whole_landscape import (
    DRAWN_ANEW,
    REDRAWN,
    STARTS,
    WAYS_DOWN,
    optima_of_whole_landscape,
    with_new_stretch,
)
from disorder_landscape.inference.verdict import CONVERGED, is_surely_right, verdict
from disorder_landscape.model.disorder import smooth_noise
from disorder_landscape.solver.quadrature import thermal_quadrature
from linear_data import DATA, Linear, posterior

SITES, AMPLITUDE, NOISE = 30, 0.8, 0.002
MU, B, BIAS = np.linspace(0, 4.2, 12), np.linspace(0, 0.8, 3), np.linspace(-0.08, 0.08, 5)
PARTS = 3
NOTHING = Measurement(np.zeros((12, 3, 5, 4)), MU, B, BIAS, 0.0, (15.0, 15.0), 0.05)
UNKNOWNS = Unknowns(
    Prior(components=None, sites=SITES, amplitude=AMPLITUDE).for_measurement(NOTHING)
)


def test_v_of_every_site_is_found_without_a_guess():
    """Of disorder that is not cut to components; data are by quadrature, another route."""
    rng = np.random.default_rng(1)
    V = smooth_noise(rng, SITES, 3, "sum", AMPLITUDE)
    V -= V.mean()
    exact = thermal_quadrature([dl.Nanowire(potential=V)], MU, B, BIAS, 0.05).conductance[0]
    G = exact + NOISE * rng.normal(size=exact.shape)
    observation = Observation(replace(NOTHING, G=G), UNKNOWNS, noise_of_channels(NOISE))
    found = invert(observation, None)
    assert verdict(observation, found) == CONVERGED
    std = UNKNOWNS.potential_std(found.answer.covariance)
    assert V.std() > 0.2
    assert np.sqrt((std**2).mean()) < 0.02
    assert abs((UNKNOWNS.potential(found.answer.mean) - V) / std).max() < 4


def test_parts_hold_the_highest_mu_that_are_measured():
    G = np.zeros_like(NOTHING.G)
    G[[1, 10]] = np.nan
    reversed_axis = replace(NOTHING, G=G, mu=MU[::-1])
    parts = Observation(reversed_axis, UNKNOWNS, np.ones(4)).on_highest_lines(3)
    assert [part.measurement.mu.size for part in parts] == list(range(3, 11))
    np.testing.assert_array_equal(parts[0].measurement.mu, MU[[11, 9, 8]])


def test_few_points_are_spread_over_what_is_measured():
    G = np.zeros_like(NOTHING.G)
    G[[0, 1]] = np.nan
    G[:, :, 2] = np.nan
    few = Observation(replace(NOTHING, G=G), UNKNOWNS, np.ones(4)).on_few_points(4, 9, 3)
    np.testing.assert_array_equal(few.measurement.mu, MU[[2, 5, 8, 11]])
    np.testing.assert_array_equal(few.measurement.B, B)
    np.testing.assert_array_equal(few.measurement.bias, BIAS[[0, 3, 4]])
    assert few.data.size == few.measurement.G.size


def test_a_new_stretch_of_v_is_as_probable_as_the_old_one():
    """The mean square of the unknowns stays one each; elsewhere V stays."""
    rng = np.random.default_rng(0)
    many = UNKNOWNS.prior.draw(rng, 2000)
    answers = (Gaussian(x, UNKNOWNS.prior.covariance) for x in many)
    changed = np.array([with_new_stretch(UNKNOWNS, answer, rng) for answer in answers])
    before, after = UNKNOWNS.potential(many), UNKNOWNS.potential(changed)
    assert after.std() == pytest.approx(before.std(), rel=0.03)
    off = (after - before).std(axis=0) / before.std(axis=0)
    assert np.all(off < np.sqrt(2) * max(DRAWN_ANEW))
    assert np.all(off > np.sqrt(2) * min(DRAWN_ANEW) / 2)


def test_a_new_stretch_leaves_the_rest():
    long = Unknowns(Prior(components=None, sites=300).for_measurement(NOTHING))
    rng = np.random.default_rng(3)
    x = long.prior.draw(rng, 2)[0]
    answer = Gaussian(x, long.prior.covariance)
    off = long.potential(with_new_stretch(long, answer, rng)) - long.potential(x)
    assert abs(off).max() > 0.05
    assert np.sum(abs(off) < 0.01) > 60


@pytest.fixture
def whole():
    slope = np.random.default_rng(0).normal(size=(len(UNKNOWNS.names), DATA))
    return Whole(np.zeros(DATA), slope, unknowns=UNKNOWNS, measurement=NOTHING)


class Whole(Linear):
    """Linear data of a whole landscape, all of them in each part."""

    def on_few_points(self, *counts):
        return replace(self)

    def on_highest_lines(self, first):
        return [replace(self) for _ in range(PARTS)]


def test_steps_use_more_and_more_data_until_starts_agree(whole):
    exact, asked = posterior(whole), []

    def steps(of, x, attempt, name, known, goal):
        asked.append((attempt, goal))
        return exact

    optima, ways = optima_of_whole_landscape(whole, steps, 0)
    down, end = [(0, "better")] * (PARTS + 2), (0, "optimum")
    assert asked == [*down, end, (0, "better"), end, (0, "better")]
    assert ways == 1
    assert optima.is_settled
    assert optima.found[0].found_by == (0, 0, 0)


def test_a_stretch_is_drawn_anew_until_the_noise_explains_a_part(whole):
    exact, asked = posterior(whole), []
    far = Gaussian(30 + exact.mean, 1e-4 * np.eye(exact.mean.size))

    def steps(of, x, attempt, name, known, goal):
        asked.append((goal, len(known)))
        return far if len(asked) <= 4 else exact

    optima, ways = optima_of_whole_landscape(whole, steps, 0)
    assert asked[:7] == [("better", 0), *[("better", 1)] * 4, ("better", 0), ("better", 0)]
    assert ways == 1
    assert optima.is_settled


def test_other_ways_down_are_tried_from_draws_of_the_prior(whole):
    """Where no new stretch helps, a way ends with all data."""
    begun, ends, redrawn = [], [], []
    far = Gaussian(30 + posterior(whole).mean, 1e-4 * np.eye(len(UNKNOWNS.names)))

    def steps(of, x, attempt, name, known, goal):
        if goal != "better":
            ends.append(attempt)
        elif known:
            redrawn.append(attempt)
        else:
            begun.append(x)
        return far

    optima, ways = optima_of_whole_landscape(whole, steps, 0)
    assert ways == WAYS_DOWN == len(begun)
    assert ends == list(range(WAYS_DOWN))
    assert len(redrawn) == REDRAWN * WAYS_DOWN
    assert not begun[0].any()
    assert abs(begun[1] - begun[2]).max() > 1
    assert not optima.fits


def test_an_interrupted_search_goes_on_with_the_next_part(whole):
    """Each part has stretches of its own."""
    exact = posterior(whole)
    kept, begun = Checkpoint(), []

    def steps(of, x, attempt, name, known, goal):
        begun.append(x)
        if len(begun) == interrupted:
            raise KeyboardInterrupt
        far = Gaussian(x + 30, exact.covariance)
        return exact if goal != "better" or len(known) > 0 else far

    interrupted = 2 * PARTS + 2
    with pytest.raises(KeyboardInterrupt):
        optima_of_whole_landscape(whole, steps, 0, kept.cached)
    first, interrupted = begun[:], 0
    begun.clear()
    optima_of_whole_landscape(whole, steps, 0, kept.cached)
    np.testing.assert_array_equal(begun[0], first[-2])
    np.testing.assert_array_equal(begun[1], first[-1])
    assert len(kept) == PARTS + 2


def test_starts_that_do_not_agree_end(whole):
    exact = posterior(whole)
    far = Gaussian(30 + exact.mean, 1e-4 * np.eye(exact.mean.size))

    def steps(of, x, attempt, name, known, goal):
        return exact if name in (None, "0.0", "best") else far

    optima, ways = optima_of_whole_landscape(whole, steps, 0)
    assert ways == 1
    assert optima.starts == STARTS
    assert optima.fits
    assert not optima.is_settled


def test_no_answer_of_a_whole_landscape_is_surely_right(whole):
    assert not is_surely_right(replace(whole, variance=np.full(DATA, 1e-12)))
