"""The wires that an inversion has found, out of what `infer` returned."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray as xr

from disorder_landscape.arguments import ArgumentError, number_in, reals, require, shown
from disorder_landscape.inference.problem.agreement import check_agreement
from disorder_landscape.inference.problem.measurement import PAPERS_SETTINGS, Measurement
from disorder_landscape.inference.problem.parameters import PARAMETERS, Setup, nanowire
from disorder_landscape.inference.problem.prior import Prior
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
    """Return the wires of the samples of the posterior, which can be simulated like any other.

    Parameters
    ----------
    result : Dataset
        What `infer` returned.

    Raises
    ------
    ArgumentError
        If this is no result of `infer`, or an older version's.
    """
    return [sample.wire for sample in samples_of(result)]


class Sample(NamedTuple):
    """A sample of an inversion, and measurements as they are if it is the truth."""

    wire: Nanowire
    measured: Sequence[Measurement]


def samples_of(result: xr.Dataset, measured: Sequence[Measurement] = ()) -> list[Sample]:
    """Return the samples of the posterior, and measurements at the settings that each has found.

    Raises
    ------
    ArgumentError
        As `sample_wires`.
    """
    prior, stated = prior_of_result(result), _stated(result)
    potentials = _array(result, "potential", ("sample", "site"))
    values = {name: _array(result, name, ("sample",)) for name in prior.unknown}
    found = []
    for k, V in enumerate(potentials):
        unknown = {name: float(of[k]) for name, of in values.items()}
        as_calibrated = [_calibrated(prior, unknown, m, stated) for m in measured]
        found.append(Sample(_wire(prior, V, unknown), as_calibrated))
    return found


def usual_settings_of(result: xr.Dataset) -> dict[str, object]:
    """Return settings where a measurement states none: θ of the inversion, and what it replaces."""
    return {**PAPERS_SETTINGS, "theta": result.attrs.get("theta", 0.0)}


def as_calibrated(result: xr.Dataset, measurement: Measurement) -> Measurement:
    """Return a measurement of the same device at the settings that it has in truth.

    μ and biases are as lever arm and offsets have it. A temperature or a barrier that is not
    stated, or stated as it was for the inversion, is what the inversion has found. Others are the
    measurement's own.

    Raises
    ------
    ArgumentError
        If the result is over a gate voltage and the measurement over μ, or the other way round, or
        if it states what the prior excludes.
    """
    axis = "gate" if "gate" in result.dims else "mu"
    must = f"be over {axis}, as that of the inversion was"
    require(measurement.axis == axis, "measurement", must, f"it is over {measurement.axis}")
    prior = prior_of_result(result)
    for name in sorted(measurement.stated.keys() - measurement.settings.keys()):
        if (belief := getattr(prior, name)) is not None:
            check_agreement(name, belief, measurement.stated[name])
    return _calibrated(prior, _means(result, prior), measurement, _stated(result))


def _calibrated(
    prior: Prior,
    unknown: Mapping[str, float],
    measurement: Measurement,
    stated_before: Mapping[str, float],
) -> Measurement:
    setup = Setup(measurement.mu, measurement.bias)
    _enter(prior, setup, unknown)
    at = {"temperature": setup.temperature}
    at["barrier_left"], at["barrier_right"] = setup.barrier
    for name in measurement.settings.keys() & measurement.stated.keys():
        own = measurement.stated[name]
        if not np.isclose(own, stated_before.get(name, np.nan)):
            at[name] = own
    return replace(
        measurement,
        mu=setup.mu,
        bias=setup.bias,
        temperature=at["temperature"],
        barrier=(at["barrier_left"], at["barrier_right"]),
        axis="mu",
    )


def _stated(result: xr.Dataset) -> dict[str, float]:
    """Return temperature and barriers that the inverted measurement stated, by name."""
    try:
        given = json.loads(result.attrs.get("settings", "{}"))
        return {name: float(value) for name, value in given.items()}
    except (TypeError, ValueError, AttributeError):
        raise ArgumentError("prediction", MUST, "its attribute settings is damaged") from None


def prior_of_result(result: xr.Dataset) -> Prior:
    """Return the prior with which a result was found, all of its parameters said.

    Raises
    ------
    ArgumentError
        As `mean_wire`.
    """
    require(isinstance(result, xr.Dataset), "prediction", MUST, f"it is {shown(result)}")
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
    return nanowire(V, setup, prior.fixed)


def _array(result: xr.Dataset, name: str, dims: tuple[str, ...]) -> FloatArray:
    require(name in result.variables, "prediction", MUST, f"it lacks {name}")
    found = result[name].dims
    require(found == dims, "prediction", MUST, f"the dims of {name} are {found}")
    return reals("prediction", result[name].to_numpy(), MUST)
