"""What `infer` returns: the posterior, and what follows from it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from disorder_landscape.inference.maps import (
    fine_grids,
    gap_energies,
    gap_probability,
    visibility,
)
from disorder_landscape.inference.maxima import maxima_of
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.posterior.weighted_samples import weighted_samples
from disorder_landscape.inference.problem.distributions import Distribution, Uniform
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.parameters import BY_NAME
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.streams import Stream
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.model.quantities import AXES, CONDUCTANCES, with_units

OPEN = 0.8
"""An unknown is not fixed whose standard deviation is more than this share of the prior's."""
ALIKE = 0.95
"""Two are not told apart whose correlation is larger than this."""
NEAR_LIMIT, KNOWN = 1.5, 0.15
"""A parameter is at a limit of a uniform prior if it is nearer than so many standard deviations,
and if one is less than this part of the prior's range (0.29 of it is as little as is known
before)."""
MAP = "map_mu", "map_B"
"""Axes of the maps of T_IV, which are finer than those of the measurement."""
HERMITE = 61
"""Nodes by which the mean of a parameter's distribution is taken."""


def result_of(observation: Observation, outcome: Outcome, samples: int, seed: int) -> xr.Dataset:
    """Return the dataset of `infer`, but for the attributes that tell how it was found."""
    unknowns, covariance = observation.unknowns, outcome.answer.covariance
    X = outcome.draw(np.random.default_rng([seed, Stream.SAMPLES]), samples)
    parts = [
        _of_most_probable(observation, outcome),
        _of_samples(observation, X),
        _potential(unknowns, outcome, X),
        maxima_of(observation, outcome),
    ]
    dataset = with_units(xr.merge(parts)).merge(_parameters(unknowns, outcome, X))
    limits = at_limit(dataset, unknowns.parameters)
    dataset.attrs = {
        **unknowns.prior.known,
        **unknowns.prior.fixed,
        **evidence(observation, outcome, X),
        **left_open(unknowns, covariance, list(limits)),
        "at_limit": ", ".join(f"{name} ({limit})" for name, limit in limits.items()),
        "prior": json.dumps(unknowns.prior.to_dict()),
    }
    m = observation.measurement
    return dataset if m.axis == "mu" else _over_gate(dataset, m.gate_unit)


def _of_most_probable(observation: Observation, outcome: Outcome) -> xr.Dataset:
    """Return what the most probable wire shows."""
    m, x = observation.measurement, outcome.best.answer.mean[None]
    G, maps = observation.conductances(x)[0], fine_grids(m.mu, m.B)
    data = {
        "misfit": ("channel", observation.misfit(outcome.best.data)),
        **{name: (AXES, G[..., c]) for c, name in enumerate(CONDUCTANCES)},
        "T_IV": (("lead", *MAP), visibility(observation, x, maps)[0]),
    }
    coords = {
        "channel": list(CONDUCTANCES),
        "lead": ["L", "R"],
        **{axis: getattr(m, axis) for axis in AXES},
        **dict(zip(MAP, maps, strict=True)),
    }
    return xr.Dataset(data, coords=coords)


def _of_samples(observation: Observation, X: FloatArray) -> xr.Dataset:
    """Return what shares of the samples X (sample, unknown) are topological, and have a gap."""
    m, gaps = observation.measurement, gap_energies(observation)
    T_IV = visibility(observation, X, fine_grids(m.mu, m.B))
    data = {
        "P_topological": (MAP, (T_IV[:, 0] < 0).mean(axis=0)),
        "P_gap": (("gap", *AXES[:2]), gap_probability(observation, X, gaps)),
    }
    return xr.Dataset(data, coords={"gap": gaps})


def _potential(unknowns: Unknowns, outcome: Outcome, X: FloatArray) -> xr.Dataset:
    """Return the potential, and its components if it has any: samples, means, error bars."""
    mean, covariance = outcome.answer.mean, outcome.answer.covariance
    data = {
        "potential": (("sample", "site"), unknowns.potential(X)),
        "potential_mean": ("site", unknowns.potential(mean)),
        "potential_std": ("site", unknowns.potential_std(covariance)),
    }
    coords = {"site": np.arange(unknowns.prior.sites)}
    if (count := unknowns.prior.components) is not None:
        slopes = unknowns.label_slopes(mean)[:count]
        data |= {
            "components": (("sample", "component"), unknowns.components(X)),
            "components_mean": ("component", unknowns.components(mean)),
            "components_std": (
                "component",
                np.sqrt(np.einsum("ci,ij,cj->c", slopes, covariance, slopes)),
            ),
        }
        coords["component"] = np.arange(1, count + 1)
    return xr.Dataset(data, coords=coords)


