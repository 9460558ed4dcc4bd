"""Where an inversion starts: the network's guess, with the error that it makes at this noise."""

from __future__ import annotations

import numpy as np

from disorder_landscape.config import DatasetConfig
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.learning.model import TrainedModel, points_of_grid
from disorder_landscape.model.parameters import FloatArray

WIRES_OF_THE_ERROR = 4
"""For each unknown, on which the network's error is measured."""
LOCAL = 2.0
"""They are drawn about the guess, with this many times the network's error without noise."""
WIDENING = 1.2
"""Factor on the measured standard deviations, since they are those of few wires."""


def network_labels(model: TrainedModel, unknowns: Unknowns, G: FloatArray) -> FloatArray:
    """Return the network's labels as unknowns, (sample, unknown), for G (sample, …, channel)."""
    Y = model.predict_labels(G.astype(np.float32))
    return unknowns.vector(dict(zip(model.labels.names, Y.T, strict=True)))


def network_guess(
    model: TrainedModel, observation: Observation, rng: np.random.Generator
) -> Gaussian:
    """Return what the network predicts from a measurement, less its bias, with its error.

    Both are measured. Wires like the guess are simulated, given errors of the stated noise, and
    predicted by the network. So the error is that of this network for such wires at this noise. A
    measurement may have more points than the network's grid; those on the grid are used.
    """
    observation = on_grid_of_network(model.config.dataset, observation)
    unknowns = observation.unknowns
    guess = network_labels(model, unknowns, observation.measurement.G[None])[0]
    per_label = np.linalg.inv(unknowns.label_slopes(guess))
    error = np.sqrt((per_label**2) @ _error_without_noise(model, unknowns) ** 2)
    X = Gaussian(guess, LOCAL**2 * np.diag(error**2)).draw(
        rng, WIRES_OF_THE_ERROR * len(unknowns.names)
    )
    G = observation.conductances(X)
    off = network_labels(model, unknowns, G + observation.noise * rng.normal(size=G.shape)) - X
    predicted = np.array([name in model.labels.names for name in unknowns.names])
    off[:, ~predicted] = 0.0
    least = np.where(predicted, error / 10, error)
    covariance = WIDENING**2 * np.cov(off.T) + np.diag(least**2)
    return Gaussian(guess - off.mean(axis=0), covariance)


def on_grid_of_network(config: DatasetConfig, observation: Observation) -> Observation:
    """Return the part of an observation that is on the grid of a network's dataset."""
    return observation.at(*points_of_grid(config, vars(observation.measurement), "measurement"))


def _error_without_noise(model: TrainedModel, unknowns: Unknowns) -> FloatArray:
    """Return the network's errors on its test realizations, the prior's without them (label,)."""
    error = dict(zip(unknowns.names, unknowns.label_std, strict=True))
    for name, std in zip(model.labels.names, model.labels.std, strict=True):
        if name in model.r2_by_label:
            error[name] = std * np.sqrt(1 - model.r2_by_label[name])
    return np.array([error[name] for name in unknowns.names])
