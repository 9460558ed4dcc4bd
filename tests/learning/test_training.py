"""A training learns, goes on where it was, and never mixes with another."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.learning import checkpoints, training
from disorder_landscape.learning.curves import read_curves
from disorder_landscape.learning.examples import chosen, split
from disorder_landscape.learning.model import load_model, read_model_file
from disorder_landscape.learning.scaling import conductance_array
from disorder_landscape.learning.schedule import learning_rate, numbered_epochs
from disorder_landscape.learning.training import train
from synthetic import synthetic_dataset, tiny_config

SHORT = tiny_config(realizations=40, width_fraction=0.01, epochs=(2, 1))


def weights(folder: Path) -> list[np.ndarray]:
    return [np.asarray(w) for w in load_model(folder).network.get_weights()]


def content(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_the_synthetic_dataset_is_learnt(trained):
    metrics = json.loads((trained / "metrics.json").read_text())
    assert metrics["r2"] > 0.9
    assert metrics["realizations"] == 40


def test_the_folder_holds_the_model_and_its_provenance(trained, config):
    names = {path.name for path in trained.iterdir()}
    curves = {"curves.csv", "curves.pdf", "curves.png"}
    assert names == {"network.keras", "scaler.json", "config.json", "metrics.json"} | curves
    record = json.loads((trained / "config.json").read_text())
    assert record["dataset"]["config_hash"] == config.dataset.hash
    assert record["command"] == "tests"
    assert {"keras", "numpy", "backend"} <= set(record["versions"])
    assert load_model(trained).config == config


def test_curves_follow_the_schedule(trained):
    curves = read_curves(trained / "curves.csv")
    assert [epoch.epoch for epoch in curves] == list(range(1, 11))
    assert [epoch.set for epoch in curves] == [1] * 8 + [2] * 2
    assert curves[-1].learning_rate == pytest.approx(1e-4)
    assert curves[-1].loss < curves[0].loss
    metrics = json.loads((trained / "metrics.json").read_text())
    assert curves[-1].validation_r2 == pytest.approx(metrics["r2"], abs=1e-12)


def test_a_finished_training_is_left_alone(trained, config, dataset, capsys):
    before = content(trained)
    scores = train(dataset, config, trained)
    assert scores.to_dict() == read_model_file(trained / "metrics.json")
    assert "nothing to do" in capsys.readouterr().out
    assert content(trained) == before


def test_an_interrupted_training_ends_like_an_uninterrupted_one(tmp_path, monkeypatch):
    """Interrupted in the middle of the second epoch: the first is kept, the second repeated."""
    dataset = synthetic_dataset(SHORT)
    whole = train(dataset, SHORT, tmp_path / "whole", progress=False)

    class Interrupted(training.tqdm):
        def update(self, n=1):
            if self.n > 100:  # of 72 per epoch
                raise KeyboardInterrupt
            return super().update(n)

    with monkeypatch.context() as patch:
        patch.setattr(training, "tqdm", Interrupted)
        with pytest.raises(KeyboardInterrupt):
            train(dataset, SHORT, tmp_path / "resumed")
    assert [path.name for path in (tmp_path / "resumed").glob("checkpoint-*")] == [
        "checkpoint-0001"
    ]
    with pytest.raises(ArgumentError, match="not finished"):
        load_model(tmp_path / "resumed")
    with pytest.raises(ArgumentError, match=r"no model in '.*', but one in '.*resumed'\.$"):
        load_model(tmp_path)
    (tmp_path / "resumed" / ".writing-checkpoint-0002").mkdir()  # as a kill −9 leaves it

    resumed = train(dataset, SHORT, tmp_path / "resumed", progress=False)
    assert resumed.r2 == pytest.approx(whole.r2, abs=1e-9)
    pairs = zip(weights(tmp_path / "resumed"), weights(tmp_path / "whole"), strict=True)
    for resumed_weight, weight in pairs:
        np.testing.assert_allclose(resumed_weight, weight, rtol=0, atol=1e-7)
    assert not list((tmp_path / "resumed").glob("*checkpoint*"))


@pytest.mark.parametrize(
    ("other", "what"),
    [
        (tiny_config(epochs=(9, 2)), r"another \[training\] section"),
        (tiny_config(width_fraction=0.05), r"another \[network\] section"),
        (tiny_config(realizations=390), "another number of realizations"),
    ],
)
def test_the_folder_of_another_training_is_refused(trained, other, what):
    before = content(trained)
    with pytest.raises(ArgumentError, match=what):
        train(synthetic_dataset(other), other, trained)
    assert content(trained) == before


def test_the_folder_of_another_dataset_is_refused(trained, config, dataset):
    other = config.model_copy(update={"dataset": config.dataset.model_copy(update={"seed": 1})})
    with pytest.raises(ArgumentError, match=r"folder must .* another dataset"):
        train(dataset.assign_attrs(config_hash=other.dataset.hash), other, trained)


def test_a_folder_with_something_else_is_refused(tmp_path, config, dataset):
    (tmp_path / "thesis.tex").write_text("")
    with pytest.raises(ArgumentError, match=r"folder must be empty .* holds something else"):
        train(dataset, config, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_a_dataset_of_another_config_is_refused(tmp_path, config, dataset):
    with pytest.raises(ArgumentError, match="dataset must be the one the config describes"):
        train(dataset.assign_attrs(config_hash="0"), config, tmp_path / "model")
    assert not (tmp_path / "model").exists()


def test_learning_rate_is_divided_by_ten_from_set_to_set():
    training_config = tiny_config(epochs=(2, 1, 1), learning_rate=1e-4).training
    epochs, sets = zip(*numbered_epochs(training_config), strict=True)
    assert epochs == (1, 2, 3, 4)
    assert sets == (1, 1, 2, 3)
    rates = [learning_rate(training_config, epoch, share=0.9) for epoch in epochs]
    assert rates == pytest.approx((1e-4, 1e-4, 1e-5, 1e-6))


def test_the_cosine_rises_over_one_epoch_and_falls_to_zero():
    config = tiny_config(epochs=(5,), learning_rate=1e-3, schedule="cosine").training
    done = np.linspace(0, 5, 51)[:-1]
    rates = [learning_rate(config, 1 + int(x), x - int(x)) for x in done]
    assert np.argmax(rates) == 10
    assert max(rates) == pytest.approx(1e-3)
    assert rates[30] == pytest.approx(0.5e-3)  # half of the way from 1 to 5
    assert rates[0] > 0
    assert rates[-1] < 2e-6


def test_the_last_tenth_is_for_testing():
    assert split(8000, 0.1) == (slice(0, 7200), slice(7200, 8000))


@pytest.mark.parametrize(("realizations", "fraction"), [(10, 0.1), (10, 0.9)])
def test_a_dataset_too_small_to_split_is_refused(realizations, fraction):
    with pytest.raises(ArgumentError, match="dataset must leave two realizations"):
        split(realizations, fraction)


def test_only_as_many_training_realizations_are_used_as_are_asked_for(tmp_path):
    """What the others are may be anything, but for the test set."""
    config = tiny_config(realizations=40, width_fraction=0.01, epochs=(1,))
    used = config.training.model_copy(update={"realizations": 20})
    config = config.model_copy(update={"training": used})
    dataset = synthetic_dataset(config)
    changed = dataset.copy(deep=True)
    unused = np.setdiff1d(np.arange(36), chosen(slice(0, 36), 20, config.training.seed))
    changed["G_LL"][unused] += 1.0
    one = train(dataset, config, tmp_path / "one", progress=False)
    assert train(changed, config, tmp_path / "other", progress=False) == one


def test_fewer_training_realizations_are_among_more_and_differ_by_seed():
    few, more = (chosen(slice(4, 40), n, seed=1) for n in (10, 20))
    assert len(more) == 20
    assert set(few) < set(more) < set(range(4, 40))
    assert set(few) != set(chosen(slice(4, 40), 10, seed=2))
    assert chosen(slice(4, 40), None, seed=1) == slice(4, 40)
    with pytest.raises(ArgumentError, match="at most 36"):
        chosen(slice(4, 40), 37, seed=1)


def test_passes_are_epochs_without_a_validation_in_between(tmp_path, monkeypatch):
    config = tiny_config(realizations=40, width_fraction=0.01, epochs=(2,), passes=3)
    seen = []
    take = training.Examples.conductances
    monkeypatch.setattr(
        training.Examples,
        "conductances",
        lambda self, which, rng: seen.append(which) or take(self, which, rng),
    )
    train(synthetic_dataset(config), config, tmp_path / "model", progress=False)
    assert len(read_curves(tmp_path / "model" / "curves.csv")) == 2
    counts = np.bincount(np.concatenate(seen))
    assert counts.tolist() == [6] * 72  # two epochs of three passes over 36 wires and images


def test_an_ensemble_predicts_the_mean_of_its_networks(tmp_path):
    config = tiny_config(realizations=40, width_fraction=0.01, epochs=(1,), networks=2, seed=3)
    dataset = synthetic_dataset(config)
    scores = train(dataset, config, tmp_path / "both", progress=False)
    both, *members = (
        load_model(tmp_path / "both" / name) for name in ("", "network-1", "network-2")
    )
    assert [member.config.training.seed for member in members] == [3, 4]
    X = conductance_array(dataset)[:5]
    one, other = (member.predict_labels(X) for member in members)
    assert abs(one - other).max() > 1e-3
    np.testing.assert_allclose(both.predict_labels(X), (one + other) / 2, atol=1e-5)
    assert train(dataset, config, tmp_path / "both", progress=False) == scores
    assert [epoch.epoch for epoch in read_curves(tmp_path / "both" / "curves.csv")] == [1, 2]


def test_what_takes_long_to_save_is_saved_less_often(tmp_path, monkeypatch):
    clock, saved = [0.0], []

    def save(folder, network, curves):
        clock[0] += 3.0
        saved.append(len(curves))

    monkeypatch.setattr(checkpoints.time, "perf_counter", lambda: clock[0])
    monkeypatch.setattr(checkpoints, "save_checkpoint", save)
    kept = checkpoints.Checkpoints(tmp_path)
    for epoch in range(1, 21):
        clock[0] += 6.0
        kept.save_if_due(None, [None] * epoch)
    assert saved == [1, 6, 11, 16]  # a tenth of the time: 3 s of 30
