"""Studies of inversions: their rows, their tables, and what the Jacobian says of uniqueness."""

import hashlib
import json
from dataclasses import replace
from threading import Thread

import numpy as np
import pandas as pd
import pytest
from scipy.stats import chi2

from disorder_landscape import ArgumentError
from disorder_landscape.claims.claim import ResultMissingError
from disorder_landscape.claims.derived import (
    fixed_combinations,
    thirty_components,
    true_answers,
    visibility_of_inversions,
)
from disorder_landscape.claims.study_tables import (
    SHOWN,
    accuracy_table,
    components_table,
    uniqueness_table,
    unmodelled_table,
)
from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.executors.executor import Share
from disorder_landscape.files import write_json
from disorder_landscape.inference.optimum import optimum_at
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.measurement import empty_measurement, simulated
from disorder_landscape.inference.search.network_features import network_features
from disorder_landscape.inference.search.regression_rounds import RoundSettings
from disorder_landscape.inference.verdict import CONVERGED, NOT_CONVERGED
from disorder_landscape.model.parameters import Nanowire
from disorder_landscape.runs import FIVE, TEN, THIRTY, shipped_model
from disorder_landscape.studies import inversions, runner, unmodelled
from disorder_landscape.studies.calibration import coverage, joint_coverage
from disorder_landscape.studies.fresh_wires import (
    SEED,
    Inverted,
    Task,
    measured_wire,
    model_of,
    network_of,
    wrong,
)
from disorder_landscape.studies.other_wires import (
    KINDS,
    NOTHING,
    changed,
    true_conductances,
    true_noise,
)
from disorder_landscape.studies.plan import load_study
from disorder_landscape.studies.rows import as_text, read_rows, stored_numbers, write_rows
from disorder_landscape.studies.study import Place
from disorder_landscape.studies.truth import of_device
from disorder_landscape.studies.uniqueness import Setting, information_rows
from disorder_landscape.studies.unmodelled import MODEL_ALONE, unmodelled_row

PLAN = """
kind = "inversions"
title = "some"
[[wires]]
models = ["five_components_and_alpha", "ten_components"]
noise = [0, 0.01]
count = 3
"""
NOISE = load_study("uniqueness").plan.noise
HELD_BY_WIDE = ("gap", "temperature", "barrier", "bias")


def row(index, model=FIVE, noise=0.01, **changes):
    z = np.random.default_rng(index).normal(size=7)
    return {
        "model": model,
        "noise": noise,
        "index": index,
        "network_error": 0.04,
        "site_error": 0.001,
        "spread": 0.001,
        "network_scaled_error": 0.05,
        "scaled_error": 1e-4,
        "network_alpha_error": 0.02,
        "alpha_error": 0.001,
        "more_probable": chi2.cdf((z**2).sum(), 7),
        "effective_sample_size": np.nan,
        "verdict": CONVERGED,
        "seconds": 10.0,
        "z_scores": " ".join(f"{one:.3f}" for one in z),
    } | changes


def write_table(path, rows):
    pd.DataFrame(rows).to_csv(path, index=False)
    return path


@pytest.fixture
def study(tmp_path):
    (tmp_path / "some.toml").write_text(PLAN)
    return load_study(tmp_path / "some.toml")


@pytest.fixture
def place(tmp_path):
    return Place(tmp_path, tmp_path / "build")


def test_what_is_there_is_not_done_again(study, place):
    tasks = [
        Task(model, noise, i) for model in (FIVE, TEN) for noise in (0.0, 0.01) for i in range(3)
    ]
    assert study.tasks == study.missing(place) == tasks
    write_table(study.table(place), [row(2), row(0, model=TEN), row(0, noise=0.0)])
    left = study.missing(place)
    assert len(left) == len(tasks) - 3
    assert Task(FIVE, 0.01, 2) not in left


