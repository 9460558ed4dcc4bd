"""A dataset that a tiny network can learn in seconds, and one trained on it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from disorder_landscape.config import Config
from disorder_landscape.learning.mirror import mirrored_labels
from disorder_landscape.learning.training import train
from disorder_landscape.physics.disorder import potential_from_components


def tiny_config(**training: Any) -> Config:
    return Config.model_validate(
        {
            "dataset": {"realizations": 400, "sites": 60, "mu_points": 8, "B_points": 8},
            "network": {"width_fraction": 0.06},
            "training": {
                "epochs": (8, 2),
                "learning_rate": 1e-3,
                "batch_size": 8,
                "compress_inputs": True,
                "mirror": True,
                **training,
            },
        }
    )


def synthetic_dataset(config: Config) -> xr.Dataset:
    """Conductances that are a smooth, invertible, mirror-symmetric function of the labels."""
    d = config.dataset
    rng = np.random.default_rng(7)
    components = rng.normal(0, 0.2, (d.realizations, d.components))
    alpha = rng.uniform(*d.alpha_range, d.realizations)
    Y = np.column_stack([components, 5 * (alpha - 8)])
    mu, B, bias = np.meshgrid(d.mu, d.B, np.array(d.bias), indexing="ij")
    waves = [np.cos(n * mu / 0.2 + B / 0.3 + 10 * bias + n) for n in range(Y.shape[1])]
    shapes = np.array(waves)  # (label, mu, B, bias)

    def G(Y: np.ndarray, scale: float, offset: float) -> xr.Variable:
        field = np.tensordot(Y, shapes, axes=1)  # (realization, mu, B, bias)
        dims = ("realization", "mu", "B", "bias")
        return xr.Variable(dims, (scale * (np.tanh(field) + offset)).astype(np.float32))

    Y_mirrored = mirrored_labels(Y, d.components)
    return xr.Dataset(
        {
            "G_LL": G(Y, 0.5, 1.0),
            "G_RR": G(Y_mirrored, 0.5, 1.0),
            "G_LR": G(Y**2 - Y, 0.005, 0.0),
            "G_RL": G(Y_mirrored**2 - Y_mirrored, 0.005, 0.0),
            "components": (("realization", "component"), components),
            "alpha": ("realization", alpha),
            "potential": (("realization", "site"), potential_from_components(components, d.sites)),
        },
        coords={"mu": d.mu, "B": d.B, "bias": np.array(d.bias)},
        attrs={"config_hash": d.hash, "command": "tests"},
    )


@pytest.fixture(scope="session")
def config() -> Config:
    return tiny_config()


@pytest.fixture(scope="session")
def dataset(config: Config) -> xr.Dataset:
    return synthetic_dataset(config)


@pytest.fixture(scope="session")
def trained(config: Config, dataset: xr.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("models") / "tiny"
    train(dataset, config, folder, command="tests", progress=False)
    return folder
