"""V of every site where µ is low: small steps, parts of wires, and their exchange."""

from dataclasses import replace

import numpy as np
import pytest

from disorder_landscape.inference.checkpoint import Checkpoint
from disorder_landscape.inference.landscape_hint import landscape_hint
from disorder_landscape.inference.optimum import best, optimum_at
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.search import generations, parts
from disorder_landscape.inference.search.generations import Generations
from disorder_landscape.inference.search.parts import Cut, with_another_part
from disorder_landscape.inference.search.population import Population
from disorder_landscape.inference.search.small_steps import BEFORE, WEIGHT, SmallSteps
from disorder_landscape.inference.search.steps import Steps
from disorder_landscape.inference.search.whole_landscape import (
    POPULATIONS,
    optima_of_whole_landscape,
)
from disorder_landscape.inference.search.wires import Wire, that_stay
from disorder_landscape.inference.stages import SMALL_STEPS
from disorder_landscape.inference.verdict import NOT_CONVERGED, NOT_DESCRIBED, verdict
from disorder_landscape.model.parameters import hopping
from landscape_data import (
    AMPLITUDE,
    NOTHING,
    SITES,
    UNKNOWNS,
    linear_landscape,
    measured_landscape,
)
from linear_data import DATA, Ending, posterior

CUT = Cut(
    redrawn=(0.2, 0.3),
    taken=(0.3, 0.5),
    seam=(0.05, 0.06),
    held=0.5,
)
PRIOR = UNKNOWNS.white_noise
STD = UNKNOWNS.site_std(PRIOR.covariance)


@pytest.fixture
def whole():
    return linear_landscape()


@pytest.fixture
def few_steps(monkeypatch):
    monkeypatch.setattr(generations, "DRAWS", (3, 20))
    kinds = [(parts.exchanged, 2), (parts.moved, 1), (parts.redrawn, 1)]
    monkeypatch.setattr(generations, "CHILDREN", kinds)
    monkeypatch.setattr(generations, "NEAR_CHILDREN", kinds)
    monkeypatch.setattr(generations, "GO_ON", 1)
    monkeypatch.setattr(generations, "SMALL", (10, 10, 10))
    monkeypatch.setattr(generations, "LEAVE", 20)


@pytest.fixture
def short_waves(monkeypatch):
    """A wavelength of six sites."""
    kinetic = hopping(0.03, 10.0) * (np.pi / 3) ** 2 / STD
    monkeypatch.setattr(parts, "KINETIC", (kinetic, kinetic))


def wires_at(X, **known):
    """Wires at these unknowns, which explain the data worse and worse."""
    ends = known.get("ends", [(2.0, 2.0)] * len(X))
    return [Wire(x, np.zeros(1), float(k), ends[k]) for k, x in enumerate(X)]


def small_steps_at(whole, x):
    return SmallSteps(whole, PRIOR, x)


def test_small_steps_go_to_the_posterior_of_linear_data(whole):
    exact, small = posterior(whole), small_steps_at(whole, np.zeros(len(UNKNOWNS.names)))
    small.take(300, np.random.default_rng(0))
    off = (small.x - exact.mean) / np.sqrt(np.diag(exact.covariance))
    assert abs(off).max() < 0.1


def test_far_from_the_data_the_noise_counts_as_large_as_the_misfit(whole):
    """… so that errors a thousand times smaller than the misfit do not change the first step."""
    ends = []
    for noise in (1e-3, 1e-5):
        exact = replace(whole, variance=np.full(DATA, noise**2))
        small = small_steps_at(exact, np.zeros(len(UNKNOWNS.names)))
        small.take(1, np.random.default_rng(0))
        ends.append(small.x)
    assert abs(ends[0]).max() > 1e-3
    np.testing.assert_allclose(*ends, rtol=1e-6)


