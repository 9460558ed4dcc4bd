"""V of every site from conductances alone, over lower and lower μ."""

from dataclasses import replace

import numpy as np
import pytest

from disorder_landscape.inference.checkpoint import Checkpoint
from disorder_landscape.inference.invert import invert
from disorder_landscape.inference.landscape_hint import landscape_hint
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.noise import noise_of_channels
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.search.whole_landscape import (
    AGAIN,
    BACK,
    DRAWS,
    FEW,
    FORETOLD,
    LINES,
    LOST,
    STARTS,
    WAYS_DOWN,
    _in_fields,
    optima_of_whole_landscape,
)
from disorder_landscape.inference.verdict import CONVERGED, is_surely_right, verdict
from landscape_data import (
    BIAS,
    MU,
    NOISE,
    NOTHING,
    UNKNOWNS,
    B,
    Whole,
    linear_landscape,
    measured_landscape,
)
from linear_data import DATA, Ending, posterior


@pytest.fixture
def whole():
    return linear_landscape()


def test_v_of_every_site_is_found_without_a_guess():
    """Of disorder that is not cut to components; data are by quadrature, another route."""
    V, observation = measured_landscape(MU, B)
    found = invert(observation, None)
    assert verdict(observation, found) == CONVERGED
    std = UNKNOWNS.potential_std(found.answer.covariance)
    assert V.std() > 0.2
    assert np.sqrt((std**2).mean()) < 0.02
    assert abs((UNKNOWNS.potential(found.answer.mean) - V) / std).max() < 4


def test_random_points_are_of_the_highest_mu_that_are_measured():
    G = np.zeros_like(NOTHING.G)
    G[[1, 10]] = np.nan
    observation = Observation(replace(NOTHING, G=G, mu=MU[::-1]), UNKNOWNS, np.ones(4))
    seen, rng = set(), np.random.default_rng(0)
    for _ in range(100):
        part = observation.on_random_points(0.5, (2, 9, 2), rng)
        assert part.measurement.G.shape == (2, 2, 2, 4)
        assert np.all(np.diff(part.measurement.B) > 0)
        seen |= set(part.measurement.mu)
    assert seen == set(MU[[11, 9, 8, 7, 6]])
    assert observation.on_random_points(0.01, (1, 1, 1), rng).measurement.mu == MU[11]


def test_some_lines_are_of_what_is_measured():
    G = np.zeros_like(NOTHING.G)
    G[:6] = np.nan
    observation = Observation(replace(NOTHING, G=G), UNKNOWNS, np.ones(4))
    rng = np.random.default_rng(0)
    for share in (0.1, 0.3):
        some = observation.on_some_lines(share, 2, rng)
        assert share / 2 <= some.data.size / observation.data.size <= 4 * share
        assert set(some.measurement.mu) <= set(MU[6:])
        assert some.data.size == some.measurement.G.size


def test_all_data_are_taken_where_no_lines_hold_enough():
    G = np.full((12, 12, 5, 4), np.nan)
    G[np.arange(12), np.arange(12)] = 0
    diagonal = replace(NOTHING, G=G, B=np.linspace(0, 0.8, 12))
    observation = Observation(diagonal, UNKNOWNS, np.ones(4))
    parts = [observation.on_some_lines(0.01, 1, np.random.default_rng(seed)) for seed in range(20)]
    assert {part.data.size for part in parts} == {20, 240}
    assert all(part is observation for part in parts if part.data.size == 240)


def test_few_points_are_spread_over_what_is_measured():
    G = np.zeros_like(NOTHING.G)
    G[[0, 1]] = np.nan
    G[:, :, 2] = np.nan
    few = Observation(replace(NOTHING, G=G), UNKNOWNS, np.ones(4)).on_few_points(4, 9, 3)
    np.testing.assert_array_equal(few.measurement.mu, MU[[2, 5, 8, 11]])
    np.testing.assert_array_equal(few.measurement.B, B)
    np.testing.assert_array_equal(few.measurement.bias, BIAS[[0, 3, 4]])
    assert few.data.size == few.measurement.G.size


@pytest.fixture
def far(whole):
    """An answer that explains nothing."""
    exact = posterior(whole)
    return Gaussian(30 + exact.mean, 1e-4 * np.eye(exact.mean.size))


def test_steps_go_from_few_data_to_all_until_ways_agree(whole):
    """Steps with a draw of data have no name, and need not end at an optimum."""
    exact, asked = posterior(whole), []

    def steps(of, x, attempt, name, known, goal):
        asked.append((name, goal))
        return exact

    optima, ways = optima_of_whole_landscape(whole, Ending(where=steps), 0)
    expected = []
    for start, way in enumerate(["way.0", *(f"way.0.{k}" for k in range(1, STARTS[0]))]):
        expected += [(None, "few"), (f"{way}.{LINES.stop}.some", "better")]
        expected += [(f"0.{start}", "optimum")]
    assert asked == [*expected, ("all.0", "optimum")]
    assert ways == 1
    assert optima.is_settled
    assert optima.found[0].found_by == (0,) * STARTS[0]


def test_lower_mu_follow_when_draws_are_foretold(whole, far, monkeypatch):
    """Draws go on until some in a row are explained before any step."""
    lines, ends = [], [far, far]

    def of(self, highest, counts, rng):
        lines.append((highest, counts[0]))
        return replace(self)

    def steps(of, x, attempt, name, known, goal):
        return ends.pop() if ends else posterior(whole)

    monkeypatch.setattr(Whole, "on_random_points", of)
    optima_of_whole_landscape(whole, Ending(where=steps), 0)
    counts = [LINES[0]] * 3 + [count for count in LINES for _ in range(FORETOLD[0])]
    assert lines[: len(counts)] == [(count / FEW[0], count) for count in counts]


