"""Wires with wrong disorder, the controls of a verification."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from disorder_landscape.arguments import require
from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset.realizations import drawn
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.model.parameters import Nanowire


def disorder_model(
    prediction: xr.Dataset, predicted: Nanowire, config: DatasetConfig | None
) -> DatasetConfig:
    """Return the disorder model that the prediction was made with."""
    if config is None:
        components = prediction.sizes.get("component", 0)
        must = "hold the components, which define the disorder model"
        require(components > 0, "prediction", must, "it lacks them")
        but = f"it has {components}, and {predicted.sites} sites"
        require(components < predicted.sites, "prediction", "have fewer components than sites", but)
        return DatasetConfig(realizations=1, sites=predicted.sites, components=components)
    must = "come from the model that is given"
    made_by = prediction.attrs.get("config_hash", config.hash)
    require(made_by == config.hash, "prediction", must, "it comes from another dataset's")
    require(predicted.sites == config.sites, "prediction", must, f"it has {predicted.sites} sites")
    return config


def wires_like(wire: Nanowire, prior: Prior, count: int, seed: int = 0) -> list[Nanowire]:
    """Return wires with random disorder and α of a prior, which are like this one in all else."""
    unknowns, rng = Unknowns(prior), np.random.default_rng([seed, 3])
    X = unknowns.white_noise.draw_apart(rng, count)
    both = zip(unknowns.potential(X), unknowns.parameter("alpha", X), strict=True)
    return [replace(wire, potential=V, alpha=float(alpha)) for V, alpha in both]


def control_wires(config: DatasetConfig, count: int, seed: int = 0) -> list[Nanowire]:
    """Return wires with random disorder of a model, which are realizations of no dataset."""
    rngs = (np.random.default_rng([seed, index, 1]) for index in range(count))  # others have two
    return [drawn(config, rng).wire for rng in rngs]
