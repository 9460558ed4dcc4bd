"""The wires that an inversion has found, out of what `infer` returned."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import xarray as xr

from disorder_landscape.arguments import number_in, reals, require
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
    prior = prior_of_result(result)
    return _wire(prior, _array(result, "potential_mean", ("site",)), _means(result, prior))


def sample_wires(result: xr.Dataset) -> list[Nanowire]:
    """Return the wires of the samples of the posterior.

    Raises
    ------
    ArgumentError
        As `mean_wire`.
    """
    prior, potentials = prior_of_result(result), _array(result, "potential", ("sample", "site"))
    values = {name: _array(result, name, ("sample",)) for name in prior.unknown}
    return [
        _wire(prior, V, {name: float(of[k]) for name, of in values.items()})
        for k, V in enumerate(potentials)
    ]


def settings_of_result(result: xr.Dataset) -> dict[str, object]:
    """Return θ, barriers and temperature at which the device was measured, as far as is known."""
    prior = prior_of_result(result)
    values = {**prior.known, **_means(result, prior)}
    settings: dict[str, object] = {"theta": result.attrs.get("theta", 0.0)}
    if "temperature" in values:
        settings["temperature"] = values["temperature"]
    if "barrier_left" in values and "barrier_right" in values:
        settings["barrier"] = (values["barrier_left"], values["barrier_right"])
    return settings


def as_calibrated(result: xr.Dataset, measurement: Measurement) -> Measurement:
    """Return a measurement of the same device at the μ and the biases that it has in truth.

    Temperature and barriers are the measurement's own.

    Raises
    ------
    ArgumentError
        If the result is over a gate voltage and the measurement over μ, or the other way round.
    """
    axis = "gate" if "gate" in result.dims else "mu"
    must = f"be over {axis}, as that of the inversion was"
    require(measurement.axis == axis, "measurement", must, f"it is over {measurement.axis}")
    prior, setup = prior_of_result(result), Setup(measurement.mu, measurement.bias)
    _enter(prior, setup, _means(result, prior))
    return replace(measurement, mu=setup.mu, bias=setup.bias, axis="mu")


def prior_of_result(result: xr.Dataset) -> Prior:
    """Return the prior with which a result was found, all of its parameters said.

    Raises
    ------
    ArgumentError
        As `mean_wire`.
    """
    but = "its attribute prior is missing, or another version's: run infer again"
    try:
        given = json.loads(result.attrs.get("prior", ""))
    except (TypeError, ValueError):
        given = None
    require(isinstance(given, dict), "prediction", MUST, but)
    return Prior.from_mapping(given)


def _means(result: xr.Dataset, prior: Prior) -> dict[str, float]:
    return {name: float(_array(result, f"{name}_mean", ())) for name in prior.unknown}


def _enter(prior: Prior, setup: Setup, unknown: Mapping[str, float]) -> None:
    """Let the parameters of a device enter a setup, known ones and these."""
    values = {**prior.known, **unknown}
    for one in PARAMETERS:
        if one.name in values:
            one.enters(setup, number_in(one.name, values[one.name], one.low, one.high, one.unit))


def _wire(prior: Prior, V: FloatArray, unknown: Mapping[str, float]) -> Nanowire:
    setup = Setup(np.zeros(1), np.zeros(1))
    _enter(prior, setup, unknown)
    return nanowire(V, setup, {name: getattr(prior, name) for name in FIXED})


def _array(result: xr.Dataset, name: str, dims: tuple[str, ...]) -> FloatArray:
    require(name in result.variables, "prediction", MUST, f"it lacks {name}")
    found = result[name].dims
    require(found == dims, "prediction", MUST, f"the dims of {name} are {found}")
    return reals("prediction", result[name].to_numpy(), MUST)
