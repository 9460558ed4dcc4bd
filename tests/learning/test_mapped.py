"""Conductances that are read from shards when asked for: the same numbers, the same training."""

import json

import numpy as np
import pytest

from disorder_landscape import ArgumentError
from disorder_landscape.config import Config, DatasetConfig, NetworkConfig, TrainingConfig
from disorder_landscape.dataset import shards
from disorder_landscape.dataset.mapped import MappedConductances
from disorder_landscape.dataset.store import read_dataset
from disorder_landscape.learning.examples import Rows
from disorder_landscape.learning.scaling import conductance_array, label_array
from disorder_landscape.learning.training import train
from disorder_landscape.model.quantities import CONDUCTANCES

CONFIG = DatasetConfig(
    realizations=22, components=2, sites=20, mu_points=8, B_points=8, shard_size=5
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dataset")
    shards.generate(CONFIG, folder)
    return folder


@pytest.fixture(scope="module")
def whole(folder):
    return conductance_array(shards.read_shards(CONFIG, folder))


def test_they_are_those_of_the_shards(folder, whole):
    mapped = MappedConductances(CONFIG, folder)
    assert (len(mapped), mapped.shape) == (22, whole.shape)
    which = np.array([21, 0, 3, 3, 12])
    np.testing.assert_array_equal(mapped[which], whole[which])
    np.testing.assert_array_equal(mapped[4:17], whole[4:17])
    rows = Rows(mapped, np.array([7, 2, 20]))
    np.testing.assert_array_equal(rows[1:], whole[[2, 20]])
    assert rows.shape == (3, *whole.shape[1:])


def test_a_part_of_a_dataset_has_its_realizations_only(folder, whole):
    fewer = CONFIG.model_copy(update={"realizations": 12})
    np.testing.assert_array_equal(MappedConductances(fewer, folder)[0:12], whole[:12])


def test_the_disorder_is_that_of_the_shards(folder):
    names = ("c_1", "c_2", "alpha", "mean")
    dataset = shards.read_disorder(CONFIG, folder)
    np.testing.assert_array_equal(
        label_array(dataset, names), label_array(shards.read_shards(CONFIG, folder), names)
    )
    assert "potential" not in dataset


@pytest.mark.parametrize("compress", [False, True])
def test_a_training_does_not_tell_the_difference(folder, tmp_path, compress):
    training = TrainingConfig(
        epochs=(2,), test_fraction=0.3, mirror=True, noise=0.01, compress_inputs=compress
    )
    config = Config(
        dataset=CONFIG,
        network=NetworkConfig(architecture="residual", width_fraction=0.03125),
        training=training,
    )
    train(shards.read_shards(CONFIG, folder), config, tmp_path / "memory", progress=False)
    train(
        shards.read_disorder(CONFIG, folder),
        config,
        tmp_path / "mapped",
        progress=False,
        conductances=MappedConductances(CONFIG, folder),
    )
    memory, mapped = (
        json.loads((tmp_path / of / "metrics.json").read_text()) for of in ("memory", "mapped")
    )
    assert memory == mapped


def test_every_flipped_bit_of_a_conductance_is_seen(folder, tmp_path):
    """In the map and when the shard is read as a whole."""
    for path in folder.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    path = shards.shard_path(tmp_path, 1)
    content = path.read_bytes()
    rng = np.random.default_rng(0)
    for name in CONDUCTANCES:
        numbers = read_dataset(path)[name].to_numpy().tobytes()
        at = content.index(numbers) + int(rng.integers(len(numbers)))
        flipped = bytearray(content)
        flipped[at] ^= 1 << int(rng.integers(8))
        path.write_bytes(flipped)
        with pytest.raises(ArgumentError, match="is damaged"):
            MappedConductances(CONFIG, tmp_path)
        with pytest.raises(ArgumentError, match="cannot be read"):
            shards.read_shards(CONFIG, tmp_path)
        path.write_bytes(content)
    np.testing.assert_array_equal(
        MappedConductances(CONFIG, tmp_path)[5:10], MappedConductances(CONFIG, folder)[5:10]
    )


def test_conductances_in_pieces_are_refused(folder, tmp_path):
    for path in folder.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    path = shards.shard_path(tmp_path, 2)
    dataset = read_dataset(path)
    encoding = {"G_LR": {"zlib": True, "chunksizes": dataset["G_LR"].shape}}
    dataset.drop_encoding().to_netcdf(path, engine="h5netcdf", encoding=encoding)
    with pytest.raises(ArgumentError, match="is damaged"):
        MappedConductances(CONFIG, tmp_path)
