"""Comparisons of priors by their evidence, for short wires."""

import pytest

from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.studies.evidence import EvidencePlan, Group, Task, rows_of
from disorder_landscape.studies.rows import as_text

GROUP = Group(
    name="strength",
    priors={
        "weak": {"components": 1, "sites": 30, "amplitude": 0.1},
        "usual": {"components": 1, "sites": 30},
    },
    mu=(0.0, 0.6, 4),
    B_points=4,
    biases=3,
    noise=0.01,
    count=1,
)
PLAN = EvidencePlan(kind="evidence", title="some", groups=(GROUP,))


@pytest.fixture(scope="module")
def rows():
    return [row for task in PLAN.tasks() for row in rows_of(task, GROUP)]


def test_each_device_is_inverted_with_each_prior(rows):
    assert PLAN.tasks() == [Task("strength", "weak", 0), Task("strength", "usual", 0)]
    pairs = [(row["truth"], row["prior"]) for row in rows]
    assert pairs == [(one, other) for one in GROUP.priors for other in GROUP.priors]


def test_the_truth_is_preferred_and_by_how_much(rows):
    found = PLAN.derived([as_text(row) for row in rows], None).numbers
    by = {(row["truth"], row["prior"]): float(row["log_evidence"]) for row in rows}
    above = by["usual", "usual"] - by["usual", "weak"]
    assert above > 0
    assert found["strength, usual"] == {
        "devices": 1,
        "median": pytest.approx(above, abs=0.06),
        "least": pytest.approx(above, abs=0.06),
        "right": 1,
        "decisively": int(above > 5),
        "decisively_wrong": 0,
    }


def test_a_row_is_a_function_of_its_task(rows):
    again = PLAN.rows(Task("strength", "usual", 0), None)
    for row, same in zip(rows[2:], again, strict=True):
        assert {**row, "seconds": 0} == {**same, "seconds": 0}


def test_the_grid_is_that_of_the_group():
    grid = GROUP.grid
    assert isinstance(grid, Measurement)
    assert grid.G.shape == (4, 4, 3, 4)
