"""What `infer` is given: a measurement, and a prior or a model that says what is known of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import xarray as xr

from disorder_landscape.arguments import require, shown
from disorder_landscape.config import DatasetConfig
from disorder_landscape.inference.problem.measured_dataset import measurement_of
from disorder_landscape.inference.problem.measured_numbers import check_carried
from disorder_landscape.inference.problem.measurement import PAPERS_SETTINGS, settings_of
from disorder_landscape.inference.problem.noise import noise_of_channels, stated_noise
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.learning.model import TrainedModel, existing_folder, load_model_config

TOML = ".toml"
"""Ending of a prior's file."""
Model = str | Path | TrainedModel


def prior_given(given: Prior | Model) -> Prior | Model:
    """Return the prior that a file says, where one is given."""
    is_file = isinstance(given, str | Path) and Path(given).suffix == TOML
    return Prior.from_toml(given) if is_file else given  # type: ignore[arg-type]


def config_of(model: Model) -> DatasetConfig:
    """Return the configuration of a model's dataset."""
    if isinstance(model, TrainedModel):
        return model.config.dataset
    is_path = isinstance(model, str | Path)
    must = "be a Prior, its file (.toml), or the folder of a trained model"
    require(is_path, "prior", must, f"it is {shown(model)}")
    return load_model_config(existing_folder(model)).dataset


def observation_of(
    G: xr.Dataset,
    prior: Prior | Model | DatasetConfig,
    noise: float | Mapping[str, float] | None = None,
) -> Observation:
    """Return what was measured of a wire, with what is unknown of it.

    Parameters
    ----------
    G : Dataset
    prior : Prior, path, TrainedModel or DatasetConfig
        What is known, or a model or the configuration of its dataset, which says so.
    noise : float or mapping, optional
        All as in `infer`.

    Raises
    ------
    ArgumentError
        As in `infer`.
    """
    prior = prior if isinstance(prior, DatasetConfig) else prior_given(prior)
    if isinstance(prior, Prior):
        usual, known = PAPERS_SETTINGS, prior
    else:
        config = prior if isinstance(prior, DatasetConfig) else config_of(prior)
        usual, known = settings_of(config), Prior.of_dataset(config)
    measurement = measurement_of(G, usual)
    errors = noise_of_channels(stated_noise(G.attrs) if noise is None else noise, G)
    check_carried(measurement, errors)
    return Observation(measurement, Unknowns(known.for_measurement(measurement)), errors)
