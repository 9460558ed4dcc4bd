"""Networks to compare with the paper's: the one it tried first, and one that it does not try."""

from __future__ import annotations

from typing import Any

from disorder_landscape.learning.backend import import_keras

BLOCKS = 2
"""Residual blocks in each of the two sets."""
PATCH = 2
"""Points of μ and of B that the first convolution takes at a time."""
NODES = 500
"""Nodes of the dense layer before the output, as in the paper's network."""


def residual(inputs: Any, filters: list[int], precision: str) -> Any:
    """Return the features of a residual network over the (μ, B) plane.

    The conductances of all V_bias are channels of one image, and the first convolution takes 2×2
    points of it at a time, which makes all others four times cheaper. Two sets of residual blocks
    (He et al., CVPR 2016: two 3×3 convolutions each, added to what goes in), the second at half
    the resolution, then a dense layer that sees every point of what is left.

    Parameters
    ----------
    inputs : Keras tensor, shape (realization, mu, B, bias, channel)
    filters : list of int
        The first two are those of the convolutions of each set.
    precision : str
        A Keras dtype policy.

    Returns
    -------
    Keras tensor, shape (realization, feature)
    """
    layers = import_keras().layers
    mu, B, _, _ = inputs.shape[1:]
    x = _flat_bias(inputs, (mu, B), precision)
    x = _relu(_normalised(x, filters[0], precision, kernel=PATCH, stride=PATCH), precision)
    for i, count in enumerate(filters[:2]):
        for j in range(BLOCKS):
            stride = 2 if i > 0 and j == 0 else 1
            inner = _relu(_normalised(x, count, precision, stride=stride), precision)
            inner = _normalised(inner, count, precision)
            if stride > 1:
                x = layers.AveragePooling2D(stride, padding="same", dtype=precision)(x)
            if x.shape[-1] != count:
                x = layers.Conv2D(count, 1, use_bias=False, dtype=precision)(x)
            x = _relu(layers.Add(dtype=precision)([x, inner]), precision)
    x = layers.Flatten(dtype=precision)(x)
    return layers.Dense(NODES, activation="relu", dtype=precision)(x)


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
    x = _flat_bias(inputs, (mu * B,), precision)
    x = layers.EinsumDense(
        "rsx,xf->rsf", (mu * B, filters[0]), bias_axes="sf", dtype=precision, name="measurement"
    )(x)
    x = layers.LSTM(filters[0], return_sequences=True, dtype=precision)(x)
    x = layers.LSTM(filters[0], dtype=precision)(x)
    return layers.Dense(NODES, activation="relu", dtype=precision)(x)


def _flat_bias(inputs: Any, places: tuple[int, ...], precision: str) -> Any:
    """Return the conductances of all V_bias side by side, shape (realization, *places, feature)."""
    bias, channels = inputs.shape[3:]
    return import_keras().layers.Reshape((*places, bias * channels), dtype=precision)(inputs)


def _normalised(x: Any, filters: int, precision: str, kernel: int = 3, stride: int = 1) -> Any:
    """Return a convolution, normalised over the batch."""
    layers = import_keras().layers
    x = layers.Conv2D(
        filters,
        kernel,
        stride,
        padding="same",
        use_bias=False,
        kernel_initializer="he_normal",
        dtype=precision,
    )(x)
    return layers.BatchNormalization(dtype=precision)(x)


def _relu(x: Any, precision: str) -> Any:
    return import_keras().layers.Activation("relu", dtype=precision)(x)