def test_the_prior_weighs_more_where_v_is_larger_than_it_is_expected(whole):
    small = small_steps_at(whole, 10 * np.ones(len(UNKNOWNS.names)))
    weights = []
    for _ in range(400):
        small.take(1, np.random.default_rng(0))
        weights.append(small.weight)
    factor, largest = WEIGHT
    assert weights[0] == factor
    assert 1.0 < max(weights) <= largest
    assert weights[-1] == 1.0
    assert small.draws == BEFORE + 400


def test_no_step_is_longer_than_a_draw_of_the_prior(whole, monkeypatch):
    """… whatever a slope that is wrong says."""
    small = small_steps_at(whole, np.zeros(len(UNKNOWNS.names)))
    small.draws, small.information = BEFORE, np.zeros((len(UNKNOWNS.names),) * 2)
    far = np.full(len(UNKNOWNS.names), 1e9)
    monkeypatch.setattr(SmallSteps, "_information_and_slope", lambda self, rng: far)
    small.take(1, np.random.default_rng(0))
    assert np.linalg.norm(small.x) == pytest.approx(np.sqrt(len(UNKNOWNS.names)))


def test_what_a_draw_of_data_says_counts_for_all_of_them(whole):
    """The first step is the same where each draw is a part of the data, twice."""

    class Twice(type(whole)):
        def on_random_points(self, highest, counts, rng):
            return whole

    double = Twice(
        np.tile(whole.data, 2), np.tile(whole.slope, 2), 0.0, UNKNOWNS, np.tile(whole.variance, 2)
    )
    x = posterior(whole).mean + 1e-4  # where the misfit is less than the noise
    small = small_steps_at(double, x)
    small.take(1, np.random.default_rng(0))
    np.testing.assert_allclose(
        small.information, 2 * (whole.slope / whole.variance) @ whole.slope.T
    )


@pytest.mark.parametrize("seed", range(20))
def test_v_stays_where_a_part_is_drawn_anew(seed):
    rng = np.random.default_rng(seed)
    x = rng.normal(size=len(UNKNOWNS.names))
    given = parts.redrawn(UNKNOWNS, wires_at([x]), CUT, rng)
    assert 0 < np.count_nonzero(given.free) <= 0.3 * SITES + 1
    assert np.all(np.diff(np.flatnonzero(given.free)) == 1)
    np.testing.assert_allclose(given.V, UNKNOWNS.potential(x))


