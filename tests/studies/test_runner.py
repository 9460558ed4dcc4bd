"""A tiny study, from plan to table: what is there is kept, what is missing is made."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from disorder_landscape.cli import app
from disorder_landscape.executors.local import LocalProcesses
from disorder_landscape.studies import study as studies
from disorder_landscape.studies import trainings
from disorder_landscape.studies.plan import load_study
from disorder_landscape.studies.runner import carry_out
from disorder_landscape.studies.study import Place
from disorder_landscape.studies.trainings_table import read_table

PLAN = """
kind = "trainings"
title = "tiny"
[base.dataset]
realizations = 12
sites = 20
components = 3
alpha_range = [8.0, 8.0]
mu_points = 8
B_points = 8
bias = [-0.02, 0.0, 0.01, 0.02]
temperature = 0.0
[base.network]
width_fraction = 0.01
[base.training]
epochs = [1]
test_fraction = 0.5
[[runs]]
name = "few"
[runs.grid]
"training.realizations" = [3, 4]
[[runs]]
name = "mirrored"
set = { training = { mirror = true, compress_inputs = true, noise = 0.1 } }
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    return Place(folder, folder / "build")


@pytest.fixture(scope="module")
def carried_out(place):
    """Return the study and its table."""
    (place.output / "tiny.toml").write_text(PLAN)
    study = load_study(place.output / "tiny.toml")
    carry_out(study, place)
    return study, read_table(study.table(place))


def test_the_table_holds_every_run_with_its_settings(carried_out):
    study, results = carried_out
    assert [result.key for result in results] == [run.key for run in study.tasks]
    assert [result.realizations for result in results] == [3, 4, 6]
    assert [result.mirror for result in results] == [False, False, True]
    assert {result.test_realizations for result in results} == {6}
    assert {result.delta_alpha for result in results} == {None}
    assert results[2].noise == 0.1
    assert np.isfinite([result.R2 for result in results]).all()


def test_what_is_there_is_not_made_again(carried_out, place, monkeypatch):
    study, results = carried_out
    made = []
    trained = trainings.trained

    def count(run, place):
        made.append(run.key)
        return trained(run, place)

    monkeypatch.setattr(trainings, "trained", count)
    carry_out(study, place)
    assert not made
    table = study.table(place)
    lines = table.read_text().splitlines(keepends=True)
    other = lines[1].replace(study.tasks[0].key, "of a plan that was")
    table.write_text("".join([*lines[:2], other]))  # as after an interruption
    table.with_suffix(".json").unlink()
    carry_out(study, place, limit=1)
    assert made == [study.tasks[1].key]
    carry_out(study, place)
    assert read_table(table) == results
    assert made == [run.key for run in study.tasks[1:]]


@pytest.mark.slow
def test_two_at_a_time_come_to_the_same(carried_out, place, tmp_path):
    """To rounding: sums over a batch depend on how many threads there are."""
    study, results = carried_out
    apart = replace(place, output=tmp_path, build=tmp_path / "build", executor=LocalProcesses(2))
    carry_out(study, apart)
    for one, other in zip(read_table(study.table(apart)), results, strict=True):
        assert one.R2 == pytest.approx(other.R2, rel=1e-3)
        assert replace(one, R2=0, delta_V=0, minutes=0) == replace(
            other, R2=0, delta_V=0, minutes=0
        )


def test_the_command_writes_the_table(carried_out, place, tmp_path):
    _, results = carried_out
    options = ["-o", tmp_path, "--build", place.build, "--workers", 1]
    command = ["study", place.output / "tiny.toml", *options]
    for said_last in ("3 tasks, 3 added, 0 missing", "3 tasks, nothing was missing"):
        said = CliRunner().invoke(app, [*map(str, command)])
        assert said.exit_code == 0, said.output
        assert said_last in said.output
    assert read_table(tmp_path / "tiny.csv") == results
    made = json.loads((tmp_path / "tiny.json").read_text())["provenance"]
    assert made["command"] == f"landscape study {place.output / 'tiny.toml'}"


def test_all_studies_are_listed(tmp_path):
    said = CliRunner().invoke(app, ["study", "--list", "--build", str(tmp_path)])
    assert said.exit_code == 0, said.output
    assert re.search(r"^recipes +5 of +5  R² of the 5\+1 model", said.output, re.MULTILINE)
    assert re.search(r"^odd_wires +0 of +4000 ", said.output, re.MULTILINE)


def test_a_plan_that_is_not_there_is_one_sentence(tmp_path):
    said = CliRunner().invoke(app, ["study", str(tmp_path / "no.toml")])
    assert said.exit_code != 0


@pytest.mark.parametrize("option", ["--limit=0", "--share=1/2", "--workers=2", "--dry-run"])
def test_a_list_of_studies_takes_no_options_of_a_run(option):
    told = CliRunner().invoke(app, ["study", "--list", option])
    assert "must be left out with --list" in str(told.exception)


def test_a_study_needs_the_plans_of_the_repository(monkeypatch, tmp_path):
    monkeypatch.setattr(studies, "PLANS", tmp_path / "none")
    told = CliRunner().invoke(app, ["study", "noise"])
    assert "study must be carried out in a clone of the repository" in str(told.exception)
