"""The paper's convolutional network, layer for layer (Fig. 1, S-II.2)."""

from __future__ import annotations

from typing import Any

from disorder_landscape.arguments import require
from disorder_landscape.learning.backend import import_keras

KERNELS_3D = ((5, 3), (3, 3, 3))
"""Edge of the kernel of each 3D convolution, set by set (S-II.2)."""
KERNELS_2D = (3, 3, 3, 3)
"""Edge of the kernel of each 2D convolution of the third set.

S-II.2 calls these "2D convolutional layers with kernel 3x3x3": read as 3x3, since V_bias is gone.
"""
DENSE = (500, 500)
"""Nodes of the dense layers before the output (S-II.2)."""
SMALLEST_GRID = {"mu": 8, "B": 8, "bias": 4}
"""Each max pooling halves an axis: three times μ and B, two times V_bias. One point must remain."""


def convolutional(inputs: Any, filters: list[int], precision: str) -> Any:
    """Return the features of the paper's network.

    Three sets of convolutions (3D, 3D, 2D), each followed by batch normalization and max pooling,
    then dense layers. All convolutions pad to the same size and end in a ReLU, as do the inner
    dense layers. What V_bias has left after two poolings (one point for the paper's five) is
    folded into the channels when the third set's 2D convolutions over (μ, B) begin.
    """
    for (axis, smallest), points in zip(SMALLEST_GRID.items(), inputs.shape[1:], strict=False):
        must = f"have at least {smallest} points of {axis}, for the network's poolings"
        require(points >= smallest, "grid", must, f"it has {points}")

    layers = import_keras().layers
    same = {"padding": "same", "activation": "relu", "dtype": precision}
    x = inputs
    for i, kernels in enumerate(KERNELS_3D):
        for j, kernel in enumerate(kernels):
            x = layers.Conv3D(filters[i], kernel, name=f"set{i + 1}_conv{j + 1}", **same)(x)
        x = layers.BatchNormalization(dtype=precision, name=f"set{i + 1}_norm")(x)
        x = layers.MaxPooling3D(2, dtype=precision, name=f"set{i + 1}_pool")(x)
    mu, B, bias, channels = x.shape[1:]
    x = layers.Reshape((mu, B, bias * channels), dtype=precision, name="to_2d")(x)
    for j, kernel in enumerate(KERNELS_2D):
        x = layers.Conv2D(filters[2], kernel, name=f"set3_conv{j + 1}", **same)(x)
    x = layers.BatchNormalization(dtype=precision, name="set3_norm")(x)
    x = layers.MaxPooling2D(2, dtype=precision, name="set3_pool")(x)
    x = layers.Flatten(dtype=precision, name="flatten")(x)
    for j, nodes in enumerate(DENSE):
        x = layers.Dense(nodes, activation="relu", dtype=precision, name=f"dense{j + 1}")(x)
    return x
