"""The study of accuracy, of a few wires."""

import json

import numpy as np
import pytest

from disorder_landscape.studies import runner
from disorder_landscape.studies.accuracy import errors_of
from disorder_landscape.studies.accuracy_cases import (
    BIASES,
    KINDS,
    TEMPERATURES,
    measure,
    random_case,
)
from disorder_landscape.studies.accuracy_report import report, summary
from disorder_landscape.studies.plan import load_study
from disorder_landscape.studies.rows import as_text
from disorder_landscape.studies.study import Place

SEED = load_study("accuracy").plan.seed
PLAN = """
kind = "accuracy"
title = "a few"
wires = 6
finer_every = 6
seed = 20
"""


@pytest.fixture(scope="module")
def measured():
    """Return six short wires, the first of them integrated more finely."""
    rows = [measure(random_case(SEED, i, sites=80), finer=i == 0) for i in range(6)]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def test_cases_are_drawn_from_their_index():
    cases = [random_case(SEED, i) for i in range(60)]
    assert {case.kind for case in cases} == set(range(len(KINDS)))
    assert {case.temperature for case in cases} == set(TEMPERATURES)
    assert [i for i, case in enumerate(cases) if case.B == 0] == list(range(0, 60, 10))
    again = random_case(SEED, 7)
    np.testing.assert_array_equal(again.wire.potential, cases[7].wire.potential)
    np.testing.assert_array_equal(again.bias, cases[7].bias)
    pristine = next(case for case in cases if case.kind == 0)
    assert not pristine.wire.potential.any()


def test_a_few_wires_keep_the_bounds(measured):
    numbers = summary(measured)
    assert numbers["passed"]
    assert numbers["wires"] == 6
    assert numbers["conductances"] == 6 * BIASES * 4
    assert numbers["brute_force"]["wires_integrated_finer"] == 1
    assert numbers["brute_force"]["largest_difference_from_finer"] < 3e-5
    kinds = dict(numbers["kinds"])
    whole = kinds.pop("all")
    for name in ("sets", "sets_with_quadrature", "sets_with_error_above_estimate"):
        assert sum(group[name] for group in kinds.values()) == whole[name]
    assert sum(whole["sets_by_energies"].values()) + whole["sets_with_quadrature"] == 6


@pytest.mark.parametrize("index", [647, 1483])
def test_the_worst_cases(index):
    """647: two poles just off the imaginary axis; 1483: a level at 0.03 µeV, its b of no sign."""
    case = measure(random_case(SEED, index), finer=False)
    assert case["error"].max() <= case["estimate"] + case["brute"]


@pytest.mark.parametrize("wrong", [2e-3, np.nan])
def test_an_error_beyond_the_bounds_fails(measured, wrong):
    error = measured["error"].copy()
    error[3, 2, 1] = wrong
    numbers = summary({**measured, "error": error})
    assert not numbers["passed"]
    assert "FAILS" in report(numbers)


def test_a_table_holds_what_is_measured(measured):
    rows = [
        as_text(
            {
                "index": i,
                **{name: values[i] for name, values in measured.items()},
                "error": " ".join(map(repr, measured["error"][i].ravel().tolist())),
            }
        )
        for i in range(6)
    ]
    for name, values in errors_of(rows).items():
        np.testing.assert_array_equal(values, measured[name])


def test_the_study_is_written_and_goes_on_where_it_stopped(tmp_path, monkeypatch):
    """In the folder of these very solvers, and what follows beside the other results."""
    (tmp_path / "few.toml").write_text(PLAN)
    study = load_study(tmp_path / "few.toml")
    place, asked = Place(tmp_path / "out", tmp_path / "build"), []

    rows_of = type(study.plan).rows

    def counted(plan, task, place):
        asked.append(task.index)
        return rows_of(plan, task, place)

    monkeypatch.setattr(type(study.plan), "rows", counted)
    assert not runner.carry_out(study, place, limit=2).lines
    assert not (tmp_path / "out").exists()
    for _ in range(2):
        derived = runner.carry_out(study, place)
        assert derived.passed
    assert asked == list(range(6))
    text = (tmp_path / "out" / "few.txt").read_text("utf-8")
    assert text.startswith("\n".join(derived.lines))
    assert "command: landscape study " in text
    found = json.loads((tmp_path / "out" / "few.json").read_text("utf-8"))
    assert found["wires"] == 6
    assert "command" in found["provenance"]
    assert (tmp_path / "out" / "few.png").stat().st_size > 1000
