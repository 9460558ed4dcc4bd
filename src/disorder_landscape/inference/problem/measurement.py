"""One measurement: conductances and the settings K_full of S-II.1 at which they were taken."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.constants import e, h

from disorder_landscape.arguments import grid_in, number_in, require
from disorder_landscape.config import DatasetConfig
from disorder_landscape.model.hamiltonian import FULL_TURN
from disorder_landscape.model.parameters import (
    PARAMETER_RANGES,
    STATED,
    TEMPERATURE,
    FloatArray,
    Nanowire,
    checked_barrier,
    checked_temperature,
)
from disorder_landscape.model.quantities import AXES, CONDUCTANCES
from disorder_landscape.observables.conductance import conductance

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
FIXED = tuple(name for name in STATED if name not in ("alpha", "lead_mu"))
"""Those that all wires of this program's networks have in common."""
AS_THE_WIRE = {"lead_alpha": "alpha", "lead_g": "g", "parent_dissipation": "dissipation"}
"""Parameters of leads and parent that are, in every inversion, those of the wire."""
AXIS_UNITS = {"mu": ("meV",), "B": ("T", "tesla"), "bias": ("meV", "mV")}
"""Units that axes may state."""
IN_QUANTA = f"be in e²/h, which is {QUANTUM:.4g} S, by which conductances in S are divided"
SETTINGS = ("theta", "barrier", "temperature")
"""Attributes that a measurement must have: in radians, in meV (left, right), in K."""
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


def measurement_of(dataset: xr.Dataset, usual: Mapping[str, Any] | None = None) -> Measurement:
    """Return a measurement of one wire, checked.

    Parameters
    ----------
    dataset : Dataset
        G_LL … G_RL in e²/h, dims (mu, B, bias) in any order, or gate in place of mu, and the
        attributes SETTINGS, as `conductance` returns them. One number is enough; what is missing is
        NaN, and biases at which nothing was measured are left out. An axis of one value may be a
        scalar coordinate.
    usual : mapping, optional
        Settings where the attributes are missing.

    Raises
    ------
    ArgumentError
        If it lacks a variable, a dim or an attribute, has several wires, holds infinity, is in
        other units, or states that the wire is another than the models'.
    """
    is_dataset = isinstance(dataset, xr.Dataset)
    require(is_dataset, "measurement", "be a Dataset", f"it is {type(dataset).__name__!r}")
    dataset = with_axes(dataset)
    axis = "gate" if "gate" in dataset.dims and "mu" not in dataset.variables else "mu"
    if axis == "gate":
        values = dataset["gate"].to_numpy()
        dataset = dataset.rename(gate="mu").assign_coords(mu=("mu", values))  # in any unit
    must = "hold the conductances of one wire over mu, B and bias"
    given = [name for name in CONDUCTANCES if name in dataset.variables]
    missing = [name for name in (*CONDUCTANCES, *AXES) if name not in dataset.variables]
    if given:
        missing = [name for name in missing if name in AXES]
    require(not missing, "measurement", must, f"it lacks {', '.join(missing)}")
    for name in given:
        dims = sorted(map(str, dataset[name].dims))
        but = f"the dims of {name} are {', '.join(dims)}"
        require(dims == ["B", "bias", "mu"], "measurement", must, but)
    settings = {**(usual or {}), **dataset.attrs}
    missing = [name for name in SETTINGS if name not in settings]
    states = f"state {', '.join(SETTINGS)} as attributes"
    require(not missing, "measurement", states, f"it lacks {', '.join(missing)}")
    for name in AXES:
        is_axis = dataset[name].dims == (name,) and dataset[name].dtype.kind in "fiu"
        require(is_axis, name, "be numbers along their own dimension", "it is something else")
    dataset = dataset.sortby(list(AXES))
    G = _checked_conductances(dataset, given)
    there, bias = np.isfinite(G).any(axis=(0, 1, 3)), _axis(dataset, "bias", 1e3)
    return Measurement(
        G=G[:, :, there],
        mu=_axis(dataset, "mu", 1e3 if axis == "mu" else 1e6),
        B=_axis(dataset, "B", 100.0),
        bias=bias[there],
        left_out=bias[~there],
        theta=number_in("theta", settings["theta"], -FULL_TURN, FULL_TURN, "radians"),
        barrier=checked_barrier(settings["barrier"]),
        temperature=checked_temperature(settings["temperature"]),
        axis=axis,
        stated=_stated(dataset.attrs),
    )


def _stated(attrs: Mapping[Any, Any]) -> dict[str, float]:
    """Return what attributes say of the device."""
    stated = {
        name: number_in(name, attrs[name], *PARAMETER_RANGES[name])
        for name in STATED
        if name in attrs
    }
    for name, of_wire in AS_THE_WIRE.items():
        if name in attrs:
            own = number_in(name, attrs[name], *PARAMETER_RANGES[name])
            same = stated.setdefault(of_wire, own)
            must = f"be the wire's {of_wire}, {same:g}, as in every inversion"
            require(bool(np.isclose(own, same)), name, must, f"the measurement's is {own:g}")
    if "temperature" in attrs:
        stated["temperature"] = checked_temperature(attrs["temperature"])
    if "barrier" in attrs:
        stated["barrier_left"], stated["barrier_right"] = checked_barrier(attrs["barrier"])
    return stated


def check_wire(measurement: Measurement) -> None:
    """Require that a measurement states the values of FIXED, where it states any.

    Raises
    ------
    ArgumentError
        If it states another, or is over gate voltages instead of μ.
    """
    on_mu = measurement.axis == "mu"
    require(on_mu, "measurement", "be over mu in meV", "it is over gate, whose unit is not known")
    for name in FIXED:
        usual = getattr(Nanowire, name)
        stated = measurement.stated.get(name, usual)
        must = f"be {usual:g}, as in all simulations here"
        require(bool(np.isclose(stated, usual)), name, must, f"the measurement's is {stated:g}")


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


def with_axes(dataset: xr.Dataset) -> xr.Dataset:
    """Return a dataset in which axes that are scalar coordinates have a dim of their own."""
    names = AXES if "mu" in dataset.coords else ("gate", *AXES[1:])
    scalars = [name for name in names if name in dataset.coords]
    return dataset.expand_dims([name for name in scalars if dataset[name].ndim == 0])


def _checked_conductances(dataset: xr.Dataset, given: list[str]) -> FloatArray:
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
    but = f"none is larger than {largest:.3g}, as if they were in siemens"
    require(not 0 < largest < 2 * QUANTUM, "measurement", IN_QUANTA, but)
    but = f"one is {largest:.3g}, more than one subband can carry"
    require(largest < LARGEST, "measurement", IN_QUANTA, but)
    return G


def _axis(dataset: xr.Dataset, name: str, largest: float) -> FloatArray:
    units = AXIS_UNITS[name]
    unit = str(dataset[name].attrs.get("units", units[0]))
    require(unit in units, name, f"be in {units[0]}", f"its units are {unit}")
    return grid_in(name, dataset[name].to_numpy(), -largest, largest, units[0])