def test_parts_are_drawn_anew_at_the_end_whose_data_are_explained_worse():
    rng, counts = np.random.default_rng(0), np.zeros(SITES)
    wires = wires_at([np.zeros(len(UNKNOWNS.names))], ends=[(9.0, 1.0)])
    for _ in range(300):
        counts += parts.redrawn(UNKNOWNS, wires, CUT, rng).free
    assert counts[: SITES // 2].sum() > 5 * counts[SITES // 2 :].sum()
    assert counts[: SITES // 2].min() > 0


def test_another_wires_part_or_its_end_is_taken():
    rng = np.random.default_rng(0)
    X = rng.normal(size=(2, len(UNKNOWNS.names)))
    V, ends = UNKNOWNS.potential(X), 0
    for _ in range(100):
        given = parts.exchanged(UNKNOWNS, wires_at(X, ends=[(1.0, 9.0), (9.0, 1.0)]), CUT, rng)
        first, second = (np.isclose(given.V, one) for one in V)
        assert np.all(first | second)
        assert np.count_nonzero(np.diff(second.astype(int))) <= 2
        assert np.count_nonzero(given.free) <= 4 * (0.06 * SITES + 1)
        ends += bool(first[0] and second[-1])
    assert ends > 30


def test_a_part_moves_half_a_wavelength_into_a_deep_well(short_waves):
    """… from either side of it. Both ends of the part are free."""
    rng, sides = np.random.default_rng(0), set()
    well = np.zeros(SITES)
    well[14:17] = -3.0
    x = np.linalg.lstsq(UNKNOWNS.to_potential, well + 0.1 * rng.normal(size=SITES), rcond=None)[0]
    V = UNKNOWNS.potential(x)
    for _ in range(50):
        given = parts.moved(UNKNOWNS, wires_at([x]), CUT, rng)
        moved = np.flatnonzero(~np.isclose(given.V, V))
        assert given.free[14:17].all()
        assert moved.size <= 0.5 * SITES + 1
        for side in (-1, 1):  # what was three sites farther from the well is there now
            there = np.clip(moved + 3 * side, 0, SITES - 1)
            sides |= {side} if np.allclose(given.V[moved], V[there]) else set()
        assert not given.free.all()
    assert sides == {-1, 1}


@pytest.mark.parametrize("seed", range(10))
def test_what_is_not_free_is_kept_at_first_and_held_then(seed):
    rng = np.random.default_rng(seed)
    wires = wires_at(rng.normal(size=(3, len(UNKNOWNS.names))))
    given = parts.redrawn(UNKNOWNS, wires, CUT, rng)
    kept, held = (parts._prior_given(UNKNOWNS, given, error) for error in (parts.KEPT, CUT.held))
    off = UNKNOWNS.potential(kept.draw(rng, 2)[0]) - given.V
    assert abs(off[~given.free]).max() < 5 * parts.KEPT * STD
    assert abs(off[given.free]).max() > 2 * parts.KEPT * STD
    for prior, error in ((kept, parts.KEPT), (held, CUT.held)):
        assert UNKNOWNS.potential_std(prior.covariance)[~given.free].max() <= error * STD


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("kind", [parts.exchanged, parts.moved, parts.redrawn])
def test_starts_are_at_draws_with_what_is_not_free_as_it_was(seed, kind, short_waves):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(3, len(UNKNOWNS.names)))
    start = with_another_part(kind, UNKNOWNS, wires_at(X), CUT, rng)
    V = UNKNOWNS.potential(X)
    there = np.concatenate([V, np.roll(V, 3, axis=1), np.roll(V, -3, axis=1)])
    off = abs(UNKNOWNS.potential(start.x) - there).min(axis=0)
    assert np.count_nonzero(off < 5 * parts.KEPT * STD) > SITES / 3
    assert UNKNOWNS.potential_std(start.prior.covariance).min() < CUT.held * STD


def test_parameters_of_the_device_are_those_of_the_wire():
    prior = Prior(components=None, sites=SITES, amplitude=AMPLITUDE, gamma=(0.1, 0.2))
    unknowns = Unknowns(prior.for_measurement(NOTHING))
    rng = np.random.default_rng(0)
    x = rng.normal(size=len(unknowns.names))
    for _ in range(20):
        start = with_another_part(parts.redrawn, unknowns, wires_at([x]), CUT, rng)
        assert abs(start.x[-1] - x[-1]) < 5 * parts.KEPT
        assert abs(start.prior.mean[-1] - x[-1]) < abs(x[-1])


def test_alike_wires_do_not_stay():
    rng = np.random.default_rng(0)
    X = rng.normal(size=(2, len(UNKNOWNS.names)))
    alike = X[0] + 1e-3 * rng.normal(size=len(UNKNOWNS.names))
    wires = wires_at([X[0], alike, X[1]])
    stay = that_stay(UNKNOWNS, wires, 0.25)
    assert [one.objective for one in stay] == [0.0, 2.0]


def test_wires_of_the_best_ends_stay():
    X = np.random.default_rng(0).normal(size=(20, len(UNKNOWNS.names)))
    ends = [(20.0 - k, 1.0 + k) for k in range(20)]
    stay = that_stay(UNKNOWNS, wires_at(X, ends=ends), 0.25)
    assert [one.objective for one in stay] == [0, 1, 2, 3, 19, 18, 4, 5]


def test_a_population_finds_the_optimum_of_linear_data(whole, few_steps):
    told = []
    found, goal = Population(whole, Steps(progress=told.append), 0, (0,)).towards_optimum()
    exact = posterior(whole)
    assert goal == "optimum"
    assert exact.squared_distance(found) < 0.1
    assert [step.number for step in told if step.stage == SMALL_STEPS][:3] == [0, 1, 2]


def test_small_steps_leave_an_optimum(whole, few_steps):
    optimum = optimum_at(whole, posterior(whole))
    x, goal = Population(whole, Steps(), 0, (0, 1)).from_optimum(optimum)
    assert goal == "optimum"
    assert 0 < optimum.answer.squared_distance(x) < 10


def test_an_interrupted_population_goes_on_alike(whole, few_steps):
    """Of data that no wire explains."""
    far = replace(whole, bend=3.0)
    expected, goal = Population(far, Steps(), 0, (0,)).towards_optimum()
    assert goal == "place"
    kept, steps = Checkpoint(), 0

    def interrupt(step):
        nonlocal steps
        steps += 1
        if steps == 10:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Population(far, Steps(kept.cached, interrupt), 0, (0,)).towards_optimum()
    assert 0 < len(kept) < 4
    found, _ = Population(far, Steps(kept.cached), 0, (0,)).towards_optimum()
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("joins", [False, True])
def test_where_no_wire_explains_the_data_another_population_begins(whole, monkeypatch, joins):
    """… which leads to the place of an optimum, as the first one does.

    That says that the model does not describe the data, unless wires of the first one have joined.
    """
    begun = []

    def fail(self):
        self.joined = joins and bool(begun)
        begun.append(self.name)
        return np.full(len(UNKNOWNS.names), 30.0 * len(begun)), "place"

    monkeypatch.setattr(Population, "towards_optimum", fail)
    monkeypatch.setattr(type(whole), "measurement", replace(NOTHING, mu=NOTHING.mu / 10))
    far = Gaussian(np.full(len(UNKNOWNS.names), 30.0), 1e-4 * PRIOR.covariance)
    optima, populations = optima_of_whole_landscape(whole, Ending(where=lambda *_: far), 0)
    assert begun == [(number,) for number in range(POPULATIONS)]
    assert populations == POPULATIONS
    assert not optima.fits
    outcome = Outcome(tuple(optima.found), attempts=populations)
    assert verdict(whole, outcome) == (NOT_CONVERGED if joins else NOT_DESCRIBED)


def test_v_of_every_site_is_found_at_low_mu(few_steps, monkeypatch):
    """… lower than where ways from high µ are known to find it; data are by quadrature."""
    monkeypatch.setattr(generations, "DRAWS", (3, 100))
    V, observation = measured_landscape(np.linspace(0, 0.8, 12), np.linspace(0, 0.8, 4))
    assert landscape_hint(observation)
    optima, _ = optima_of_whole_landscape(observation, Steps(), 0)
    assert optima.fits
    assert optima.is_settled
    answer = best(optima.found).answer
    std = UNKNOWNS.potential_std(answer.covariance)
    assert np.sqrt((std**2).mean()) < 0.1 < V.std()
    assert abs((UNKNOWNS.potential(answer.mean) - V) / std).max() < 4


def test_wires_of_former_populations_join_where_no_better_ones_are_found(
    whole, few_steps, monkeypatch
):
    far = Wire.at(whole, np.full(len(UNKNOWNS.names), 30.0))
    former = [Wire.at(whole, posterior(whole).mean)]
    monkeypatch.setattr(Generations, "drawn", lambda self, rng: [far])
    monkeypatch.setattr(Generations, "by_small_steps", lambda self, wires, rng: wires)
    alone = Population(whole, Steps(), 0, (0,))
    x, goal = alone.towards_optimum()
    np.testing.assert_array_equal(x, far.x)
    assert goal == "place"
    assert not alone.joined
    together = Population(whole, Steps(), 0, (1,), former)
    _, goal = together.towards_optimum()
    assert goal == "optimum"
    assert together.joined
