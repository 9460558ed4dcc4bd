"""A study's plan: what it expands to, and what it refuses."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.runs import REPOSITORY
from disorder_landscape.studies.plan import load_study
from disorder_landscape.studies.rows import stored_settings
from disorder_landscape.studies.runner import carry_out
from disorder_landscape.studies.study import PLANS, Place, study_names
from disorder_landscape.studies.trainings import PlannedRun

PLAN = """
kind = "trainings"
title = "R² over something"
[base.dataset]
realizations = 100
[base.training]
mirror = true
[[runs]]
name = "ours"
[runs.grid]
"training.seed" = [0, 1]
"network.width_fraction" = [0.1, 0.2, 0.3]
[[runs]]
name = "the paper's"
[runs.set.training]
mirror = false
"""


@pytest.fixture
def plan(tmp_path) -> Path:
    path = tmp_path / "something.toml"
    path.write_text(PLAN)
    return path


def test_every_combination_of_a_grid_is_a_run(plan):
    study = load_study(plan)
    assert study.name == "something"
    settings = [
        (run.config.training.seed, run.config.network.width_fraction) for run in study.tasks
    ]
    assert settings[:6] == [(s, w) for s in (0, 1) for w in (0.1, 0.2, 0.3)]
    assert [run.name for run in study.tasks] == ["ours"] * 6 + ["the paper's"]
    assert [run.config.training.mirror for run in study.tasks] == [True] * 6 + [False]
    assert all(run.config.dataset.realizations == 100 for run in study.tasks)


def test_what_goes_together_goes_through_together(plan):
    together = '[runs.together]\n"training.realizations" = [10, 20]\n"training.passes" = [4, 2]\n'
    plan.write_text(PLAN.replace("[runs.grid]\n", together + "[runs.grid]\n"))
    runs = [run.config.training for run in load_study(plan).tasks[:12]]
    assert [(run.realizations, run.passes) for run in runs] == [(10, 4)] * 6 + [(20, 2)] * 6
    assert [run.seed for run in runs] == ([0] * 3 + [1] * 3) * 2


def test_a_plan_may_be_like_another(tmp_path):
    path = tmp_path / "wider.toml"
    path.write_text("""
