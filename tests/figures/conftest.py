"""A small evaluation, made without a network: predictions are the wires, slightly changed."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from disorder_landscape.config import Config
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.model.disorder import potential_from_components
from disorder_landscape.runs import preset_run

sys.path.insert(0, str(Path(__file__).parents[2] / "paper_figures"))  # as if run as scripts

WIRES = 6


@pytest.fixture(scope="session")
def config() -> Config:
    return preset_run("smoke").config


@pytest.fixture(scope="session")
def evaluation_file(config: Config, tmp_path_factory: pytest.TempPathFactory) -> Path:
    wires = [realization(config.dataset, i) for i in range(WIRES)]
    rng = np.random.default_rng(1)
    components = np.array([wire.components for wire in wires])
    alpha = np.array([wire.alpha for wire in wires])
    predicted = components + rng.normal(0.0, 0.1 * components.std(), components.shape)
    alpha_predicted = alpha + rng.normal(0.0, 0.1, WIRES)
    evaluation = xr.Dataset(
        {
            "components": (("realization", "component"), components),
            "components_predicted": (("realization", "component"), predicted),
            "alpha": ("realization", alpha),
            "alpha_predicted": ("realization", alpha_predicted),
            "potential": (("realization", "site"), np.array([wire.potential for wire in wires])),
            "potential_predicted": (
                ("realization", "site"),
                potential_from_components(predicted, config.dataset.sites),
            ),
        },
        coords={
            "realization": np.arange(WIRES) + 30,
            "component": np.arange(1, config.dataset.components + 1),
            "site": np.arange(config.dataset.sites),
        },
        attrs={"R2": 0.9, "delta_V": 0.1, "delta_alpha": float(np.std(alpha_predicted - alpha))},
    )
    path = tmp_path_factory.mktemp("evaluation") / "evaluation.nc"
    evaluation.to_netcdf(path, engine="h5netcdf")
    return path


@pytest.fixture(scope="session")
def evaluation(evaluation_file: Path) -> xr.Dataset:
    return xr.load_dataset(evaluation_file, engine="h5netcdf")
