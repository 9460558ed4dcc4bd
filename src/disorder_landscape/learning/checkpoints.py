"""Where a training stands: saved after each epoch, so that an interrupted one goes on."""

from __future__ import annotations

import shutil
from dataclasses import asdict
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
    CONFIG,
    NETWORK,
    load_network,
    read_model_file,
    save_network,
)

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
    """Return the network and the curves after the last finished epoch, or None.

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
