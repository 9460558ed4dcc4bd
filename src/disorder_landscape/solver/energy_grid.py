"""Finite temperature: the T = 0 conductance convolved with −df/dω (S-I), on an energy grid.

G(V) = ∫ dω G₀(ω) (1/4kT) sech²((ω − V)/2kT). The grid holds ±ω_k, ω_k = (k + ½)h; each node stands
for the cell around it, whose weight is the exact integral of the kernel over the cell, divided by
the sum of all weights so that a constant G₀ stays what it is.
"""

from __future__ import annotations

import numpy as np
from scipy.special import expit

from disorder_landscape.arguments import require
from disorder_landscape.model.parameters import BOLTZMANN, FloatArray

ENERGY_SPACING = 0.5e-3
"""Default h in meV."""
THERMAL_REACH = 10.0
"""The grid reaches this many kT beyond the largest |V|, where 5e-5 of the kernel is cut."""


def thermal_grid(
    bias: FloatArray, temperature: float, delta0: float, spacing: float = ENERGY_SPACING
) -> tuple[FloatArray, FloatArray]:
    """Return the energies ω_k > 0 to solve at and the weights of G₀(±ω_k).

    Parameters
    ----------
    bias : array, shape (bias,)
        V in meV.
    temperature : float
        T > 0 in K.
    delta0 : float
        Gap of the parent superconductor in meV, which the grid must not reach.
    spacing : float
        Largest h in meV.

    Returns
    -------
    omega : array, shape (omega,)
        In meV.
    weights : array, shape (bias, omega, 2)
        The last axis is the sign of ω: +, −.

    Raises
    ------
    ArgumentError
        If the thermal window around the biases reaches the gap.
    """
    kT = BOLTZMANN * temperature
    window = abs(bias).max() + THERMAL_REACH * kT
    require(
        window < delta0,
        "temperature",
        f"keep |bias| + {THERMAL_REACH:g} kT below the gap of {delta0:g} meV",
        f"with {temperature:g} K and a bias of {abs(bias).max():g} meV it is {window:.3g} meV",
    )
    edges = np.linspace(0.0, window, int(np.ceil(window / spacing)) + 1)
    omega = (edges[1:] + edges[:-1]) / 2
    positive = np.diff(expit((edges - bias[:, None]) / kT), axis=1)
    negative = np.diff(expit((edges + bias[:, None]) / kT), axis=1)
    weights = np.stack([positive, negative], axis=-1)
    return omega, weights / weights.sum(axis=(1, 2), keepdims=True)
