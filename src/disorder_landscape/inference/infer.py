"""`infer`: the disorder in a measured wire, how sure that is, and where the wire is topological."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from disorder_landscape.arguments import (
    ArgumentError,
    check_progress,
    number_in,
    require,
    whether,
    whole_number_in,
)
from disorder_landscape.config import DatasetConfig
from disorder_landscape.inference.attempt import Attempt, best
from disorder_landscape.inference.checkpoint import Checkpoint
from disorder_landscape.inference.invert import (
    InversionSettings,
    Progress,
    invert,
    silent,
    usable_network_features,
    usual_settings,
)
from disorder_landscape.inference.problem.measurement import measurement_of, settings_of
from disorder_landscape.inference.problem.observation import (
    Observation,
    noise_of_channels,
    stated_noise,
)
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.search.first_guess import on_grid_of_network
from disorder_landscape.inference.verdict import verdict
from disorder_landscape.learning.model import (
    TrainedModel,
    existing_folder,
    load_model,
    load_model_config,
)
from disorder_landscape.model.parameters import PARAMETER_RANGES, FloatArray
from disorder_landscape.model.quantities import AXES, CONDUCTANCES, with_units
from disorder_landscape.observables.visibility import topological_visibility

SAMPLES = 64
MAP_POINTS = 61, 81
"""Of the maps of T_IV and P(topological), along μ and B."""


def infer(
    G: xr.Dataset,
    model: str | Path | TrainedModel,
    noise: float | Mapping[str, float] | None = None,
    network: bool = True,
    samples: int = SAMPLES,
    seed: int = 0,
    settings: InversionSettings | None = None,
    checkpoint: Path | None = None,
    progress: Progress = silent,
) -> xr.Dataset:
    """Find the disorder that explains a measurement, with error bars and a verdict.

    The network's guess, with its error at this noise, is where rounds of simulation and regression
    start. Gauss–Newton steps follow. Where the posterior is no normal distribution, importance
    sampling finds it. An answer that may be wrong is not accepted before a second attempt, from the
    disorder model's prior, agrees.

    Parameters
    ----------
    G : Dataset
        Conductances of one wire in e²/h, dims (mu, B, bias) in any order. The attributes
        temperature (K), barrier (left and right, meV) and theta (radians) are the model's where
        they are missing. Conductances may be missing, or NaN here and there; the others are
        explained. If some of the network's grid are missing, the start is the disorder model's
        prior.
    model : path or TrainedModel
        Folder of a trained model, which also says what disorder to expect.
    noise : float or mapping
        Standard deviation of the measurement's errors in e²/h, or of each channel's. By default the
        attribute noise of the measurement, or 0.001.
    network : bool
        False starts from the disorder model's prior: for other grids than the network's.
    samples : int
        How many samples of the posterior are returned, an even number.
    seed : int
    settings : InversionSettings, optional
    checkpoint : Path, optional
        File through which an interrupted run goes on. It is not deleted, since the result is not
        saved.
    progress : callable, optional
        Called with a `Step` after each round and each iteration of importance sampling, and before
        each Gauss–Newton step.

    Returns
    -------
    Dataset
        Of the samples: potential (sample, site) and components (sample, component) in meV, alpha
        (sample) in meV nm. Means and standard deviations of the posterior itself:
        components_mean and components_std (component), alpha_mean and alpha_std,
        potential_mean and potential_std (site). misfit (channel) in e²/h, of the most
        probable wire, NaN where nothing was measured. Of the mean: conductances
        G_LL … G_RL (mu, B, bias) and, on a finer grid, T_IV (lead, map_mu, map_B). P_topological
        (map_mu, map_B), the share of the samples with det r < 0. Attributes: verdict ("converged",
        "not converged" or "not described by the model"), excess (of χ² above its mean, in its
        standard deviations), attempts, rounds, start, noise; effective_sample_size if the samples
        are from importance sampling.

    Raises
    ------
    ArgumentError
        If the measurement lacks points of the network's grid, is not one wire's or is in siemens,
        if the noise is negative or another argument is out of range, or if α is not the model's.
    """
    whole_config = (
        model.config
        if isinstance(model, TrainedModel)
        else load_model_config(existing_folder(model))
    )
    config = whole_config.dataset
    observation = observation_of(G, config, noise)
    measurement, errors = observation.measurement, observation.noise
    check_progress(progress)
    samples = whole_number_in("samples", samples, 2, 10_000)
    require(samples % 2 == 0, "samples", "be an even number", f"it is {samples}")
    seed = whole_number_in("seed", seed, 0, 2**31)
    trained, missing = None, False
    if whether("network", network):
        missing = not _on_grid_of_network(config, observation).is_measured.all()
    if network and not missing:
        trained = model if isinstance(model, TrainedModel) else load_model(model)
    start = "the prior" if trained is None else "the network's guess"
    features = usable_network_features(trained, observation)
    if features is not None:
        start = "the prior, with the network's output as further features"
    if missing:
        start += ", because the network needs all conductances of its grid and some are missing"
    settings = settings or usual_settings(features)
    fingerprint = repr((whole_config, errors.tolist(), seed, settings, start)).encode()
    fingerprint += b"".join(np.asarray(value).tobytes() for value in vars(measurement).values())
    weights = [] if trained is None else trained.network.get_weights()
    fingerprint += b"".join(values.tobytes() for values in weights)
    found_before = Checkpoint(checkpoint, fingerprint)
    attempts = invert(observation, trained, seed, settings, progress, found_before)
    chosen = best(attempts)
    result = _result(observation, chosen, samples, seed)
    result.attrs = {
        "verdict": verdict(observation, attempts),
        "excess": chosen.excess,
        "attempts": len(attempts),
        "rounds": sum(attempt.rounds for attempt in attempts),
        "start": start,
        "noise": errors,
        "temperature": measurement.temperature,
        "barrier": measurement.barrier,
        "theta": measurement.theta,
        "config_hash": config.hash,
    }
    if chosen.importance_samples is not None:
        result.attrs["effective_sample_size"] = chosen.importance_samples.effective_sample_size
    return result


def observation_of(
    G: xr.Dataset, config: DatasetConfig, noise: float | Mapping[str, float] | None = None
) -> Observation:
    """Return what was measured of a wire, with what is unknown of it.

    Parameters
    ----------
    G : Dataset
    config : DatasetConfig
        Of the model's dataset.
    noise : float or mapping, optional
        All three as in `infer`.

    Raises
    ------
    ArgumentError
        As in `infer`.
    """
    measurement = measurement_of(G, settings_of(config), complete=False)
    _check_alpha(config, G.attrs)
    errors = noise_of_channels(stated_noise(G.attrs) if noise is None else noise)
    return Observation(measurement, Unknowns(config), errors)


def _check_alpha(config: DatasetConfig, attrs: Mapping[Any, Any]) -> None:
    """Require that a measurement states the model's α, if that is fixed."""
    least, most = config.alpha_range
    stated = number_in("alpha", attrs.get("alpha", least), *PARAMETER_RANGES["alpha"])
    must = f"be {least:g} meV nm, which this model takes for known"
    same = bool(np.isclose(stated, least))
    require(least < most or same, "alpha", must, f"the measurement's is {stated:g}")