def _parameters(unknowns: Unknowns, outcome: Outcome, X: FloatArray) -> xr.Dataset:
    """Return the parameters that are unknown: samples, means, error bars."""
    mean, std = outcome.answer.mean, np.sqrt(np.diag(outcome.answer.covariance))
    found = xr.Dataset()
    for name, belief in unknowns.parameters.items():
        k = unknowns.names.index(name)
        if (drawn := outcome.importance_samples) is None:
            moments_of_it = moments(belief, mean[k], std[k])
        else:
            moments_of_it = drawn.moments_of(belief.value(drawn.samples[:, k]))
        one = BY_NAME[name]
        for ending, words, dims, value in (
            ("", "", ("sample",), unknowns.parameter(name, X)),
            ("_mean", "mean of the ", (), moments_of_it[0]),
            ("_std", "standard deviation of the ", (), moments_of_it[1]),
        ):
            attrs = {"long_name": words + one.long_name, "units": one.unit or "1"}
            found[name + ending] = (dims, value, attrs)
    return found


def _over_gate(dataset: xr.Dataset, unit: str) -> xr.Dataset:
    """Return a result over gate voltages, whose unit may be stated, in place of μ."""
    dataset = dataset.rename(mu="gate", map_mu="map_gate")
    for name in ("gate", "map_gate"):
        dataset[name].attrs = {"long_name": "gate voltage"} | ({"units": unit} if unit else {})
    if unit:
        for variable in (v for n, v in dataset.items() if str(n).startswith("lever_arm")):
            variable.attrs["units"] = f"meV/{unit}"
    return dataset


def moments(belief: Distribution, mean: float, std: float) -> tuple[float, float]:
    """Return mean and standard deviation of a parameter whose ξ is normal with these."""
    at, weight = np.polynomial.hermite_e.hermegauss(HERMITE)
    values, weight = belief.value(mean + std * at), weight / weight.sum()
    average = float(weight @ values)
    return average, float(np.sqrt(weight @ (values - average) ** 2))


def evidence(observation: Observation, outcome: Outcome, X: FloatArray) -> dict[str, float]:
    """Return log_evidence and effective_sample_size, from samples weighted by the exact posterior.

    Parameters
    ----------
    observation : Observation
    outcome : Outcome
        Its own importance samples serve, if it has any.
    X : array, shape (sample, unknown)
        Samples of its answer, which serve otherwise.
    """
    found = outcome.importance_samples
    if found is None:
        found = weighted_samples(observation, outcome.answer, X)
    of_the_errors = -0.5 * np.log(2 * np.pi * observation.variance).sum()
    return {
        "log_evidence": found.log_mean_weight + of_the_errors,
        "effective_sample_size": found.effective_sample_size,
    }


def at_limit(result: xr.Dataset, parameters: Mapping[str, Distribution]) -> dict[str, str]:
    """Return the limits, as words, of parameters that are where their prior ends, by name.

    Of those of which any value between two is as likely before, if they are known better than that
    and may be beyond.
    """
    said = {}
    for name, belief in parameters.items():
        if not isinstance(belief, Uniform):
            continue
        mean, std = result[f"{name}_mean"].item(), result[f"{name}_std"].item()
        limit = min(belief.low, belief.high, key=lambda end: abs(end - mean))
        can_go_on = limit not in (BY_NAME[name].low, BY_NAME[name].high)
        is_known = std < KNOWN * (belief.high - belief.low)
        if can_go_on and is_known and abs(mean - limit) < NEAR_LIMIT * std:
            said[name] = f"{limit:g} {BY_NAME[name].unit}".rstrip()
    return said


def left_open(
    unknowns: Unknowns, covariance: FloatArray, at_limits: Sequence[str] = ()
) -> dict[str, str]:
    """Return as words what the data do not fix, and what they do not tell apart.

    not_fixed names unknowns, but those at limits of the prior; of the disorder's it says how many
    of their combinations. Both are empty where there is nothing.
    """
    n, std = unknowns.of_disorder, np.sqrt(np.diag(covariance))
    further = zip(unknowns.names[n:], std[n:], strict=True)
    not_fixed = [name for name, one in further if one > OPEN and name not in at_limits]
    open_ways = int((np.linalg.eigvalsh(covariance[:n, :n]) > OPEN**2).sum())
    if open_ways:
        not_fixed.insert(0, f"{open_ways} of {n} combinations of the disorder's unknowns")
    with_mean = range(n - ("mean" in unknowns.names), std.size)
    pairs = [
        f"{unknowns.names[i]} and {unknowns.names[j]} ({covariance[i, j] / std[i] / std[j]:+.3f})"
        for i in with_mean
        for j in with_mean
        if i < j and abs(covariance[i, j]) > ALIKE * std[i] * std[j]
    ]
    return {"not_fixed": ", ".join(not_fixed), "not_told_apart": ", ".join(pairs)}
