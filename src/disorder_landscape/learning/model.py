"""A trained network with everything it needs to be used, read from its folder and written."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import ValidationError

from disorder_landscape.arguments import ArgumentError, require, shown
from disorder_landscape.config import Config, DatasetConfig
from disorder_landscape.files import read_json, replacing, write_json
from disorder_landscape.learning.backend import import_keras
from disorder_landscape.learning.mirror import MirrorImages, mirrored_labels
from disorder_landscape.learning.model_files import CONFIG, METRICS, NETWORK, SCALER, is_trained
from disorder_landscape.learning.scaling import (
    ConductanceArray,
    Conductances,
    InputScaler,
    LabelScaler,
)
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.model.quantities import AXES

SAME_POINT = 1e-6
"""Two points of a grid are the same that are as near, in meV or T: room for float32 files."""

_MODEL = "be a folder written by `landscape train`"


@dataclass(frozen=True, eq=False)
class TrainedModel:
    """A network, its scalers, and the configuration that tells its grid and its labels."""

    network: Any
    labels: LabelScaler
    inputs: InputScaler | None
    """None where the network sees the conductance itself."""
    config: Config
    r2_by_label: Mapping[str, float] = field(default_factory=dict)
    """On the test realizations; empty before there are scores."""

    def predict_labels(self, X: Conductances) -> FloatArray:
        """Return the labels in meV and meV nm that the network predicts.

        With `config.training.mirror` it is the mean of what the network says about the wire and of
        what it says, mirrored back, about the wire's mirror image.

        Parameters
        ----------
        X : Conductances, shape (realization, mu, B, bias, channel)
            In e²/h, as `scaling.conductance_array` gives it.

        Returns
        -------
        array, shape (realization, label)
        """
        Y = self._predict(X)
        if self.config.training.mirror:
            other = self._predict(MirrorImages(X))
            Y = (Y + mirrored_labels(other, self.labels.components)) / 2
        return Y

    def scale_inputs(self, X: ConductanceArray) -> ConductanceArray:
        """Return what goes into the network for conductances in e²/h, shape as X."""
        return X if self.inputs is None else self.inputs.scale(X)

    def _predict(self, X: Conductances) -> FloatArray:
        batch = self.config.training.batch_size
        batches = (X[start : start + batch] for start in range(0, len(X), batch))
        y = [self.network.predict_on_batch(self.scale_inputs(one)) for one in batches]
        return self.labels.unscale(np.concatenate(y).astype(np.float64))

    def save(self, folder: Path) -> None:
        """Write network.keras, without the optimizer's state, and scaler.json."""
        write_json(folder / SCALER, self._scalers)
        network = import_keras().Model(self.network.inputs, self.network.outputs)  # not compiled
        save_network(network, folder / NETWORK)

    def fingerprint(self) -> bytes:
        """Return all that its predictions and its scores depend on."""
        said = self.config.model_dump(mode="json"), self._scalers, dict(self.r2_by_label)
        weights = (np.ascontiguousarray(layer).tobytes() for layer in self.network.get_weights())
        return json.dumps(said).encode() + b"".join(weights)

    @property
    def _scalers(self) -> dict[str, Any]:
        inputs = None if self.inputs is None else self.inputs.to_dict()
        return {"labels": self.labels.to_dict(), "inputs": inputs}


def points_of_grid(
    config: DatasetConfig, axes: Mapping[str, FloatArray], name: str
) -> tuple[NDArray[np.int64], ...]:
    """Return which points of mu, B and bias are those of a network's grid, in its order.

    Raises
    ------
    ArgumentError
        Of the given argument name, if one of the configuration's points is missing.
    """
    grids = {"mu": config.mu, "B": config.B, "bias": np.array(config.bias)}
    nearest, differ = [], []
    for axis in AXES:
        off = np.abs(axes.get(axis, np.empty(0))[None] - grids[axis][:, None])
        off = np.where(off <= SAME_POINT, off, np.inf)
        if np.isinf(off).all(axis=1).any():
            differ.append(axis)
        else:
            nearest.append(off.argmin(axis=1))
    must = "hold the grid the network was trained on (" + ", ".join(
        f"{axis}: {len(grids[axis])} points from {grids[axis][0]:g} to {grids[axis][-1]:g}"
        for axis in AXES
    )
    require(not differ, name, must + ")", f"it differs in {', '.join(differ)}")
    return tuple(nearest)


