"""The numbers of a measurement: units of conductances and axes, and what they can be at most."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from scipy.constants import e, h

from disorder_landscape.arguments import SAME_UNITS, grid_in, require
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.model.quantities import AXES, CONDUCTANCES
from disorder_landscape.model.ranges import PARAMETER_RANGES

QUANTUM = e**2 / h
"""e²/h in S."""
QUANTA = ("", "e^2/h", "e²/h", "e**2/h", "e2/h")
"""Units that conductances may state."""
CARRIED = 4.0
"""In e²/h: what Andreev reflection of both spins of one subband carries at most, …"""
ERRORS = 6.0
"""… and so many standard deviations of errors may be beyond it. …"""
LARGEST = 10.0
"""… More than this are none, whatever the errors are."""
AXIS_UNITS = {"mu": ("meV",), "B": ("T", *SAME_UNITS["T"]), "bias": ("meV", *SAME_UNITS["meV"])}
"""Units that axes may state."""
LARGEST_BIAS = PARAMETER_RANGES["delta0"][1]
"""In meV: there is no larger gap, which biases stay below, …"""
LEAST_BIAS = 1e-3
"""… and if none is larger than this, which is kT at 12 mK, they are no meV."""
IN_ANY_UNIT = 1e6
"""Largest value of an axis whose unit is not known."""
IN_QUANTA = f"be in e²/h, which is {QUANTUM:.4g} S, by which conductances in S are divided"


def conductances_of(dataset: xr.Dataset, given: Sequence[str]) -> FloatArray:
    """Return the conductances (mu, B, bias, channel) in e²/h, NaN for what is not given."""
    shape = tuple(dataset.sizes[axis] for axis in AXES)
    G = np.full((*shape, len(CONDUCTANCES)), np.nan)
    for name in given:
        values = dataset[name].transpose(*AXES).to_numpy()
        numbers = values.dtype.kind in "fiu"
        finite = numbers and not np.isinf(values).any()
        but = f"{name} holds {'infinity' if numbers else 'something else'}"
        require(finite, "measurement", "hold finite numbers or NaN", but)
        G[..., CONDUCTANCES.index(name)] = values
        unit = str(dataset[name].attrs.get("units", ""))
        require(unit in QUANTA, "measurement", IN_QUANTA, f"the units of {name} are {unit}")
    measured = abs(G[np.isfinite(G)])
    require(measured.size > 0, "measurement", "hold finite numbers", "it holds none")
    largest = measured.max()
    require(largest > 0, "measurement", "hold conductances", "all of them are zero")
    but = f"none is larger than {largest:.3g}, as if they were in siemens"
    require(not largest < 2 * QUANTUM, "measurement", IN_QUANTA, but)
    but = f"one is {largest:.3g}, more than one subband can carry"
    require(largest < LARGEST, "measurement", IN_QUANTA, but)
    return G


def biases_of(dataset: xr.Dataset) -> FloatArray:
    """Return the biases in meV, in increasing order.

    Raises
    ------
    ArgumentError
        If they are something else: in another unit, stated or not, or no grid.
    """
    bias = axis_of(dataset, "bias", IN_ANY_UNIT)
    largest = abs(bias).max()
    for unlikely, unit in (
        (largest > LARGEST_BIAS, "µV"),
        (largest < LEAST_BIAS and bias.size > 1, "V"),
    ):
        but = f"the largest is {largest:.3g}, as if they were in {unit}"
        require(not unlikely, "bias", "be in meV", but)
    return bias


def axis_of(dataset: xr.Dataset, name: str, largest: float) -> FloatArray:
    """Return the points of an axis, up to a largest one to either side.

    Raises
    ------
    ArgumentError
        If they are in another unit, or no grid.
    """
    units = AXIS_UNITS[name]
    unit = str(dataset[name].attrs.get("units", units[0]))
    require(unit in units, name, f"be in {units[0]}", f"its units are {unit}")
    return grid_in(name, dataset[name].to_numpy(), -largest, largest, units[0])


def check_carried(measurement: Measurement, noise: FloatArray) -> None:
    """Require that no conductance is larger than one subband carries, with errors (channel,).

    Raises
    ------
    ArgumentError
        If one is.
    """
    beyond = np.abs(measurement.G) - ERRORS * noise
    largest = np.unravel_index(np.nanargmax(beyond), beyond.shape)
    must = f"be at most {CARRIED:g} e²/h, which is what one subband carries"
    but = f"one is {measurement.G[largest]:.3g} e²/h, with a noise of {noise[largest[-1]]:g} e²/h"
    require(bool(beyond[largest] <= CARRIED), "measurement", must, but)
