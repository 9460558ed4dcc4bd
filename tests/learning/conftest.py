from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr

from disorder_landscape.config import Config
from disorder_landscape.learning.training import train
from synthetic import synthetic_dataset, tiny_config


@pytest.fixture(scope="session")
def config() -> Config:
    return tiny_config()


@pytest.fixture(scope="session")
def dataset(config: Config) -> xr.Dataset:
    return synthetic_dataset(config)


@pytest.fixture(scope="session")
def trained(config: Config, dataset: xr.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a network trained on the synthetic dataset."""
    folder = tmp_path_factory.mktemp("models") / "tiny"
    train(dataset, config, folder, command="tests", progress=False)
    return folder
