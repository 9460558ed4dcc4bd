"""A tiny study, from plan to table: what is there is kept, what is missing is made."""

from __future__ import annotations

import numpy as np
import pytest
from typer.testing import CliRunner

from disorder_landscape.cli import app
from disorder_landscape.studies import runner
from disorder_landscape.studies.plan import load_study
from disorder_landscape.studies.runner import run_study
from disorder_landscape.studies.trainings_table import read_table

PLAN = """
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
def carried_out(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    (folder / "tiny.toml").write_text(PLAN)
    study = load_study(folder / "tiny.toml")
    return folder, study, run_study(study, folder / "tiny.csv", folder / "build", workers=1)


def test_the_table_holds_every_run_with_its_settings(carried_out):
    folder, study, results = carried_out
    assert [result.key for result in results] == [run.key for run in study.runs]
    assert [result.realizations for result in results] == [3, 4, 6]
    assert [result.mirror for result in results] == [False, False, True]
    assert {result.test_realizations for result in results} == {6}
    assert {result.delta_alpha for result in results} == {None}
    assert results[2].noise == 0.1
    assert np.isfinite([result.R2 for result in results]).all()
    assert read_table(folder / "tiny.csv") == results


def test_what_is_there_is_not_made_again(carried_out, monkeypatch):
    folder, study, results = carried_out
    made = []
    carry_out = runner.carry_out

    def count(run, *arguments):
        made.append(run.key)
        return carry_out(run, *arguments)

    monkeypatch.setattr(runner, "carry_out", count)
    assert run_study(study, folder / "tiny.csv", folder / "build", workers=1) == results
    assert not made
    lines = (folder / "tiny.csv").read_text().splitlines(keepends=True)
    (folder / "tiny.csv").write_text("".join(lines[:2]))  # as after an interruption
    assert run_study(study, folder / "tiny.csv", folder / "build", workers=1) == results
    assert made == [run.key for run in study.runs[1:]]


def test_the_command_writes_the_table(carried_out, tmp_path):
    folder, _, _ = carried_out
    arguments = ["study", folder / "tiny.toml", "-o", tmp_path, "--build", folder / "build"]
    said = CliRunner().invoke(app, [*map(str, arguments), "--workers", "1"])
    assert said.exit_code == 0, said.output
    assert "3 trainings" in said.output
    assert read_table(tmp_path / "tiny.csv") == read_table(folder / "tiny.csv")


def test_a_plan_that_is_not_there_is_one_sentence(tmp_path):
    said = CliRunner().invoke(app, ["study", str(tmp_path / "no.toml")])
    assert said.exit_code != 0
