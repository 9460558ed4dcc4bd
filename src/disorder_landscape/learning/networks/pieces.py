"""What the networks beside the paper's have in common."""

from __future__ import annotations

from typing import Any

from disorder_landscape.learning.backend import import_keras

NODES = 500
"""Nodes of the dense layer before the output, as in the paper's network."""


def flat_bias(inputs: Any, places: tuple[int, ...], precision: str) -> Any:
    """Return the conductances of all V_bias side by side, shape (realization, *places, feature)."""
    bias, channels = inputs.shape[3:]
    return import_keras().layers.Reshape((*places, bias * channels), dtype=precision)(inputs)
