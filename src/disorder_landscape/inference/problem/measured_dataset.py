"""A dataset as a measurement: which variables, dims and attributes it must have, and may have."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from disorder_landscape.arguments import number_in, require
from disorder_landscape.inference.problem.measured_numbers import (
    IN_ANY_UNIT,
    axis_of,
    biases_of,
    conductances_of,
)
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.model.hamiltonian import FULL_TURN
from disorder_landscape.model.quantities import AXES, CONDUCTANCES
from disorder_landscape.model.ranges import (
    B_RANGE,
    MU_RANGE,
    PARAMETER_RANGES,
    STATED,
    checked_barrier,
    checked_temperature,
)
from disorder_landscape.model.stated import check_wire_of_networks

AS_THE_WIRE = {"lead_alpha": "alpha", "lead_g": "g", "parent_dissipation": "dissipation"}
"""Parameters of leads and parent that are, in every inversion, those of the wire."""
SETTINGS = ("theta", "barrier", "temperature")
"""Attributes that a measurement must have: in radians, in meV (left, right), in K."""
GATE = "gate"
"""The first axis where it is a gate voltage."""


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
    axes, given = _axes_and_conductances(dataset)
    settings = {**(usual or {}), **dataset.attrs}
    missing = [name for name in SETTINGS if name not in settings]
    states = f"state {', '.join(SETTINGS)} as attributes"
    require(not missing, "measurement", states, f"it lacks {', '.join(missing)}")
    gate_unit = ""
    if axes[0] == GATE:
        gate_unit = str(dataset[GATE].attrs.get("units", ""))
        values = dataset[GATE].to_numpy()
        dataset = dataset.rename(gate="mu").assign_coords(mu=("mu", values))  # in any unit
    dataset = dataset.sortby(list(AXES))
    G = conductances_of(dataset, given)
    there, bias = np.isfinite(G).any(axis=(0, 1, 3)), biases_of(dataset)
    return Measurement(
        G=G[:, :, there],
        mu=axis_of(dataset, "mu", IN_ANY_UNIT if axes[0] == GATE else MU_RANGE[1]),
        B=axis_of(dataset, "B", B_RANGE[1]),
        bias=bias[there],
        left_out=bias[~there],
        theta=number_in("theta", settings["theta"], -FULL_TURN, FULL_TURN, "radians"),
        barrier=checked_barrier(settings["barrier"]),
        temperature=checked_temperature(settings["temperature"]),
        axis=axes[0],
        gate_unit=gate_unit,
        stated=_stated(dataset.attrs),
    )


def _axes_and_conductances(dataset: xr.Dataset) -> tuple[tuple[str, ...], list[str]]:
    """Return the names of the axes, mu or gate, B and bias, and of the conductances given.

    Raises
    ------
    ArgumentError
        If there are none of these, an axis is missing or none, or a conductance has other dims.
    """
    has_gate = GATE in dataset.variables and "mu" not in dataset.variables
    axes = (GATE, *AXES[1:]) if has_gate else AXES
    given = [name for name in CONDUCTANCES if name in dataset.variables]
    missing = [name for name in (*(given or CONDUCTANCES), *axes) if name not in dataset.variables]
    has = ", ".join(map(str, dataset.dims)) or "no dims"
    must = "hold the conductances of one wire over mu (or gate), B and bias"
    require(not missing, "measurement", must, f"it lacks {', '.join(missing)}, and has {has}")
    for name in axes:
        _check_axis(dataset, name, axes)
    for name in given:
        dims = sorted(map(str, dataset[name].dims))
        but = f"the dims of {name} are {', '.join(dims)}"
        require(dims == sorted(axes), "measurement", must, but)
    return axes, given


def _check_axis(dataset: xr.Dataset, name: str, axes: Sequence[str]) -> None:
    """Require that one of the axes is one, and not a column of a table."""
    dims = dataset[name].dims
    is_column = len(dims) == 1 and dims != (name,)
    columns = ", ".join(map(repr, axes))
    how = f"pandas makes axes of columns: table.set_index([{columns}]).to_xarray()"
    but = f"it is along {dims[0]} ({how})" if is_column else "it is something else"
    is_axis = dims == (name,) and dataset[name].dtype.kind in "fiu"
    require(is_axis, name, "be numbers along their own dimension", but)


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
    """Require that a measurement is over μ, and of a wire as networks know it, if it says so.

    Raises
    ------
    ArgumentError
        If it states another, or is over gate voltages instead of μ.
    """
    on_mu = measurement.axis == "mu"
    require(on_mu, "measurement", "be over mu in meV", "it is over gate, whose unit is not known")
    check_wire_of_networks(measurement.stated)


def with_axes(dataset: xr.Dataset) -> xr.Dataset:
    """Return a dataset in which axes that are scalar coordinates have a dim of their own."""
    names = AXES if "mu" in dataset.coords else ("gate", *AXES[1:])
    scalars = [name for name in names if name in dataset.coords]
    return dataset.expand_dims([name for name in scalars if dataset[name].ndim == 0])
