"""What `infer` is given: a measurement, and a prior or a model that says what is known of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from disorder_landscape.arguments import ArgumentError, require, shown
from disorder_landscape.config import DatasetConfig
from disorder_landscape.inference.problem.measured_dataset import measurement_of
from disorder_landscape.inference.problem.measured_numbers import check_carried
from disorder_landscape.inference.problem.measurement import PAPERS_SETTINGS, settings_of
from disorder_landscape.inference.problem.noise import noise_of_channels, stated_noise
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.search.first_guess import on_grid_of_network
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


def network_given(
    observation: Observation, prior: Prior | Model, network: bool | Model | None
) -> tuple[Model | None, str]:
    """Return the model whose network guesses, if any, and the words for where attempts start.

    Raises
    ------
    ArgumentError
        As in `infer`.
    """
    model: Model
    if network is None or isinstance(network, bool | np.bool_):
        must = "be a trained model, where there is a prior instead of one"
        has_one = not isinstance(prior, Prior)
        require(has_one or not network, "network", must, "it is True")
        if isinstance(prior, Prior) or (network is not None and not network):
            return None, "the prior"
        model = prior
    else:
        model = network
    config, sites = config_of(model), observation.unknowns.prior.sites
    must = f"be of wires of {sites} sites, as the prior is"
    require(config.sites == sites, "network", must, f"it is of {config.sites}")
    lacks = bool(np.isin(config.bias, observation.measurement.left_out).any())
    if lacks or not _on_grid_of_network(config, observation).is_measured.all():
        why = "because the network needs all conductances of its grid and some are missing"
        return None, f"the prior, {why}"
    must = "be none where V of every site is unknown"
    require(not observation.unknowns.is_whole_landscape, "network", must, "there is one")
    return model, "the network's guess"


def _on_grid_of_network(config: DatasetConfig, observation: Observation) -> Observation:
    """Return what is on the network's grid, or say how to do without the network."""
    try:
        return on_grid_of_network(config, observation)
    except ArgumentError as error:
        name, must, but = error.parts
        without = "(network=False, or --from-prior, does without the network)"
        raise ArgumentError(name, must, f"{but} {without}") from None
