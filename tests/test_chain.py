"""The whole chain of the preset "smoke": dataset, training, evaluation, through the commands."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from disorder_landscape import ArgumentError, Nanowire, chain, conductance, predict, runs
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.learning.model import load_model_config
from disorder_landscape.model.quantities import CONDUCTANCES

CONFIG = "configs/smoke.toml"
R2_TO_REACH = 0.87
"""Measured: 0.913 to 0.921, three seeds; the paper's network, 1/16 wide, on 1,080 short wires."""


LARGEST_RATIO = 0.5
"""Of 30 predictions of the shipped network the largest is 0.17, a median one 0.045."""


def predicted_wire(one):
    return Nanowire(one.potential_predicted, alpha=one.alpha_predicted.item())


def landscape(*arguments):
    command = [str(Path(sys.executable).with_name("landscape")), *map(str, arguments)]
    return subprocess.run(command, check=True, capture_output=True, text=True)


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    folder = tmp_path_factory.mktemp("build")
    for command in ("generate", "train", "evaluate"):
        landscape(command, "--config", CONFIG, "--build", folder)
    return folder


@pytest.fixture(scope="module")
def run(build):
    return runs.open_run(CONFIG, build)


def test_the_reduced_run_reaches_its_score(run):
    evaluation = xr.load_dataset(run.evaluation_file, engine="h5netcdf")
    assert evaluation.attrs["R2"] > R2_TO_REACH
    assert evaluation.sizes["realization"] == 120
    error = evaluation.potential_predicted - evaluation.potential
    without_mean = error - error.mean("site")
    assert evaluation.attrs["delta_V"] == pytest.approx(without_mean.std().item(), rel=0.05)
    assert evaluation.attrs["delta_alpha"] == pytest.approx(
        (evaluation.alpha_predicted - evaluation.alpha).std().item()
    )


def test_the_predicted_wire_conducts_like_the_true_one(tmp_path):
    """The point of the paper: the prediction's conductance is closer than another wire's.

    Of the shipped network, R² = 0.994: what the training of a test makes depends on the machine.
    """
    evaluation = chain.evaluation(runs.preset_run("shipped", tmp_path, runs.FIVE))
    ratios = []
    for i in range(10):
        one, following = evaluation.isel(realization=i), evaluation.isel(realization=i + 1)
        true, other, guess = (
            conductance(wire, np.linspace(0, 0.6, 8), np.linspace(0, 0.8, 8), [0.0, 0.02])[
                list(CONDUCTANCES)
            ]
            .to_array()
            .to_numpy()
            for wire in (
                Nanowire(one.potential, alpha=one.alpha.item()),
                Nanowire(following.potential, alpha=following.alpha.item()),
                predicted_wire(one),
            )
        )
        ratios.append(np.linalg.norm(true - guess) / np.linalg.norm(true - other))
    assert max(ratios) < LARGEST_RATIO


def test_status_tells_what_is_there(run, build):
    said = landscape("status", "--config", CONFIG, "--build", build).stdout
    assert "1200 of 1200 realizations in 24 of 24 shards" in said
    assert "trained" in said
    assert "evaluation  there" in said


def test_a_finished_chain_is_left_alone(run, build):
    before = (run.model_folder / "network.keras").stat().st_mtime_ns
    said = landscape("train", "--config", CONFIG, "--build", build)
    assert "nothing to do" in said.stdout + said.stderr
    assert (run.model_folder / "network.keras").stat().st_mtime_ns == before


def test_a_network_of_another_configuration_is_not_scored(run):
    training = run.config.training.model_copy(update={"batch_size": 7})
    other = replace(run, config=run.config.model_copy(update={"training": training}))
    for scored in (chain.evaluate, chain.evaluation):
        with pytest.raises(ArgumentError, match="config must be that of the network"):
            scored(other)


def test_predict_from_a_file_is_predict_from_the_library(run, tmp_path):
    config = run.config.dataset
    wire = realization(config, 1100).wire
    G = conductance(wire, config.mu, config.B, config.bias)
    G.to_netcdf(tmp_path / "wire.nc", engine="h5netcdf")
    landscape("predict", tmp_path / "wire.nc", "--model", run.model_folder, "-o", tmp_path / "Y.nc")
    Y = xr.load_dataset(tmp_path / "Y.nc", engine="h5netcdf")
    expected = predict(run.model_folder, G)
    np.testing.assert_allclose(Y.components, expected.components, atol=1e-6)
    assert Y.potential.sizes == {"site": 100}
    stored = xr.load_dataset(run.evaluation_file, engine="h5netcdf").sel(realization=1100)
    np.testing.assert_allclose(Y.components, stored.components_predicted, atol=1e-3)


def test_a_measurement_on_another_grid_is_refused(run):
    config = run.config.dataset
    G = conductance(realization(config, 0).wire, config.mu[:-1], config.B, config.bias)
    with pytest.raises(ArgumentError, match="it differs in mu"):
        predict(run.model_folder, G)


@pytest.mark.parametrize(("model", "R2"), [(runs.FIVE, 0.99), (runs.TEN, 0.96)])
def test_a_shipped_model_predicts_its_shipped_test_set(model, R2, tmp_path):
    shipped = chain.evaluation(runs.preset_run("shipped", tmp_path, model))
    assert shipped.sizes["realization"] == 200
    assert shipped.attrs["R2"] > R2
    assert load_model_config(runs.shipped_model(model)).dataset.alpha_is_label == (
        model == runs.FIVE
    )


def test_presets_without_ten_components_draw_the_shipped_ones_their_way():
    run = runs.preset_run("smoke", model=runs.TEN)
    assert run.shipped
    assert run.config.dataset.components == 10
    assert run.config.figures == runs.preset_run("smoke").config.figures
    assert not runs.preset_run("full", model=runs.TEN).shipped
    assert not runs.preset_run("full", model=runs.FIVE).shipped
    assert not runs.preset_run("small").shipped


def test_the_shipped_files_are_those_of_the_checksums():
    subprocess.run(
        ["sha256sum", "--check", "--quiet", "SHA256SUMS"],
        cwd=runs.REPOSITORY / "data_small",
        check=True,
    )
    folders = (runs.REPOSITORY / name for name in ("data_small", "results"))
    files = (path for folder in folders for path in folder.rglob("*") if path.is_file())
    assert sum(path.stat().st_size for path in files) < 60e6  # what the repository may hold
