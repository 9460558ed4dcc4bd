"""The wires that an inversion has found, out of what `infer` returned."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import xarray as xr

from disorder_landscape.arguments import number_in, require
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.problem.parameters import PARAMETERS, Setup, nanowire
from disorder_landscape.inference.problem.prior import FIXED, Prior
from disorder_landscape.model.parameters import FloatArray, Nanowire

MUST = "be a result of infer"


def mean_wire(result: xr.Dataset) -> Nanowire:
    """Return the wire of the mean of the posterior.

    Raises
    ------
    ArgumentError
        If this is no result of `infer`, or an older version's.
    """
    values = {name: _number(result, f"{name}_mean") for name in _unknown(result)}
    return _wire(result, _array(result, "potential_mean", ("site",)), values)


def sample_wires(result: xr.Dataset) -> list[Nanowire]:
    """Return the wires of the samples of the posterior.

    Raises
    ------
    ArgumentError
        As `mean_wire`.
    """
    potentials = _array(result, "potential", ("sample", "site"))
    values = {name: _array(result, name, ("sample",)) for name in _unknown(result)}
    return [
        _wire(result, V, {name: float(of[k]) for name, of in values.items()})
        for k, V in enumerate(potentials)
    ]


def as_calibrated(result: xr.Dataset, measurement: Measurement) -> Measurement:
    """Return a measurement of the same device at the μ and the biases that it has in truth.

    Temperature and barriers are the measurement's own.
    """
    setup = Setup(measurement.mu, measurement.bias)
    values = {name: _number(result, f"{name}_mean") for name in _unknown(result)}
    _enter(result, setup, values)
    return replace(measurement, mu=setup.mu, bias=setup.bias, axis="mu")


def _prior(result: xr.Dataset) -> Prior:
    but = "its attribute prior is missing, or another version's: run infer again"
    try:
        given = json.loads(result.attrs.get("prior", ""))
    except (TypeError, ValueError):
        given = None
    require(isinstance(given, dict), "prediction", MUST, but)
    return Prior.from_mapping(given)


def _unknown(result: xr.Dataset) -> list[str]:
    return list(_prior(result).unknown)


def _enter(result: xr.Dataset, setup: Setup, unknown: Mapping[str, float]) -> None:
    """Let the parameters of a device enter a setup, known ones and these."""
    values = {**_prior(result).known, **unknown}
    for one in PARAMETERS:
        if one.name in values:
            one.enters(setup, number_in(one.name, values[one.name], one.low, one.high, one.unit))


def _wire(result: xr.Dataset, V: FloatArray, unknown: Mapping[str, float]) -> Nanowire:
    prior, setup = _prior(result), Setup(np.zeros(1), np.zeros(1))
    _enter(result, setup, unknown)
    return nanowire(V, setup, {name: getattr(prior, name) for name in FIXED})


def _array(result: xr.Dataset, name: str, dims: tuple[str, ...]) -> FloatArray:
    require(name in result.variables, "prediction", MUST, f"it lacks {name}")
    found = result[name].dims
    require(found == dims, "prediction", MUST, f"the dims of {name} are {found}")
    return np.asarray(result[name].to_numpy(), dtype=float)


def _number(result: xr.Dataset, name: str) -> float:
    return float(_array(result, name, ()))
