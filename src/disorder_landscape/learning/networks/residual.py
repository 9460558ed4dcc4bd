"""A residual network, which the paper does not try; the presets use it."""

from __future__ import annotations

from typing import Any

from disorder_landscape.learning.backend import import_keras
from disorder_landscape.learning.networks.pieces import NODES, flat_bias

BLOCKS = 2
"""Residual blocks in each of the two sets."""
PATCH = 2
"""Points of μ and of B that the first convolution takes at a time."""


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
    x = flat_bias(inputs, (mu, B), precision)
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
