"""Several networks whose predictions are averaged: one model, which is used like any other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from disorder_landscape.config import Config
from disorder_landscape.learning.backend import import_keras
from disorder_landscape.learning.curves import Epoch, read_curves
from disorder_landscape.learning.model import TrainedModel, load_model


def member_configs(config: Config) -> list[Config]:
    """Return the configuration of each of `training.networks`, which differ in their seeds."""
    training = config.training
    return [
        config.model_copy(
            update={
                "training": training.model_copy(update={"networks": 1, "seed": training.seed + i})
            }
        )
        for i in range(training.networks)
    ]


def combine(folders: Sequence[Path], config: Config) -> tuple[TrainedModel, list[Epoch]]:
    """Return the mean of trained networks as one model, and their curves one after the other.

    Parameters
    ----------
    folders : sequence of path
        Of networks trained on the same data, so that their scalers are the same.
    config : Config
        Of the whole.
    """
    members = [load_model(folder) for folder in folders]
    curves = [epoch for folder in folders for epoch in read_curves(folder / "curves.csv")]
    numbered = [replace(epoch, epoch=i) for i, epoch in enumerate(curves, start=1)]
    network = _mean([member.network for member in members])
    return TrainedModel(network, members[0].labels, members[0].inputs, config), numbered


def _mean(networks: Sequence[Any]) -> Any:
    """Return a Keras model of the networks' mean output."""
    keras = import_keras()
    for i, network in enumerate(networks):
        network.name = f"network_{i + 1}"
    inputs = keras.Input(networks[0].inputs[0].shape[1:], name="conductance")
    outputs = [network([inputs])[0] for network in networks]  # as saved, they take and give lists
    mean = keras.layers.Average(name="labels")(outputs)
    return keras.Model(inputs, mean, name="disorder_landscape")
