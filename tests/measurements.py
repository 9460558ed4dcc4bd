"""A disorder model without a network, and simulated measurements of three of its wires."""

import json

from disorder_landscape import conductance
from disorder_landscape.config import Config, DatasetConfig
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.dataset.store import write_dataset

CONFIG = DatasetConfig(
    realizations=1, components=2, sites=60, mu_points=5, B_points=5, bias=(-0.03, 0.0, 0.03)
)


def write_measurements(folder):
    """Write model/config.json and 0.nc, 1.nc, 2.nc into a folder."""
    (folder / "model").mkdir()
    content = {"config": Config(dataset=CONFIG).model_dump(mode="json")}
    (folder / "model" / "config.json").write_text(json.dumps(content))
    for i in range(3):
        wire = realization(CONFIG, i).wire
        write_dataset(conductance(wire, CONFIG.mu, CONFIG.B, CONFIG.bias), folder / f"{i}.nc", {})
