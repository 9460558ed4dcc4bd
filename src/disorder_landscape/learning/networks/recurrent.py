"""The recurrent network that the paper tried first (S-II.2)."""

from __future__ import annotations

from typing import Any

from disorder_landscape.learning.backend import import_keras
from disorder_landscape.learning.networks.pieces import NODES, flat_bias


def recurrent(inputs: Any, filters: list[int], precision: str) -> Any:
    """Return the features of a recurrent network over the measurements.

    Each step sees one (μ, B) and its conductances at all V_bias ("each input step consists of a
    measurement operation", a row of X and of K). K is the same for all wires, so that it enters as
    a bias of each step, which is learnt. Two layers of long short-term memory, of as many units as
    the first set of convolutions has filters, then a dense layer.

    Parameters
    ----------
    inputs : Keras tensor, shape (realization, mu, B, bias, channel)
    filters : list of int
        The first is the number of units.
    precision : str
        A Keras dtype policy.

    Returns
    -------
    Keras tensor, shape (realization, feature)
    """
    layers = import_keras().layers
    mu, B, _, _ = inputs.shape[1:]
    x = flat_bias(inputs, (mu * B,), precision)
    x = layers.EinsumDense(
        "rsx,xf->rsf", (mu * B, filters[0]), bias_axes="sf", dtype=precision, name="measurement"
    )(x)
    x = layers.LSTM(filters[0], return_sequences=True, dtype=precision)(x)
    x = layers.LSTM(filters[0], dtype=precision)(x)
    return layers.Dense(NODES, activation="relu", dtype=precision)(x)
