"""Conductances that a tiny network learns in seconds: a smooth, invertible function of Y."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from disorder_landscape.config import Config
from disorder_landscape.learning.mirror import mirrored_labels
from disorder_landscape.model.disorder import potential_from_components


def tiny_config(realizations: int = 400, width_fraction: float = 0.03, **training: Any) -> Config:
    return Config.model_validate(
        {
            "dataset": {
                "realizations": realizations,
                "sites": 60,
                "mu_points": 8,
                "B_points": 8,
            },
            "network": {"width_fraction": width_fraction},
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
    """Return a dataset with the wire's mirror symmetry, all of it described by the labels."""
    d = config.dataset
    rng = np.random.default_rng(7)
    components = rng.normal(0, 0.2, (d.realizations, d.components))
    alpha = rng.uniform(*d.alpha_range, d.realizations)
    Y = np.column_stack([components, (alpha - 8) / 5])
    Y_mirrored = mirrored_labels(Y, d.components)
    mu, B, bias = np.meshgrid(d.mu, d.B, np.array(d.bias), indexing="ij")
    waves = [np.cos(n * mu / 0.2 + B / 0.3 + 10 * bias + n) for n in range(Y.shape[1])]
    shapes = np.array(waves)  # (label, mu, B, bias)

    def local(Y: np.ndarray) -> xr.Variable:
        return _variable(0.5 + 0.5 * np.tanh(np.tensordot(Y, shapes, axes=1)))

    def nonlocal_(Y: np.ndarray) -> xr.Variable:
        return _variable(0.005 * np.tanh(np.tensordot(Y**2 - Y, shapes, axes=1)))

    return xr.Dataset(
        {
            "G_LL": local(Y),
            "G_RR": local(Y_mirrored),
            "G_LR": nonlocal_(Y),
            "G_RL": nonlocal_(Y_mirrored),
            "components": (("realization", "component"), components),
            "alpha": ("realization", alpha),
            "potential": (("realization", "site"), potential_from_components(components, d.sites)),
        },
        coords={"mu": d.mu, "B": d.B, "bias": np.array(d.bias)},
        attrs={"config_hash": d.hash, "command": "tests"},
    )


def _variable(G: np.ndarray) -> xr.Variable:
    return xr.Variable(("realization", "mu", "B", "bias"), G.astype(np.float32))