def on_grid_of(config: DatasetConfig, G: xr.Dataset, name: str = "G") -> xr.Dataset:
    """Return what a network sees of conductances: those on its grid, of maybe more points.

    Raises
    ------
    ArgumentError
        As `points_of_grid`.
    """
    require(isinstance(G, xr.Dataset), name, "be a Dataset", f"it is {type(G).__name__!r}")
    axes = {
        axis: G[axis].to_numpy()
        for axis in AXES
        if axis in G.coords and G[axis].dims == (axis,) and G[axis].dtype.kind in "fiu"
    }
    points = dict(zip(AXES, points_of_grid(config, axes, name), strict=True))
    same = all(np.array_equal(points[axis], np.arange(G.sizes[axis])) for axis in AXES)
    return G if same else G.isel(points)


def existing_folder(folder: str | Path) -> Path:
    """Return the folder of a model.

    Raises
    ------
    ArgumentError
        If it is none.
    """
    is_folder = isinstance(folder, str | Path) and os.path.isdir(folder)
    require(is_folder, "model", _MODEL, f"there is no folder {shown(str(folder))}")
    folder = Path(folder)
    inside = sorted(folder.glob(f"*/{CONFIG}"))
    if inside and not (folder / CONFIG).exists():
        but = (
            f"there is no model in {shown(str(folder))}, but one in {shown(str(inside[0].parent))}"
        )
        raise ArgumentError("model", _MODEL, but)
    return folder


def load_model(folder: str | Path) -> TrainedModel:
    """Read a trained model from its folder, with Keras' safe mode.

    Raises
    ------
    ArgumentError
        If the folder is not one of a finished training, or a file in it is damaged.
    """
    folder = existing_folder(folder)
    require(is_trained(folder), "model", _MODEL, f"the training in '{folder}' is not finished")
    config = load_model_config(folder)
    scaler = read_model_file(folder / SCALER)
    try:
        labels = LabelScaler.from_dict(scaler["labels"])
        inputs = None if scaler["inputs"] is None else InputScaler.from_dict(scaler["inputs"])
    except (KeyError, TypeError, ValueError) as error:
        raise ArgumentError("model", _MODEL, f"'{folder / SCALER}' lacks {error}") from None
    scores = read_model_file(folder / METRICS).get("r2_by_label", {})
    return TrainedModel(load_network(folder / NETWORK), labels, inputs, config, scores)


def read_model_file(path: Path) -> dict[str, Any]:
    """Read a JSON file of a model's folder.

    Raises
    ------
    ArgumentError
        If it cannot be read or holds no JSON object.
    """
    return read_json(path, "model", _MODEL)


def load_model_config(folder: Path) -> Config:
    """Read the configuration a model was trained with from its folder."""
    content: Mapping[str, Any] = read_model_file(folder / CONFIG)
    try:
        return Config.model_validate(content.get("config"))
    except ValidationError as error:
        wrong = ".".join(str(part) for part in error.errors()[0]["loc"]) or "config"
        but = f"'{folder / CONFIG}' has no valid {wrong}"
        raise ArgumentError("model", _MODEL, but) from None


def save_network(network: Any, path: Path) -> None:
    """Write a Keras network; if it is compiled, with its optimizer and its state."""
    with replacing(path) as temporary:
        network.save(temporary)


def load_network(path: Path, compiled: bool = False) -> Any:
    """Read a Keras network in safe mode; compiled means with its optimizer and its state."""
    try:
        return import_keras().saving.load_model(path, compile=compiled, safe_mode=True)
    except (OSError, ValueError, KeyError, BadZipFile) as error:
        but = f"'{path}' cannot be read: {str(error).splitlines()[0]}"
        raise ArgumentError("model", _MODEL, but) from None
