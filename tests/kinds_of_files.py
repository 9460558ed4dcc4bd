"""One file of each kind that the project writes: how it is made, and what it says."""

import json

import numpy as np

from disorder_landscape import conductance
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
from disorder_landscape.runs import FIVE, shipped_model
from disorder_landscape.studies.rows import read_rows, write_rows

CONFIG = DatasetConfig(realizations=4, components=2, sites=20, mu_points=3, B_points=3)


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
