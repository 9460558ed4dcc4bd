"""One measurement: conductances and the settings K_full of S-II.1 at which they were taken."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.config import DatasetConfig
from disorder_landscape.model.parameters import TEMPERATURE, FloatArray, Nanowire
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.observables.conductance import conductance

PAPERS_SETTINGS = {"theta": 0.0, "barrier": Nanowire.barrier, "temperature": TEMPERATURE}
"""Where neither the prior nor the measurement says anything."""


@dataclass(frozen=True, eq=False)
class Measurement:
    """Conductances of one wire on a grid of μ, B and bias."""

    G: FloatArray
    """Shape (mu, B, bias, 4): G_LL, G_RR, G_LR, G_RL in e²/h."""
    mu: FloatArray
    B: FloatArray
    bias: FloatArray
    theta: float
    """In radians."""
    barrier: tuple[float, float]
    """Left and right, in meV."""
    temperature: float
    """In K."""
    axis: str = "mu"
    """What the first axis is: μ in meV, or "gate", a voltage in any unit."""
    stated: Mapping[str, float] = field(default_factory=dict)
    """What it says of the device: parameters by name, barriers each by its own."""
    left_out: FloatArray = field(default_factory=lambda: np.empty(0))
    """Biases at which nothing was measured."""
    gate_unit: str = ""
    """As it is stated, if so."""

    @property
    def has_channel(self) -> NDArray[np.bool_]:
        """Which channels hold a number, shape (channel,)."""
        return np.asarray(np.isfinite(self.G).any(axis=(0, 1, 2)))

    @property
    def settings(self) -> dict[str, float]:
        """Temperature and barriers by name, as stated or as usual."""
        left, right = self.barrier
        return {"temperature": self.temperature, "barrier_left": left, "barrier_right": right}

    @property
    def stated_settings(self) -> dict[str, float]:
        """Those of them that are stated."""
        return {name: self.stated[name] for name in self.settings if name in self.stated}


def settings_of(config: DatasetConfig) -> dict[str, Any]:
    """Return the SETTINGS at which a dataset is simulated."""
    barriers = (config.wire.barrier, config.wire.barrier)
    return {"theta": 0.0, "barrier": barriers, "temperature": config.temperature}


def empty_measurement(config: DatasetConfig) -> Measurement:
    """Return a measurement on a dataset's grid and at its settings, all conductances zero."""
    G = np.zeros((config.mu_points, config.B_points, len(config.bias), len(CONDUCTANCES)))
    return Measurement(G, config.mu, config.B, np.array(config.bias), **settings_of(config))


def simulated(wires: Nanowire | Sequence[Nanowire], at: Measurement) -> FloatArray:
    """Return the conductances of wires, with their own barriers, at a measurement's other settings.

    Returns
    -------
    array, shape ([wire,] mu, B, bias, channel)
        In e²/h.
    """
    G = conductance(wires, at.mu, at.B, at.bias, at.temperature, theta=at.theta)
    return np.stack([G[name].to_numpy() for name in CONDUCTANCES], axis=-1)
