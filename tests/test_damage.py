"""Files that were damaged: each is refused with a sentence, or says what it said; none is written.

Ten kinds of damage to each kind of file, once each in the fast tests and fifty times in the slow
ones.
"""

import json

import numpy as np
import pytest

from disorder_landscape import ArgumentError, conductance
from disorder_landscape.chain import FIVE, shipped_model
from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset import shards
from disorder_landscape.dataset.mapped import MappedConductances
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.dataset.store import read_dataset, write_dataset
from disorder_landscape.files import write_json
from disorder_landscape.inference.checkpoint import Checkpoint
from disorder_landscape.learning.checkpoints import load_checkpoint, save_checkpoint
from disorder_landscape.learning.curves import Epoch
from disorder_landscape.learning.model import load_model
from disorder_landscape.learning.networks.build import build_network
from disorder_landscape.studies.rows import read_rows, write_rows

CONFIG = DatasetConfig(realizations=4, components=2, sites=20, mu_points=3, B_points=3)
DAMAGES = {
    "cut off": lambda b, rng: b[: rng.integers(len(b))],
    "empty": lambda b, rng: b"",
    "a bit": lambda b, rng: _changed(b, rng, lambda x: [x[0] ^ (1 << int(rng.integers(8)))], 1),
    "zeros": lambda b, rng: _changed(b, rng, lambda x: bytes(len(x)), 64),
    "noise": lambda b, rng: _changed(b, rng, lambda x: rng.bytes(len(x)), 64),
    "longer": lambda b, rng: b + rng.bytes(100),
    "swapped": lambda b, rng: b[len(b) // 2 :] + b[: len(b) // 2],
    "foreign": lambda b, rng: b"%PDF-1.4 " + rng.bytes(1000),
    "inserted": lambda b, rng: _changed(b, rng, lambda x: b"x" + x, 1),
    "lost": lambda b, rng: _changed(b, rng, lambda x: b"", 1),
}


def _changed(content, rng, change, length):
    at = int(rng.integers(max(len(content) - length, 1)))
    return content[:at] + bytes(change(content[at : at + length])) + content[at + length :]


def values(dataset):
    return {name: variable.to_numpy().tolist() for name, variable in dataset.variables.items()}


class Shard:
    file = "shard-00000.nc"

    def make(self, folder):
        shards.generate(CONFIG, folder)

    def read(self, folder):
        mapped = MappedConductances(CONFIG, folder)
        return values(shards.read_shards(CONFIG, folder)), mapped[0:4].tolist()


class Measurement:
    file = "wire.nc"

    def make(self, folder):
        wire = realization(CONFIG, 0).wire
        write_dataset(conductance(wire, CONFIG.mu, CONFIG.B, CONFIG.bias), folder / self.file, {})

    def read(self, folder):
        return values(read_dataset(folder / self.file))


class Table:
    file = "table.csv"

    def make(self, folder):
        rows = [{"name": "one", "value": "0.25"}, {"name": "two", "value": "0.5"}]
        write_rows(folder / "table.csv", rows, "test")

    def read(self, folder):
        return read_rows(folder / "table.csv")


class Beside(Table):
    file = "table.json"


class Unfinished:
    file = "wire.nc.unfinished.json"

    def make(self, folder):
        numbers = np.random.default_rng(0).normal(size=40).tolist()
        Checkpoint(folder / self.file, b"run").cached("round 1", lambda: {"numbers": numbers})

    def read(self, folder):
        return Checkpoint(folder / self.file, b"run").cached("round 1", lambda: {"numbers": []})


class Model:
    def __init__(self, file):
        self.file = file

    def make(self, folder):
        for path in shipped_model(FIVE).iterdir():
            (folder / path.name).write_bytes(path.read_bytes())
        for path in folder.glob("*.json"):  # as they are written now, with a checksum
            write_json(path, json.loads(path.read_text()))

    def read(self, folder):
        model = load_model(folder)
        return (
            [weights.tobytes() for weights in model.network.get_weights()],
            model.labels.to_dict(),
            model.config,
            dict(model.r2_by_label),
        )


class Training:
    file = "checkpoint-0001/network.keras"

    def make(self, folder):
        network = build_network((8, 8, 5, 4), 3, 0.03125, 1e-3, architecture="residual")
        network.train_on_batch(np.ones((2, 8, 8, 5, 4)), np.ones((2, 3)))
        save_checkpoint(folder, network, [Epoch(1, 1, 1e-4, 0.5, 0.5, 1.0)])

    def read(self, folder):
        network, curves = load_checkpoint(folder)
        return [weights.tobytes() for weights in network.get_weights()], curves


class Curves(Training):
    file = "checkpoint-0001/curves.json"


KINDS = {
    "shard": Shard(),
    "measurement": Measurement(),
    "table": Table(),
    "beside a table": Beside(),
    "unfinished inversion": Unfinished(),
    "network": Model("network.keras"),
    "scalers": Model("scaler.json"),
    "configuration of a model": Model("config.json"),
    "scores of a model": Model("metrics.json"),
    "training": Training(),
    "curves of a training": Curves(),
}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Return a folder with a file of a kind, and what it says."""
    known = {}

    def make(kind):
        if kind not in known:
            folder = tmp_path_factory.mktemp("made")
            KINDS[kind].make(folder)
            known[kind] = folder, KINDS[kind].read(folder)
        return known[kind]

    return make


@pytest.mark.parametrize("times", [1, pytest.param(50, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", KINDS)
def test_a_damaged_file_is_refused_or_says_the_same(kind, times, made):
    folder, before = made(kind)
    path = folder / KINDS[kind].file
    whole = path.read_bytes()
    rng = np.random.default_rng(len(kind))
    wrong, refused = [], 0
    for name, damage in DAMAGES.items():
        for k in range(times):
            damaged = damage(whole, rng)
            path.write_bytes(damaged)
            try:
                if KINDS[kind].read(folder) != before:
                    wrong.append((name, k, "read as something else"))
            except ArgumentError:
                refused += 1
            except Exception as error:
                wrong.append((name, k, repr(error)[:120]))
            assert path.read_bytes() == damaged
    path.write_bytes(whole)
    assert not wrong, "\n".join(map(str, wrong))
    assert refused >= 5 * times


def test_a_renamed_shard_is_refused(tmp_path):
    config = CONFIG.model_copy(update={"shard_size": 2})
    shards.generate(config, tmp_path)
    first, second = (shards.shard_path(tmp_path, k) for k in (0, 1))
    first.write_bytes(second.read_bytes())
    with pytest.raises(ArgumentError, match="realizations of another shard"):
        shards.generate(config, tmp_path)
    assert first.read_bytes() == second.read_bytes()
