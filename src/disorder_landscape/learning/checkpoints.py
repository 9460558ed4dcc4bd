"""Where a training stands: saved after its epochs, so that an interrupted one goes on."""

from __future__ import annotations

import shutil
import time
from dataclasses import asdict, dataclass, field
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any

import xarray as xr

from disorder_landscape.arguments import require
from disorder_landscape.config import Config
from disorder_landscape.files import replacing, write_json
from disorder_landscape.learning.backend import import_keras
from disorder_landscape.learning.curves import Epoch
from disorder_landscape.learning.model import (
    load_network,
    read_model_file,
    save_network,
)
from disorder_landscape.learning.model_files import CONFIG, NETWORK

CURVES = "curves.json"
"""In a checkpoint: the record of each epoch."""
PACKAGES = ("disorder-landscape", "keras", "numpy", "scikit-learn")
"""Packages whose versions a model records, besides the Keras backend's."""
IDENTITY = (
    ("config", "network", "[network] section"),
    ("config", "training", "[training] section"),
    ("dataset", "config_hash", "dataset"),
    ("dataset", "realizations", "number of realizations"),
)
"""What in config.json tells one training from another."""


SHORT = 1.0
"""Seconds that saving may take after every epoch."""
SHARE = 0.1
"""Of the time of a training, which longer saving may take.

With all of the paper's filters a checkpoint has 660 MB. Saved after every epoch, it made one of 520
realizations last 3.3 s on an NVIDIA H200 that nine trainings shared; the steps took 0.6 s.
"""


def claim(folder: Path, config: Config, dataset: xr.Dataset, command: str) -> None:
    """Write config.json into a training's folder, or check that it is the same training's.

    The same is: the same network and training sections, and as many realizations of the same
    dataset. Nothing is written unless the folder is new or empty.

    Raises
    ------
    ArgumentError
        If the folder belongs to another training, or holds something else.
    """
    record: dict[str, Any] = {
        "config": config.model_dump(mode="json"),
        "dataset": {
            "config_hash": dataset.attrs["config_hash"],
            "realizations": dataset.sizes["realization"],
            "command": dataset.attrs.get("command", ""),
        },
        "command": command,
        "versions": _versions(),
    }
    must = "be empty or hold this very training"
    path = folder / CONFIG
    if not path.exists():
        require(not folder.is_file(), "folder", must, f"'{folder}' is a file")
        used = folder.exists() and any(folder.iterdir())
        require(not used, "folder", must, f"'{folder}' holds something else")
        write_json(path, record)
        return
    there = read_model_file(path)
    for part, key, what in IDENTITY:
        same = there.get(part, {}).get(key) == record[part][key]
        require(same, "folder", must, f"'{folder}' holds one with another {what}")


@dataclass
class Checkpoints:
    """Those of a training in this process: one an epoch, or fewer where saving takes long."""

    folder: Path
    _finished: float = field(default_factory=time.perf_counter, init=False)
    """When the last one was."""
    _took: float = field(default=0.0, init=False)

    def save_if_due(self, network: Any, curves: list[Epoch]) -> None:
        """Save where the training stands after an epoch, unless that would take too much of it."""
        since = time.perf_counter() - self._finished
        if self._took > SHORT and self._took > SHARE * since:
            return
        started = time.perf_counter()
        save_checkpoint(self.folder, network, curves)
        self._finished = time.perf_counter()
        self._took = self._finished - started


def save_checkpoint(folder: Path, network: Any, curves: list[Epoch]) -> None:
    """Save the network, its optimizer and the curves after an epoch, in place of the last ones.

    They make one folder, which gets its name in one step: a kill leaves it whole, or not there.
    """
    name = f"checkpoint-{len(curves):04d}"
    with replacing(folder / name) as unfinished:
        unfinished.mkdir()
        save_network(network, unfinished / NETWORK)
        write_json(unfinished / CURVES, {"epochs": [asdict(epoch) for epoch in curves]})
    drop_checkpoints(folder, keep=name)


def load_checkpoint(folder: Path) -> tuple[Any, list[Epoch]] | None:
    """Return the network and the curves after the last epoch that was saved, or None.

    Raises
    ------
    ArgumentError
        If they are damaged.
    """
    found = sorted(folder.glob("checkpoint-*"))
    if not found:
        return None
    curves = read_model_file(found[-1] / CURVES).get("epochs", [])
    return load_network(found[-1] / NETWORK, compiled=True), [Epoch(**epoch) for epoch in curves]


def drop_checkpoints(folder: Path, keep: str = "") -> None:
    """Remove the checkpoints of a training, but for the one of the given name."""
    for path in [*folder.glob("checkpoint-*"), *folder.glob(".writing-*checkpoint-*")]:
        if path.name != keep:
            shutil.rmtree(path)


def _versions() -> dict[str, str]:
    backend = import_keras().backend.backend()
    return {name: version(name) for name in PACKAGES} | {
        "backend": f"{backend} {import_module(backend).__version__}"
    }
