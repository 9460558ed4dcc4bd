"""Quick measurements of a shipped network, on the test realizations that are shipped with it."""

from __future__ import annotations

from functools import cache

import numpy as np
import xarray as xr

from disorder_landscape.arguments import require
from disorder_landscape.dataset.shards import VARIABLES
from disorder_landscape.dataset.store import read_dataset
from disorder_landscape.learning.curves import training_seconds
from disorder_landscape.learning.metrics import Scores, score
from disorder_landscape.learning.model import TrainedModel, load_model, load_model_config
from disorder_landscape.learning.prediction import predict
from disorder_landscape.learning.scaling import conductance_array, label_array
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.observables.conductance import conductance
from disorder_landscape.observables.topological_overlap import topological_points
from disorder_landscape.runs import NOISY, shipped_model, shipped_test_set
from disorder_landscape.studies.noise import CHANNELS_WITH_ERRORS, with_errors


def model_score(model: str, score: str, noise: float = 0.0, channels: str = "all") -> float:
    """Return a score of a network on its shipped test set.

    Parameters
    ----------
    model : str
        Folder in data_small/models; its test set is data_small/<model>_test.nc.
    score : {"r2", "delta_V", "delta_alpha"}
    noise : float
        Standard deviation in e²/h of a Gaussian error added to each conductance.
    channels : {"all", "local", "nonlocal"}
        Which conductances have the error.
    """
    return float(getattr(_scores(model, noise, channels), score))


def loss_by_noise(model: str, noise: float) -> float:
    """Return how much R² falls by a Gaussian error of the conductances in e²/h."""
    return _scores(model, 0.0, "all").r2 - _scores(model, noise, "all").r2


def conductance_match(model: str, channels: str, mean: str) -> float:
    """Return R² of the conductances of predicted wires against those of the wires themselves.

    Over all realizations and settings of the test set, of the worse of the channels.

    Parameters
    ----------
    model : str
        As in `model_score`.
    channels : {"local", "nonlocal", "all"}
    mean : {"predicted", "known"}
        The predicted potentials' mean: as predicted, zero where it is no label, or the true one.
    """
    test, _ = _loaded(model)
    simulated = _simulated(model, mean)
    return min(_r2(test[name], simulated[name]) for name in CHANNELS_WITH_ERRORS[channels])


def visibility_match(model: str, mean: str) -> float:
    """Return how well predicted wires are topological where the wires themselves are.

    The (μ, B) at which both are, over those at which either is (`topological_points`). Arguments as
    before.
    """
    config = _loaded(model)[1].config.dataset
    wires = _test_wires(model), _predicted_wires(model, mean)
    both, either = topological_points(*wires, config.mu_max, config.B_max)
    return both / either


def sets_and_training_hours(model: str) -> tuple[int, float]:
    """Return how many (realization, μ, B) a network's dataset has, and the hours of training."""
    folder = shipped_model(model)
    config = load_model_config(folder).dataset
    hours = training_seconds(folder / "curves.csv") / 3600
    return config.realizations * config.mu_points * config.B_points, hours


@cache
def _loaded(model: str) -> tuple[xr.Dataset, TrainedModel]:
    test = read_dataset(shipped_test_set(model.removesuffix(f"_{NOISY}")), VARIABLES)
    return test, load_model(shipped_model(model))


@cache
def _predicted(model: str, noise: float, channels: str) -> FloatArray:
    """Return the labels that the network says, shape (realization, label)."""
    test, network = _loaded(model)
    X = with_errors(conductance_array(test), noise, CHANNELS_WITH_ERRORS[channels])
    return network.predict_labels(X)


def _scores(model: str, noise: float, channels: str) -> Scores:
    test, network = _loaded(model)
    Y = label_array(test, network.labels.names)
    sites = network.config.dataset.sites
    return score(Y, _predicted(model, noise, channels), network.labels, sites)


@cache
def _simulated(model: str, mean: str) -> xr.Dataset:
    """Return the conductances of the predicted wires, at the settings of the test set."""
    config = _loaded(model)[1].config.dataset
    wires = _predicted_wires(model, mean)
    return conductance(wires, config.mu, config.B, config.bias, config.temperature)


def _test_wires(model: str) -> list[Nanowire]:
    test, network = _loaded(model)
    pairs = zip(test["potential"].to_numpy(), test["alpha"].to_numpy(), strict=True)
    return [network.config.dataset.wire.with_disorder(V, float(alpha)) for V, alpha in pairs]


def _predicted_wires(model: str, mean: str) -> list[Nanowire]:
    """Return the wires that the network says the test wires are."""
    test, network = _loaded(model)
    predicted = predict(network, test)
    V = predicted["potential"].to_numpy()
    true_mean = test["potential"].mean("site").to_numpy()
    means = {"predicted": V.mean(axis=1), "known": true_mean}
    require(mean in means, "mean", f"be one of {', '.join(means)}", f"it is '{mean}'")
    V += (means[mean] - V.mean(axis=1))[:, None]
    pairs = zip(V, predicted["alpha"].to_numpy(), strict=True)
    fixed = network.config.dataset.wire
    return [fixed.with_disorder(potential, float(alpha)) for potential, alpha in pairs]


def _r2(true: xr.DataArray, other: xr.DataArray) -> float:
    wrong = other.transpose(*true.dims).to_numpy() - true.to_numpy()
    return float(1 - np.mean(wrong**2) / np.var(true.to_numpy()))
