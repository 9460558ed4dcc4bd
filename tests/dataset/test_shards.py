"""Shards: the same bytes whatever the workers, the order or the accidents; refusals."""

import hashlib
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from disorder_landscape import ArgumentError, chain, conductance
from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset import realizations, shards, store
from disorder_landscape.executors.executor import Share
from disorder_landscape.executors.local import LocalProcesses
from disorder_landscape.model.quantities import CONDUCTANCES

CONFIG = DatasetConfig(realizations=11, sites=30, mu_points=3, B_points=4, shard_size=3, seed=5)


def digests(folder):
    return {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in folder.iterdir()}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made")
    shards.generate(CONFIG, folder)
    return folder


def test_two_workers_write_the_same_bytes(made, tmp_path):
    shards.generate(CONFIG, tmp_path, LocalProcesses(2))
    assert digests(tmp_path) == digests(made)


def test_any_order_gives_the_same_bytes(made, tmp_path):
    for shard in (3, 0, 2, 1):
        shards.make_shard(CONFIG, tmp_path, shard)
    assert digests(tmp_path) == digests(made)


def test_only_what_is_missing_is_made(made, tmp_path):
    shards.make_shard(CONFIG, tmp_path, 1)
    before = shards.shard_path(tmp_path, 1).stat().st_mtime_ns
    calls = []
    shards.generate(CONFIG, tmp_path, progress=calls.append)
    assert sum(calls) == 8
    assert shards.shard_path(tmp_path, 1).stat().st_mtime_ns == before
    assert digests(tmp_path) == digests(made)


def test_a_kill_in_the_middle_leaves_nothing_half_done(tmp_path):
    """After a kill −9 the same command completes the dataset, to the same bytes."""
    config = CONFIG.model_copy(update={"realizations": 60, "sites": 300, "mu_points": 8})
    script = (
        "from pathlib import Path\n"
        "from disorder_landscape.config import DatasetConfig\n"
        "from disorder_landscape.dataset import shards\n"
        f"config = DatasetConfig.model_validate_json({config.model_dump_json()!r})\n"
        f"shards.generate(config, Path({str(tmp_path / 'killed')!r}))\n"
    )
    process = subprocess.Popen([sys.executable, "-c", script])
    while not list(tmp_path.glob("killed/shard-*.nc")):
        time.sleep(0.02)
        assert process.poll() is None
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    now = shards.status(config, tmp_path / "killed")
    assert 0 < now.shards < now.shards_in_all
    shards.generate(config, tmp_path / "killed")
    shards.generate(config, tmp_path / "whole")
    assert digests(tmp_path / "killed") == digests(tmp_path / "whole")


def test_a_dataset_can_grow(made, tmp_path):
    """More realizations of the same configuration are added; the first ones stay as they are."""
    shards.generate(CONFIG.model_copy(update={"realizations": 5}), tmp_path)
    shards.generate(CONFIG, tmp_path)
    assert digests(tmp_path) == digests(made)
    fewer = CONFIG.model_copy(update={"realizations": 4})
    assert shards.read_shards(fewer, made).sizes["realization"] == 4


def test_a_realization_is_what_the_simulator_says(made):
    dataset = shards.read_shards(CONFIG, made)
    assert dataset.sizes["realization"] == 11
    one = realizations.realization(CONFIG, 7)
    G = conductance(one.wire, CONFIG.mu, CONFIG.B, CONFIG.bias)
    for name in CONDUCTANCES:
        np.testing.assert_allclose(dataset[name][7], G[name], atol=1e-6)
        assert dataset[name].attrs["units"] == "e^2/h"
    np.testing.assert_array_equal(dataset.components[7], one.components)
    assert dataset.alpha[7] == one.alpha
    with xr.open_dataset(shards.shard_path(made, 1), engine="h5netcdf") as file:
        assert (file.first_index, file.last_index, file.seed) == (3, 5, 5)
        assert file.config_hash == CONFIG.hash
        assert file.version_numpy == np.__version__


