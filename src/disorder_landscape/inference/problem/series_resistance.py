"""Resistances in series with the leads: what a cryostat's lines and filters do to conductances.

A part of each voltage drops there. So does a part of what the current of one lead is driven by: the
current that one end's voltage drives through the other line lowers the voltage at that other end.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from disorder_landscape.arguments import number_in, require
from disorder_landscape.inference.problem.measured_dataset import measurement_of, with_axes
from disorder_landscape.inference.problem.measured_numbers import QUANTUM
from disorder_landscape.inference.problem.measurement import PAPERS_SETTINGS
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.model.quantities import CONDUCTANCES

LARGEST_RESISTANCE = 1e6
"""In Ω."""


def without_series_resistance(measured: xr.Dataset, left: float, right: float) -> xr.Dataset:
    """Return what a wire itself conducts, of conductances that were measured through resistances.

    Changes of the voltages are divided as Kirchhoff's laws say, all four conductances together:
    M = M' / (1 − R M'), where M' is the measured matrix dI/dV. What is missing of it counts as
    zero: nonlocal conductances G_n change local ones by R G_n². Biases stay those that were
    applied: the wire sees less by R I. Errors grow by 1 / (1 − R M')², and the noise to be stated.

    Parameters
    ----------
    measured : Dataset
        G_LL, G_RR, G_LR and G_RL in e²/h, or some of them, with signs as `conductance` has them,
        and dims mu (or gate), B and bias.
    left, right : float
        Of all that is in series with each lead, there and back: lines, filters, the amplifier's
        input; in Ω.

    Returns
    -------
    Dataset
        The same with other conductances, its axes in increasing order; without biases at which
        nothing was measured, and without the simulation's error. Its attribute noise stays.

    Raises
    ------
    ArgumentError
        If it is no measurement, or if the resistances are larger than what was measured allows.
    """
    away = (
        -number_in("left", left, 0.0, LARGEST_RESISTANCE, "Ω"),
        -number_in("right", right, 0.0, LARGEST_RESISTANCE, "Ω"),
    )
    measurement = measurement_of(measured, PAPERS_SETTINGS)
    G = np.nan_to_num(measurement.G)
    left_over = np.linalg.eigvals(_divided(away, _matrix(G)))
    must = "be less than the resistance that was measured in all"
    but = f"{left:g} Ω and {right:g} Ω are more where most is conducted"
    require(bool((left_over.real > 0).all()), "left and right", must, but)
    G = np.where(np.isnan(measurement.G), np.nan, in_series(away, G))
    axes = {measurement.axis: measurement.mu, "B": measurement.B, "bias": measurement.bias}
    whole: xr.Dataset = with_axes(measured).sel(axes).drop_vars("error", errors="ignore")
    there = [(k, name) for k, name in enumerate(CONDUCTANCES) if name in measured]
    return whole.assign({name: (list(axes), G[..., k], whole[name].attrs) for k, name in there})


def in_series(resistances: tuple[float, float], G: FloatArray) -> FloatArray:
    """Return conductances (…, channel) in e²/h with resistances in Ω in series with the leads.

    Of the changes of the voltages a part drops there, δI = M (δV − R δI). Negative ones take
    resistances away.
    """
    M = _matrix(G)
    M = np.linalg.solve(_divided(resistances, M), M).astype(np.float64)
    return np.stack([M[..., 0, 0], M[..., 1, 1], -M[..., 0, 1], -M[..., 1, 0]], axis=-1)


def _divided(resistances: tuple[float, float], M: FloatArray) -> FloatArray:
    """Return 1 + M R, by which M is divided."""
    return np.asarray(np.eye(2) + QUANTUM * M * np.array(resistances), np.float64)


def _matrix(G: FloatArray) -> FloatArray:
    """Return dI/dV (…, lead, lead): currents flow into the wire, so nonlocal ones have a minus."""
    LL, RR, LR, RL = np.moveaxis(G, -1, 0)
    return np.stack([np.stack([LL, -LR], axis=-1), np.stack([-RL, RR], axis=-1)], axis=-2)