kind = "trainings"
title = "wider"
like = "learning_curves"
[base.network]
width_fraction = 0.5
[[runs]]
name = "5 components"
set = { dataset = { B_points = 3 }, training = { realizations = 280 } }
[[runs]]
name = "any components"
set = { dataset = { components = 2 } }
""")
    of_like = [run.config for run in load_study("learning_curves").tasks]
    theirs = next(config.dataset for config in of_like if config.dataset.components == 5)
    five, any_number = (run.config for run in load_study(path).tasks)
    assert five.dataset == theirs.model_copy(update={"B_points": 3})
    assert five.training.test_fraction == 0.130435
    assert five.network.width_fraction == any_number.network.width_fraction == 0.5
    assert any_number.dataset.components == 2
    assert any_number.dataset.alpha_range == theirs.alpha_range


@pytest.mark.parametrize(
    ("like", "said"), [("elsewhere", "like is wrong: it must be one of"), ("inversions", "base")]
)
def test_a_plan_is_like_one_of_ours(tmp_path, like, said):
    path = tmp_path / "wider.toml"
    path.write_text(PLAN.replace("[base.dataset]", f'like = "{like}"\n[base.dataset]'))
    with pytest.raises(ArgumentError, match=said):
        load_study(path)


def test_keys_tell_runs_apart_by_settings_and_not_by_name(plan):
    study = load_study(plan)
    keys = {run.key for run in study.tasks}
    assert len(keys) == 7
    assert PlannedRun("another name", study.tasks[0].config).key == study.tasks[0].key


def test_how_figures_are_drawn_does_not_matter_to_a_key(plan):
    run = load_study(plan).tasks[0]
    figures = run.config.figures.model_copy(update={"mu_points": 5})
    other = run.config.model_copy(update={"figures": figures})
    assert PlannedRun(run.name, other).key == run.key


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("mirror = true", "mirrors = true", "unknown key training.mirrors"),
        ("realizations = 100", "realizations = 0", "dataset.realizations is wrong"),
        ('"training.seed" = [0, 1]', '"training.seed" = [0, 0]', "must have different tasks"),
        ("[base.training]", "[basis.training]", "unknown key basis"),
        ("title =", "title", "TOML"),
        ('"trainings"', '"training"', "'training' found using 'kind'"),
        ('kind = "trainings"', "", "discriminator 'kind'"),
        (
            "[runs.grid]\n",
            '[runs.together]\n"training.passes" = [1]\n"training.epochs" = []\n[runs.grid]\n',
            "as long as each other",
        ),
    ],
)
def test_a_plan_that_makes_no_sense_is_refused(plan, old, new, said):
    plan.write_text(PLAN.replace(old, new))
    with pytest.raises(ArgumentError, match=said):
        load_study(plan)


def test_a_plan_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(ArgumentError, match="study must be a readable TOML file"):
        load_study(tmp_path / "nonesuch.toml")


@pytest.mark.parametrize("name", study_names())
def test_the_studies_of_this_repository_can_be_read(name):
    assert load_study(name).command == f"landscape study {name}"


ELSEWHERE = {"accuracy", "accuracy_hot", "accuracy_dissipation", "odd_wires"}
"""Studies that leave the numbers of a table that lies in build."""


@pytest.mark.parametrize("name", sorted(set(study_names()) - ELSEWHERE))
def test_the_tables_of_this_repository_are_those_of_its_plans(name, tmp_path):
    study, place = load_study(name), Place(REPOSITORY / "results", tmp_path)
    assert not study.missing(place)
    assert stored_settings(study.table(place)) == study.plan.settings()


@pytest.mark.parametrize(
    ("name", "old", "new", "said"),
    [
        ("verification", "controls = 19", "controls = 99", "controls = 19, and the plan of 99"),
        ("devices", "B_points = 20", "B_points = 9", "device, B_points = 20, and the plan of 9"),
        ("devices", '"short_wire"', '"wide"', "short wire, prior, components = all, and the plan"),
        ("unmodelled", "every = 2", "every = 3", "every = 2, and the plan of 3"),
    ],
)
@pytest.mark.parametrize("share", ["", ".share-1-of-2"])
def test_rows_of_other_settings_are_no_rows_of_a_plan(name, old, new, said, share, tmp_path):
    for ending in (".csv", ".json"):
        shutil.copy(REPOSITORY / "results" / f"{name}{ending}", tmp_path / f"{name}{share}{ending}")
    plan, content = tmp_path / f"{name}.toml", (PLANS / f"{name}.toml").read_text()
    plan.write_text(content.replace(old, new, 1))
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(ArgumentError, match=said):
        carry_out(load_study(plan), Place(tmp_path, tmp_path / "build"))
    assert {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == before


def test_a_picture_follows_rows_that_a_share_has_left(tmp_path):
    """… even where the plan says nothing in numbers."""
    name, place = "temperatures", Place(tmp_path, tmp_path / "build")
    for ending in (".csv", ".json"):
        shutil.copy(REPOSITORY / "results" / f"{name}{ending}", tmp_path)
    picture = tmp_path / f"{name}.png"
    picture.write_bytes(b"an older one")
    carry_out(load_study(name), place)
    assert picture.read_bytes() == b"an older one"
    for ending in (".csv", ".json"):
        (tmp_path / f"{name}{ending}").rename(tmp_path / f"{name}.share-1-of-1{ending}")
    carry_out(load_study(name), place)
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_the_papers_network_without_noise_is_that_of_the_recipes():
    """… so that it is trained once."""
    keys = {task.key for task in load_study("recipes").tasks}
    shared = [task for task in load_study("noise").tasks if task.run.key in keys]
    assert [(task.training, task.training_noise, task.seed) for task in shared] == [
        ("paper's network and recipe, raw", 0.0, 0),
    ]


def test_a_name_that_is_none_is_refused():
    with pytest.raises(
        ArgumentError, match=r"one of accuracy, accuracy_dissipation, .* it is 'none'"
    ):
        load_study("none")