def _on_grid_of_network(config: DatasetConfig, observation: Observation) -> Observation:
    """Return what is on the network's grid, or say how to do without the network."""
    try:
        return on_grid_of_network(config, observation)
    except ArgumentError as error:
        name, must, but = error.parts
        without = "(network=False, or --from-prior, does without the network)"
        raise ArgumentError(name, must, f"{but} {without}") from None


def _result(observation: Observation, chosen: Attempt, samples: int, seed: int) -> xr.Dataset:
    m, unknowns = observation.measurement, observation.unknowns
    mean, covariance = chosen.answer.mean, chosen.answer.covariance
    X = chosen.draw(np.random.default_rng([seed, 2**31 + 1]), samples)
    V = unknowns.potential(X)
    maps = _maps(m.mu, m.B)
    wires = unknowns.wires(np.concatenate([mean[None], X]), m.barrier)
    T_IV = topological_visibility(wires, maps[0], maps[1], theta=m.theta)
    G = observation.conductances(mean[None])[0]
    topological = (T_IV.isel(realization=slice(1, None), lead=0) < 0).mean("realization")
    grid = ("map_mu", "map_B")
    data = {
        "components": (("sample", "component"), unknowns.components(X)),
        "alpha": ("sample", unknowns.alpha(X)),
        "potential": (("sample", "site"), V),
        "components_mean": ("component", unknowns.components(mean)),
        "components_std": ("component", unknowns.components(np.sqrt(np.diag(covariance)))),
        "alpha_mean": ((), unknowns.alpha(mean)),
        "alpha_std": ((), unknowns.alpha_std(covariance)),
        "potential_mean": ("site", unknowns.potential(mean)),
        "potential_std": ("site", _potential_std(unknowns, covariance)),
        "misfit": ("channel", observation.misfit(chosen.data)),
        **{name: (AXES, G[..., c]) for c, name in enumerate(CONDUCTANCES)},
        "T_IV": (("lead", *grid), T_IV.isel(realization=0).to_numpy()),
        "P_topological": (grid, topological.to_numpy()),
    }
    coords = {
        "component": np.arange(1, unknowns.config.components + 1),
        "site": np.arange(unknowns.config.sites),
        "channel": list(CONDUCTANCES),
        "lead": ["L", "R"],
        **{axis: getattr(m, axis) for axis in AXES},
        **dict(zip(grid, maps, strict=True)),
    }
    return with_units(xr.Dataset(data, coords=coords))


def _potential_std(unknowns: Unknowns, covariance: FloatArray) -> FloatArray:
    """Return the standard deviation of V on each site."""
    each = unknowns.potential(np.eye(len(unknowns.names)))  # V of each unknown alone
    return np.asarray(np.sqrt(np.einsum("is,ij,js->s", each, covariance, each)))


def _maps(mu: FloatArray, B: FloatArray) -> list[FloatArray]:
    """Return fine grids of μ and B over the range of the measurement."""
    return [
        np.linspace(axis[0], axis[-1], points) if axis.size > 1 else axis
        for axis, points in zip((mu, B), MAP_POINTS, strict=True)
    ]