def test_shards_keep_what_the_solver_says_of_its_error(made):
    shard = store.read_dataset(shards.shard_path(made, 0), ["error", "energies"])
    one = realizations.realization(CONFIG, 1)
    G = conductance(one.wire, CONFIG.mu, CONFIG.B, CONFIG.bias)
    np.testing.assert_allclose(shard.error[1], G.error, rtol=1e-6)
    np.testing.assert_array_equal(shard.energies[1], G.energies)
    assert shard.error.dims == shard.energies.dims == ("realization", "mu", "B")
    every = [store.read_dataset(path) for path in made.iterdir()]
    largest = max(float(one.error.max()) for one in every)
    assert shards.status(CONFIG, made).largest_error == pytest.approx(largest)


def test_an_average_over_a_grid_states_no_error(tmp_path):
    config = CONFIG.model_copy(update={"energy_spacing": 1e-3, "realizations": 2})
    shards.generate(config, tmp_path)
    assert shards.status(config, tmp_path).largest_error is None
    assert "error" not in store.read_dataset(shards.shard_path(tmp_path, 0))


def test_a_dataset_that_is_less_exact_than_a_measurement_says_so(made):
    now = shards.status(CONFIG, made)
    assert chain.accuracy_warning(now) == ""
    assert chain.accuracy_warning(replace(now, largest_error=None)) == ""
    said = chain.accuracy_warning(replace(now, largest_error=0.02))
    assert "errors of up to 0.02 e²/h in this dataset, more than the 0.001 of a" in said


def test_shards_of_another_configuration_are_refused_and_kept(made, tmp_path):
    other = CONFIG.model_copy(update={"temperature": 0.04})
    shards.make_shard(CONFIG, tmp_path, 0)
    before = digests(tmp_path)
    with pytest.raises(ArgumentError, match="another configuration"):
        shards.generate(other, tmp_path)
    assert digests(tmp_path) == before


def test_a_truncated_shard_is_refused(tmp_path):
    shards.make_shard(CONFIG, tmp_path, 0)
    path = shards.shard_path(tmp_path, 0)
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(ArgumentError, match="is damaged"):
        shards.generate(CONFIG, tmp_path)


def test_a_foreign_file_is_refused(tmp_path):
    xr.Dataset({"something": 1.0}).to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    with pytest.raises(ArgumentError, match="lacks G_LL"):
        store.read_dataset(tmp_path / "other.nc", ["G_LL"])


def test_a_missing_shard_is_named(tmp_path):
    shards.make_shard(CONFIG, tmp_path, 0)
    with pytest.raises(ArgumentError, match="holds 3"):
        shards.read_shards(CONFIG, tmp_path)


def test_a_nan_fails_the_shard(tmp_path, monkeypatch):
    def broken(config, indices):
        dataset = simulate(config, indices)
        dataset["G_LR"][0, 0, 0, 0] = np.nan
        return dataset

    simulate = realizations.simulate
    monkeypatch.setattr(realizations, "simulate", broken)
    with pytest.raises(ArgumentError, match="G_LR has 1 numbers that are not"):
        shards.make_shard(CONFIG, tmp_path, 0)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("year", [1980, 2100])
def test_a_clock_that_was_moved_changes_nothing(made, tmp_path, year):
    """What is there is there, whenever the clock says that it was written."""
    for shard in (0, 2):
        shards.make_shard(CONFIG, tmp_path, shard)
        moment = (year - 1970) * 365 * 86400
        os.utime(shards.shard_path(tmp_path, shard), (moment, moment))
    added = []
    shards.generate(CONFIG, tmp_path, progress=added.append)
    assert sum(added) == 5
    assert digests(tmp_path) == digests(made)


def test_shares_of_a_dataset_make_the_same_bytes(made, tmp_path):
    """Whatever is there already, and though two jobs know nothing of each other."""
    shards.make_shard(CONFIG, tmp_path, 2)
    said = []
    for number in (3, 1, 2):
        shards.generate(CONFIG, tmp_path, progress=said.append, share=Share(number, 3))
    assert digests(tmp_path) == digests(made)
    assert said == [3, 2, 3]  # shards 0 and 3, then 1; shard 2 is there