def test_a_table_keeps_what_others_add_to_it(study, place, monkeypatch):
    """Two runs that share a table, or one that was interrupted; and the order is the plan's."""
    path, done = study.table(place), []

    def row_of(task):
        done.append(task)
        if len(done) == 2:
            others = [as_text(row(7)), as_text(row(1, site_error=0.5))]
            write_rows(path, [*read_rows(path), *others], "")
        return row(task.index, model=task.model, noise=task.noise)

    monkeypatch.setattr(inversions, "inversion_row", row_of)
    runner.carry_out(study, place, limit=1)
    runner.carry_out(study, place)
    assert len(done) == len(set(done)) == 12
    assert done[:4] == [Task(model, noise, 0) for model in (FIVE, TEN) for noise in (0.0, 0.01)]
    rows = read_rows(path)
    assert [study.key_of_row(one) for one in rows[:-1]] == [study.key(one) for one in study.tasks]
    assert [one["site_error"] for one in rows].count("0.5") == 1
    assert rows[-1]["index"] == "7"
    made = json.loads(path.with_suffix(".json").read_text())["provenance"]
    assert made["sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()


def test_shares_of_a_study_are_gathered(study, place, monkeypatch):
    """Each in a table of its own, which the whole study takes and does not repeat."""
    done = []

    def row_of(task):
        done.append(task)
        return row(task.index, model=task.model, noise=task.noise)

    monkeypatch.setattr(inversions, "inversion_row", row_of)
    for number in (3, 1):
        runner.carry_out(study, replace(place, share=Share(number, 5)))
    assert not study.table(place).exists()
    assert len(study.tables_of_shares(place)) == 2
    assert len(study.missing(place)) == 12 - 5
    runner.carry_out(study, place)
    assert len(done) == len(set(done)) == 12
    assert len(read_rows(study.table(place))) == 12
    assert not [path for path in place.output.iterdir() if "share" in path.name]


def test_a_row_that_a_share_adds_while_it_is_gathered_is_not_lost(study, place, monkeypatch):
    share = replace(place, share=Share(1, 5))
    tasks, write = share.share.of(study.tasks)[:2], runner.write_rows
    first, second = ([as_text(row(one.index, one.model, one.noise))] for one in tasks)
    adding = Thread(target=runner._add, args=(study, share, second))

    def write_while_the_share_adds(path, *arguments):
        if path == study.table(place):
            adding.start()
            adding.join(0.5)
        write(path, *arguments)

    runner._add(study, share, first)
    monkeypatch.setattr(runner, "write_rows", write_while_the_share_adds)
    runner._gather_shares(study, place)
    adding.join()
    tables = [study.table(place), study.table_of_share(share)]
    there = [study.key_of_row(one) for table in tables for one in read_rows(table)]
    assert there == [study.key(one) for one in tasks]


def test_what_followed_from_other_rows_is_no_longer_there(tmp_path):
    path = tmp_path / "some.csv"
    write_rows(path, [as_text(row(0))], "")
    write_json(path.with_suffix(".json"), {**stored_numbers(path), "mean": 0.5})
    write_rows(path, [as_text(row(0))], "")
    assert stored_numbers(path)["mean"] == 0.5
    write_rows(path, [as_text(row(0)), as_text(row(1))], "")
    assert "mean" not in stored_numbers(path)


def test_rows_of_an_interrupted_study_stay(study, place, monkeypatch):
    def row_of(task):
        if task.index == 1:
            raise KeyboardInterrupt
        return row(task.index, model=task.model, noise=task.noise)

    monkeypatch.setattr(inversions, "inversion_row", row_of)
    with pytest.raises(KeyboardInterrupt):
        runner.carry_out(study, place)
    assert [one["index"] for one in read_rows(study.table(place))] == ["0"] * 4


def test_digits_that_are_there_stay(study, place):
    """Pandas would write 1.0 for 1, and 0.1 for 0.10."""
    path = study.table(place)
    path.write_text("model,noise,index,x\nten_components,0.0,0,0.10\n")
    write_rows(path, [*read_rows(path), as_text({"model": TEN, "x": np.float64(0.2)})], "")
    assert path.read_text().splitlines()[1:] == [
        "ten_components,0.0,0,0.10",
        "ten_components,,,0.2",
    ]


def test_another_table_is_refused(study, place):
    study.table(place).write_text("key,R2\n1,2\n")
    with pytest.raises(ArgumentError, match="output must have a table of this study"):
        study.missing(place)


def test_the_table_counts_wrong_answers_by_their_verdict(tmp_path):
    rows = [row(i) for i in range(40)]
    rows[0] |= {"site_error": 0.1}
    rows[1] |= {"site_error": 0.1, "verdict": NOT_CONVERGED}
    rows[2] |= {"site_error": 0.1, "spread": 0.05}  # far off, and says so
    table = pd.DataFrame(rows)
    assert wrong(table).sum() == 2
    path = write_table(tmp_path / "rows.csv", rows)
    line = accuracy_table(path).splitlines()[-1]
    assert "five components and alpha, 0.01 | 40 | 40 | 1, 1, 1e+02" in line
    assert "| 97.5 % | 1, 1 |" in line


def test_the_table_of_more_components_has_a_row_for_each_noise(tmp_path):
    found = {"prior_error": 0.4, "site_error": 2e-4, "spread": 1e-4, "seconds": 60.0}
    rows = [
        {"components": 20, "noise": 0.001, "verdict": CONVERGED} | found,
        {"components": 20, "noise": 0.001, "verdict": NOT_CONVERGED} | found | {"site_error": 0.1},
        {"components": 15, "noise": 0.01, "verdict": CONVERGED} | found,
    ]
    path = tmp_path / "rows.csv"
    pd.DataFrame(rows).to_csv(path, index=False)
    fifteen, twenty = components_table(path).splitlines()[2:]
    assert fifteen == "| 15, 0.01 | 1 | 400 | 0.2, 0.2 | 0.1 | 100 % | 0, 0 | 60 |"
    assert twenty == "| 20, 0.001 | 2 | 400 | 50, 1e+02 | 0.1 | 50 % | 1, 0 | 60 |"
    with pytest.raises(ResultMissingError, match="30 components"):
        thirty_components(path)
    pd.DataFrame([one | {"components": 30} for one in rows]).to_csv(path, index=False)
    assert thirty_components(path).value == pytest.approx(1 - 0.01 / 0.48, rel=1e-3)


def test_the_network_of_thirty_components_knows_something_of_fresh_wires():
    """It is asked on its own points of the grid, of wires and errors that it has not seen."""
    observation, _ = measured_wire(load_study("components").plan.grid(30), noise=0.001, index=0)
    features = network_features(model_of(shipped_model(THIRTY)), observation, RoundSettings.share)
    assert features is not None
    assert features.on_grid.data.size == observation.data.size / 4
    prior, rng = observation.unknowns.white_noise, np.random.default_rng(0)
    truth = prior.draw(rng, 40)
    labels = features.features_of_samples(features.on_grid.simulate(truth), rng)
    squares = ((labels - truth) ** 2).mean(axis=0) / np.diag(prior.covariance)
    assert squares[:-1].mean() < 0.7  # the mean of V it does not know
    assert features.features_of_data.shape == (31,)


def test_the_table_of_what_the_model_lacks_counts_both_checks(tmp_path):
    good = {"site_error": 0.001, "spread": 0.001, "verdict": CONVERGED, "p_predictive": 0.5}
    bad = good | {"site_error": 0.1, "verdict": NOT_CONVERGED, "p_predictive": 0.0099}
    rows = [
        {"kind": "gap", "prior": MODEL_ALONE, "departure": 2.0} | some
        for some in (bad, bad, bad | {"verdict": CONVERGED}, bad | good | {"site_error": 0.1}, good)
    ]
    rows += [rows[0] | {"kind": "nothing", "departure": 0.0} | good | {"p_predictive": 0.001}]
    rows += [rows[0] | {"prior": "wide"} | good]
    path = tmp_path / "rows.csv"
    pd.DataFrame(rows).to_csv(path, index=False)
    nothing, gap, wide = unmodelled_table(path).splitlines()[2:]
    assert nothing.endswith("| the model is right | 1 | 0 | 1, 1 | 0 | 0, 0 | 0 | 0, 1 |")
    assert nothing.startswith("| the model alone |")
    assert wide.startswith("| `wide.toml` | Δ₀ 20 % smaller, or larger | 1 |")
    assert gap.endswith("| 5 | 2 | 1e+02, 1e+02 | 4 | 2, 3 | 1 | 0, 0 |")


@pytest.mark.parametrize("kind", KINDS)
def test_something_is_measured_that_the_model_does_not_have(kind):
    """… from the middle field on if µ jumps; or the errors are others."""
    config = network_of(FIVE, 0.01).config.dataset.model_copy(update={"mu_points": 4})
    wire, settings = realization(config, 0).wire, empty_measurement(config)
    change = abs(true_conductances(kind, 0, wire, settings) - simulated(wire, settings))
    same = {NOTHING: settings.B.size, "jump": settings.B.size // 2, "errors": settings.B.size}
    before, after = np.split(change, [same.get(kind, 0)], axis=1)
    assert not before.any()
    assert not after.size or after.max() > 0.01
    assert (true_noise(kind, 0, 0.01) == 0.01) == (kind != "errors")


@pytest.mark.parametrize(
    ("prior", "kind"),
    [(MODEL_ALONE, NOTHING), *(("wide", kind) for kind in (NOTHING, *HELD_BY_WIDE))],
)
def test_the_true_device_is_right_where_the_prior_holds_it(prior, kind, monkeypatch):
    """It explains what is measured, and predicts that at other barriers; a wrong one does not."""
    shown = {}
    fresh = network_of(FIVE, 0.01).config.dataset.model_copy(update={"seed": SEED})

    def inverted(observation, network, seed):
        assert (network is None) == (prior == "wide")
        unknowns, truth = observation.unknowns, realization(fresh, 0)
        wire, settings = changed(kind, 0, truth.wire, observation.measurement)
        x = of_device(
            unknowns,
            truth.components,
            wire.potential,
            {
                "alpha": wire.alpha,
                "delta0": wire.delta0,
                "temperature": settings.temperature,
                "barrier_left": wire.barrier[0],
                "barrier_right": wire.barrier[1],
                "dissipation": 1e-9,
                "bias_offset": settings.bias[0] - observation.measurement.bias[0],
            },
        )
        x = x + shown["off"]
        shown["misfit"] = (observation.simulate(x[None])[0] - observation.data).std()
        found = Outcome([optimum_at(observation, Gaussian(x, 1e-10 * np.eye(x.size)))])
        return Inverted(found, {"spread": 1e-5})

    monkeypatch.setattr(unmodelled, "inverted", inverted)
    task = unmodelled.Task(FIVE, prior, 0.01, kind, 0)
    shown["off"] = 0.0
    row = unmodelled_row(task, samples=60, every=4)
    assert shown["misfit"] == pytest.approx(0.01, rel=0.05)
    assert row["site_error"] < 1e-5
    assert row["p_predictive"] > 0.02
    assert (row["departure"] > 1) == (kind != NOTHING)
    shown["off"] = 0.5
    assert unmodelled_row(task, samples=60, every=4)["p_predictive"] <= 0.02


@pytest.mark.parametrize("kind", list(KINDS))
def test_one_thing_is_other_than_the_model_has_it(kind):
    """And only one, in turns to either side where there are two; the parent does not leak.

    It is of the wire or of the settings, or only of what is measured.
    """
    wire = Nanowire(np.random.default_rng(0).normal(size=30))
    settings = empty_measurement(DatasetConfig(realizations=1, components=5))
    for index in range(2):
        other, others = changed(kind, index, wire, settings)
        differ = [
            name
            for one, two in ((wire, other), (settings, others))
            for name in vars(one)
            if not np.array_equal(getattr(one, name), getattr(two, name))
            and name != "parent_dissipation"
        ]
        assert len(differ) == (kind not in (NOTHING, "resistance", "jump", "errors"))
    first, second = (changed("gap", index, wire, settings)[0].delta0 for index in range(2))
    assert (first, second) == pytest.approx((0.096, 0.144))


def test_claims_of_uniqueness(information, tmp_path):
    path = tmp_path / "rows.csv"
    rows = [row(i, noise=0.0) for i in range(8)] + [row(9, noise=0.1, site_error=0.3)]
    rows[0] |= {"site_error": 0.1}
    rows[1] |= {"site_error": 0.1, "verdict": NOT_CONVERGED}
    write_table(path, rows)
    assert true_answers(path).value == pytest.approx(6 / 7)
    table = pd.DataFrame([one for rows in information.values() for one in rows])
    table.loc[table["noise"] == 0.01, "fixed"] = [4, 3]
    table.to_csv(path, index=False)
    assert fixed_combinations(path).value == 0.75


def test_visibility_is_of_all_answers_for_ten_components(tmp_path):
    path = tmp_path / "rows.csv"
    shown = {"both_topological": 30, "either_topological": 40}
    write_table(path, [row(0) | shown, row(0, model=TEN, noise=0.1) | shown])
    with pytest.raises(ResultMissingError, match="ten components"):
        visibility_of_inversions(path)
    more = {"both_topological": 60, "either_topological": 60}
    write_table(path, [row(0, model=TEN) | shown, row(1, model=TEN) | more, row(2, model=TEN)])
    assert visibility_of_inversions(path).value == pytest.approx(0.9)


def test_coverage_of_normal_deviations_is_nominal():
    table = pd.DataFrame([row(i) for i in range(2000)])
    np.testing.assert_allclose(coverage(table), [0.5, 0.8, 0.95], atol=0.02)


def test_joint_coverage_is_what_the_most_probable_part_holds():
    table = pd.DataFrame({"more_probable": (np.arange(1000) + 0.5) / 1000})
    np.testing.assert_allclose(joint_coverage(table), [0.5, 0.8, 0.95], atol=1e-9)
    np.testing.assert_allclose(joint_coverage(table**0.5), [0.25, 0.64, 0.9025], atol=1e-3)


@pytest.fixture(scope="module")
def information():
    return {
        points: information_rows(Setting(3, points, biases=3, temperature=0.05, index=0), NOISE)
        for points in (4, 7)
    }


def test_more_data_and_less_noise_fix_more(information):
    for rows in information.values():
        assert [one["noise"] for one in rows] == list(NOISE)
        spreads = [one["spread"] for one in rows]
        assert spreads == sorted(spreads)
        fixed = [one["fixed"] for one in rows]
        assert fixed == sorted(fixed, reverse=True)
        assert all(one["fixed"] <= one["unknowns"] == 4 for one in rows)
        assert all(one["spread"] <= one["prior_spread"] for one in rows)
    few, many = information[4], information[7]
    assert many[1]["spread"] < few[1]["spread"]


def test_the_table_of_uniqueness_has_a_column_per_grid(information, tmp_path):
    path = tmp_path / "uniqueness.csv"
    pd.DataFrame([one for rows in information.values() for one in rows]).to_csv(path, index=False)
    lines = uniqueness_table(path).splitlines()
    assert "4×4×3 | 7×7×3" in lines[0]
    assert len(lines) == 2 + len(SHOWN)
    assert "of 4: " in lines[2]
