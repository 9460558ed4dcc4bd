"""What hot data tell of cold wires: what R² and coverage are made of. Nothing is inverted."""

import numpy as np
import pandas as pd
import pytest

from disorder_landscape import Nanowire, conductance, topological_visibility
from disorder_landscape.inference.optimum import optimum_at
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.studies import hot_to_cold
from disorder_landscape.studies.fresh_wires import Inverted, measured_wire
from disorder_landscape.studies.hot_to_cold import (
    TARGETS,
    HotToColdPlan,
    HotWires,
    Task,
    cold_wires,
    compared,
    summary,
)

PLAN = HotToColdPlan(
    kind="hot_to_cold",
    title="some",
    cold=0.02,
    hot=(HotWires(temperatures=(0.1,), noise=(0.01,), count=2),),
    points=2,
    samples=32,
)
TASK = Task(0.1, 0.01, 1)


def test_the_cold_wire_is_the_one_that_was_measured_hot():
    observation, truth = measured_wire(PLAN.config(0.1), 0.01, 1)
    assert observation.measurement.temperature == 0.1
    shown = cold_wires(observation, truth[None], 0.02)
    unknowns, at = observation.unknowns, observation.measurement
    alpha = float(unknowns.parameter("alpha", truth))
    wire = Nanowire(unknowns.potential(truth), alpha=alpha)
    G = conductance(wire, at.mu, at.B, at.bias, 0.02)
    np.testing.assert_allclose(shown["local"][0, ..., 1], G["G_RR"], atol=1e-9)
    np.testing.assert_allclose(shown["nonlocal"][0, ..., 0], G["G_LR"], atol=1e-9)
    T_IV = topological_visibility(wire, at.mu, at.B)
    np.testing.assert_allclose(shown["visibility"][0], T_IV, atol=1e-9)


def test_r2_is_that_of_the_samples_mean_over_all_wires():
    rng = np.random.default_rng(0)
    truths = rng.normal(size=(3, 50))
    answers = truths[:, None] + 0.1 * rng.normal(size=(3, 200, 50))
    rows = [compared("local", answer, true) for answer, true in zip(answers, truths, strict=True)]
    table = pd.DataFrame(rows).assign(site_error=0.002, spread=0.001, verdict="converged")
    table = table.assign(
        **{f"{name}_{of}": 1.0 for name in TARGETS[1:] for of in ("square", "error", "covered")},
        **{f"{name}_mean": 0.0 for name in TARGETS[1:]},
    )
    said = summary(table)
    error = (answers.mean(axis=1) - truths) ** 2
    assert said["r2_local"] == pytest.approx(1 - error.mean() / truths.var(), abs=1e-5)
    assert said["covered_local"] == 1.0
    assert said["r2_visibility"] == 0.0
    assert said["error"] == 2.0
    assert said["verdicts"] == {"converged": 3}


def test_intervals_cover_what_they_say():
    rng = np.random.default_rng(1)
    found = compared("local", rng.normal(size=(400, 2000)), rng.normal(size=2000))
    assert found["local_covered"] == pytest.approx(0.9, abs=0.03)


def test_a_row_is_of_the_answer(monkeypatch):
    """An answer that is the truth itself, all but surely."""
    _, truth = measured_wire(PLAN.config(0.1), 0.01, 1)

    def inverted(observation, network, seed):
        assert network is None
        answer = Gaussian(truth, 1e-12 * np.eye(truth.size))
        return Inverted(Outcome([optimum_at(observation, answer)]), {"verdict": "converged"})

    monkeypatch.setattr(hot_to_cold, "inverted", inverted)
    (row,) = PLAN.rows(TASK, None)
    assert row["temperature"] == 0.1
    assert row["verdict"] == "converged"
    for name in TARGETS:
        assert row[f"{name}_error"] < 1e-8
        assert row[f"{name}_square"] >= row[f"{name}_mean"] ** 2
    assert len(PLAN.tasks()) == 2
