"""One measurement: conductances and the settings K_full of S-II.1 at which they were taken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from disorder_landscape.arguments import ArgumentError, number_in, require
from disorder_landscape.physics.hamiltonian import FULL_TURN
from disorder_landscape.physics.labels import CONDUCTANCES
from disorder_landscape.physics.parameters import FloatArray

SETTINGS = ("theta", "barrier", "temperature")
"""Attributes that a measurement must have: in radians, in meV (left, right), in K."""


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


def measurement_of(dataset: xr.Dataset) -> Measurement:
    """Return a measurement of one wire, checked.

    Parameters
    ----------
    dataset : Dataset
        G_LL … G_RL in e²/h, dims (mu, B, bias) in any order, and the attributes SETTINGS, as
        `conductance` returns them.

    Raises
    ------
    ArgumentError
        If it lacks a variable, a dim or an attribute, has several wires, or holds NaN.
    """
    there = isinstance(dataset, xr.Dataset)
    require(there, "measurement", "be a Dataset", f"it is {type(dataset).__name__!r}")
    must = "hold the conductances of one wire over mu, B and bias"
    missing = [name for name in (*CONDUCTANCES, "mu", "B", "bias") if name not in dataset.variables]
    require(not missing, "measurement", must, f"it lacks {', '.join(missing)}")
    dims = sorted({str(dim) for name in CONDUCTANCES for dim in dataset[name].dims})
    require(dims == ["B", "bias", "mu"], "measurement", must, f"its dims are {', '.join(dims)}")
    missing = [name for name in SETTINGS if name not in dataset.attrs]
    states = f"state {', '.join(SETTINGS)} as attributes"
    require(not missing, "measurement", states, f"it lacks {', '.join(missing)}")
    G = np.stack([dataset[name].transpose("mu", "B", "bias") for name in CONDUCTANCES], axis=-1)
    finite = np.issubdtype(G.dtype, np.number) and bool(np.isfinite(G).all())
    require(finite, "measurement", "hold finite numbers", "it holds something else")
    return Measurement(
        G=np.asarray(G, dtype=np.float64),
        **{name: dataset[name].to_numpy() for name in ("mu", "B", "bias")},
        theta=number_in("theta", dataset.attrs["theta"], -FULL_TURN, FULL_TURN, "radians"),
        barrier=_two_barriers(dataset.attrs["barrier"]),
        temperature=number_in("temperature", dataset.attrs["temperature"], 0.0, 10.0, "K"),
    )


def _two_barriers(stated: object) -> tuple[float, float]:
    try:
        left, right = (float(value) for value in np.asarray(stated, dtype=np.float64))
    except (TypeError, ValueError):
        must = "state two barriers in meV, left and right"
        raise ArgumentError("measurement", must, f"it states {stated!r}") from None
    return left, right
