"""How far the answers of two searches are from each other. Nothing is inverted."""

from dataclasses import replace

import numpy as np
import pytest

from disorder_landscape.inference.optimum import optimum_at
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.studies import starts
from disorder_landscape.studies.fresh_wires import Inverted, Task, Wires
from disorder_landscape.studies.rows import as_text
from disorder_landscape.studies.starts import StartsPlan, weights_apart
from linear_data import SIZE, Linear, posterior

PLAN = StartsPlan(
    kind="starts",
    title="some",
    wires=(Wires(models=("five_components_and_alpha",), noise=(0.01,), count=1),),
)


@pytest.fixture(scope="module")
def observation():
    slope = np.random.default_rng(0).normal(size=(SIZE, 40))
    return Linear(slope.sum(axis=0), slope)


def outcome(observation, *places):
    """Return optima so many standard deviations from the posterior's mean, all as probable."""
    exact = posterior(observation)
    bars = np.sqrt(np.diag(exact.covariance))
    answers = (Gaussian(exact.mean + place * bars, exact.covariance) for place in places)
    found = [optimum_at(observation, answer) for answer in answers]
    return Outcome(tuple(replace(one, objective=0.0) for one in found))


def test_the_same_optima_have_the_same_weights_in_any_order(observation):
    one = outcome(observation, 0.0, 20.0, 40.0)
    assert weights_apart(observation, one, one) == pytest.approx(0)
    assert weights_apart(observation, one, outcome(observation, 40.5, 0.0, 20.0)) < 1e-12


def test_what_only_one_search_has_found_is_apart(observation):
    both, first = outcome(observation, 0.0, 20.0), outcome(observation, 0.0)
    assert weights_apart(observation, both, first) == pytest.approx(0.5)
    assert weights_apart(observation, first, both) == pytest.approx(0.5)
    assert weights_apart(observation, first, outcome(observation, 20.0)) == pytest.approx(1)


def test_a_row_compares_two_searches_of_one_measurement(observation, monkeypatch):
    """Here of linear data, of which the second search answers one error bar beside the first."""
    truth, answers = posterior(observation).mean, iter([0.0, 1.0])

    def inverted(given, network, seed):
        assert (network is None) == (seed >= starts.OTHER_SEEDS)
        spread = observation.unknowns.site_std(posterior(observation).covariance)
        return Inverted(
            outcome(given, next(answers)),
            {"spread": spread, "verdict": "converged", "seconds": 1.0},
        )

    monkeypatch.setattr(starts, "fresh_wire", lambda task: (observation, truth))
    monkeypatch.setattr(starts, "inverted", inverted)
    rows = PLAN.rows(Task("five_components_and_alpha", 0.01, 0), None)
    assert rows[0]["network_error"] == 0
    assert rows[0]["weights_apart"] == 0
    assert float(rows[0]["prior_error"]) == float(rows[0]["apart"]) > 0
    (said,) = PLAN.derived([as_text(row) for row in rows], None).numbers.values()
    spread = observation.unknowns.site_std(posterior(observation).covariance)
    apart = abs(float(rows[0]["network_log_evidence"]) - float(rows[0]["prior_log_evidence"]))
    assert said == {
        "wires": 1,
        "both_converged": 1,
        "apart_in_bars": pytest.approx(float(rows[0]["apart"]) / spread, abs=1e-3),
        "apart_in_bars_at_most": said["apart_in_bars"],
        "log_evidence_apart": pytest.approx(apart, abs=1e-3),
        "log_evidence_apart_at_most": said["log_evidence_apart"],
        "weights_apart": 0,
        "weights_apart_at_most": 0,
    }
