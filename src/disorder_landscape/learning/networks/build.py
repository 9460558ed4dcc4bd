"""Build the network that a configuration names."""

from __future__ import annotations

from typing import Any

from disorder_landscape.learning.backend import import_keras
from disorder_landscape.learning.networks.convolutional import convolutional
from disorder_landscape.learning.networks.recurrent import recurrent
from disorder_landscape.learning.networks.residual import residual

FILTERS = (256, 512, 1028)
"""Filters of the convolutions of each set, at the paper's width (Fig. 1)."""


def build_network(
    input_shape: tuple[int, ...],
    outputs: int,
    width_fraction: float = 1.0,
    learning_rate: float = 1e-4,
    precision: str = "float32",
    architecture: str = "convolutional",
    weight_decay: float = 0.0,
) -> Any:
    """Return the compiled network: its optimizer and the mean squared error of scaled labels.

    Parameters
    ----------
    input_shape : (mu, B, bias, channel)
        Shape of one realization, as `scaling.conductance_array` gives it.
    outputs : int
        Number of labels Y.
    width_fraction : float
        Multiplies the filters of every convolution (Fig. S2).
    learning_rate : float
        Of Adam.
    precision : str
        A Keras dtype policy: "float32" or "mixed_bfloat16". The output layer stays in float32.
    architecture : {"convolutional", "residual", "recurrent"}
        The paper's network, one that it does not try, or the one that it tried first.
    weight_decay : float
        Of AdamW; 0 is Adam, as in the paper.

    Returns
    -------
    keras.Model
        Maps (realization, mu, B, bias, channel) to (realization, outputs).

    Raises
    ------
    ArgumentError
        If the grid is too small for three poolings.
    """
    keras = import_keras()
    filters = [max(1, round(width_fraction * f)) for f in FILTERS]
    inputs = keras.Input(input_shape, name="conductance")
    layers_of = {
        "convolutional": convolutional,
        "residual": residual,
        "recurrent": recurrent,
    }[architecture]
    features = layers_of(inputs, filters, precision)
    labels = keras.layers.Dense(outputs, dtype="float32", name="labels")(features)
    network = keras.Model(inputs, labels, name="disorder_landscape")
    # Keras decouples the decay from the gradient, which makes this AdamW.
    optimizer = keras.optimizers.Adam(learning_rate, weight_decay=weight_decay or None)
    network.compile(optimizer, loss="mean_squared_error")
    return network