def test_draws_are_of_fields_other_than_zero(whole):
    G = np.zeros_like(NOTHING.G)
    G[:, 2] = np.nan
    nearly_zero = np.concatenate([[1e-17], B[1:]])
    both = Observation(replace(NOTHING, G=G, B=nearly_zero), UNKNOWNS, np.ones(4))
    np.testing.assert_array_equal(_in_fields(both).measurement.B, B[1:])
    G[:, 1] = np.nan
    alone = Observation(replace(NOTHING, G=G), UNKNOWNS, np.ones(4))
    assert _in_fields(alone) is alone


def test_other_ways_down_are_tried_from_draws_of_the_prior(whole, far):
    """Where no draw of data is foretold, a way ends early, with all data."""
    begun, names = [], []

    def steps(of, x, attempt, name, known, goal):
        if not names or names[-1] is not None:
            begun.append(x)
        names.append(name)
        assert goal == ("few" if name is None else "place")
        return far

    optima, ways = optima_of_whole_landscape(whole, Ending(where=steps), 0)
    assert ways == WAYS_DOWN == len(begun)
    assert [name for name in names if name] == [f"{way}.{way}" for way in range(WAYS_DOWN)]
    assert names.count(None) == DRAWS * LOST[0] * WAYS_DOWN
    assert not begun[0].any()
    assert abs(begun[1] - begun[2]).max() > 1
    assert not optima.fits


def test_a_way_that_is_near_does_not_end_early(whole, monkeypatch):
    """Where only draws of many lines are not foretold, it goes on to the lowest of them."""
    drawn = []

    def of(self, highest, counts, rng):
        drawn.append(counts[0])
        return replace(self, data=self.data + (1e3 if counts[0] >= LOST[1] else 0.0))

    monkeypatch.setattr(Whole, "on_random_points", of)
    exact = posterior(whole)
    optima_of_whole_landscape(whole, Ending(where=lambda *_: exact), 0)
    assert list(dict.fromkeys(drawn)) == list(LINES)


def test_steps_go_back_to_draws_where_more_data_are_not_explained(whole, far):
    begun = []

    def steps(of, x, attempt, name, known, goal):
        begun.append(name)
        return far if name is not None else posterior(whole)

    optima_of_whole_landscape(whole, Ending(where=steps), 0)
    more = [f"way.0.{LINES.stop + part}.some" for part in range(BACK)]
    assert [name for name in begun if name and name.startswith("way.0")] == more


def test_an_interrupted_search_goes_on_with_the_next_lines(whole, far):
    """Each number of lines has draws of its own."""
    kept, begun = Checkpoint(), []

    def steps(of, x, attempt, name, known, goal):
        begun.append(x)
        if len(begun) == interrupted:
            raise KeyboardInterrupt
        return Gaussian(far.mean + len(begun), far.covariance)

    interrupted = 2 * DRAWS + 1
    with pytest.raises(KeyboardInterrupt):
        optima_of_whole_landscape(whole, Ending(kept.cached, where=steps), 0)
    assert len(kept) == 2
    last, interrupted = begun[-1], 0
    begun.clear()
    optima_of_whole_landscape(whole, Ending(kept.cached, where=steps), 0)
    np.testing.assert_array_equal(begun[0], last)


def test_ways_leave_the_best_optimum_with_few_lines_and_go_down_again(whole, monkeypatch):
    drawn, begun = [], []

    def of(self, highest, counts, rng):
        drawn.append(counts[0])
        return replace(self)

    monkeypatch.setattr(Whole, "on_random_points", of)
    exact = posterior(whole)

    def steps(of, x, attempt, name, known, goal):
        if name is None:
            begun.append((drawn[-1], x))
        return exact

    optima_of_whole_landscape(whole, Ending(where=steps), 0)
    again = begun[1:]
    assert [lines for lines, _ in again] == [AGAIN[k] for k in range(1, STARTS[0])]
    assert all(x is exact.mean for _, x in again)


def test_starts_that_do_not_agree_end(whole, far):
    exact, others = posterior(whole), {f"0.{k}" for k in range(1, STARTS[1])}

    def steps(of, x, attempt, name, known, goal):
        return far if name in others else exact

    optima, ways = optima_of_whole_landscape(whole, Ending(where=steps), 0)
    assert ways == 1
    assert optima.starts == STARTS[1]
    assert optima.fits
    assert not optima.is_settled


def test_no_answer_of_a_whole_landscape_is_surely_right(whole):
    assert not is_surely_right(replace(whole, variance=np.full(DATA, 1e-12)))


@pytest.mark.parametrize(
    ("highest", "prior", "says"),
    [
        (4.2, Prior(components=None), ""),
        (
            0.6,
            Prior(components=None),
            "It is known to be found from 2.1 meV on (300 sites",
        ),
        (
            0.6,
            Prior(components=None, sites=60),
            "from 2 meV on (60 sites of this disorder).",
        ),
        (0.6, Prior(components=None, amplitude=0.3), ""),
        (3.0, Prior(components=None, lever_arm=2.0), ""),
        (0.6, Prior(components=3), ""),
    ],
)
def test_mu_should_go_up_as_far_as_disorder_scatters(highest, prior, says):
    """… and above V itself."""
    measurement = replace(NOTHING, mu=np.linspace(0, highest, 12))
    unknowns = Unknowns(prior.for_measurement(measurement))
    hint = landscape_hint(Observation(measurement, unknowns, noise_of_channels(NOISE)))
    assert (hint == "") == (says == "")
    assert says in hint
