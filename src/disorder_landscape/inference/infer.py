"""`infer`: the disorder in a measured wire, how sure that is, and where the wire is topological."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr
from threadpoolctl import threadpool_limits

from disorder_landscape.arguments import (
    check_progress,
    require,
    shown,
    whether,
    whole_number_in,
)
from disorder_landscape.config import DatasetConfig
from disorder_landscape.inference.checkpoint import Checkpoint
from disorder_landscape.inference.defaults import SAMPLES
from disorder_landscape.inference.discrepancy import BestEffort, best_effort, discrepancy_of
from disorder_landscape.inference.given import (
    Model,
    config_of,
    network_given,
    observation_of,
    prior_given,
)
from disorder_landscape.inference.invert import invert
from disorder_landscape.inference.optimum import chi_square_excess
from disorder_landscape.inference.problem.observation import Observation, overall_misfit
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.inference.result import result_of
from disorder_landscape.inference.search.few_unknowns import InversionSettings
from disorder_landscape.inference.search.steps import Steps
from disorder_landscape.inference.stages import MAPS, Progress, Step, silent
from disorder_landscape.inference.streams import Stream
from disorder_landscape.inference.verdict import verdict
from disorder_landscape.learning.model import TrainedModel, load_model

SEARCH = 12
"""Number of the search's version. What an interrupted run of another one has found is of no use."""


def infer(
    G: xr.Dataset,
    prior: Prior | Model,
    noise: float | Mapping[str, float] | None = None,
    network: bool | Model | None = None,
    samples: int = SAMPLES,
    seed: int = 0,
    settings: InversionSettings | None = None,
    discrepancy: bool = False,
    checkpoint: str | Path | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Find the disorder that explains a measurement, with error bars and a verdict.

    Gauss–Newton steps start about the network's guess, as far away as it errs at this noise. If
    they do not agree, or without a network, rounds of simulation and regression come nearer first.
    Where the posterior is no normal distribution, importance sampling finds it. An answer that may
    be wrong is not accepted before several starts agree.

    Parameters
    ----------
    G : Dataset
        Conductances of one wire in e²/h, dims (mu, B, bias) in any order; or gate instead of mu, if
        the prior has a lever arm. The attributes temperature (K), barrier (left and right, meV) and
        theta (radians) are the model's or the paper's where they are missing. Conductances may be
        missing, or NaN here and there; the others are explained. If some of the network's grid are
        missing, the start is the prior.
    prior : Prior, path or TrainedModel
        What is known of the device and what is not, or the file (.toml) that says so; or the folder
        of a trained model, whose dataset does.
    noise : float or mapping
        Standard deviation of the measurement's errors in e²/h, or of each channel's that is there.
        By default the attribute noise of the measurement, or 0.001.
    network : bool, path or TrainedModel, optional
        Which network guesses. By default that of the model, if one is given instead of a prior;
        False starts from the prior: for other grids than the network's.
    samples : int
        How many samples of the posterior are returned, an even number.
    seed : int
    settings : InversionSettings, optional
    discrepancy : bool
        Whether an error beside the noise is allowed for, where the noise does not explain the
        misfit: of each channel one, as large as the best effort leaves. The verdict stays the same.
    checkpoint : Path, optional
        File through which an interrupted run goes on. It is not deleted, since the result is not
        saved.
    progress : callable, optional
        Called with a `Step` after each round, some small steps and each iteration of importance
        sampling, before each Gauss–Newton step, and before the maps.

    Returns
    -------
    Dataset
        Of the samples: potential (sample, site) in meV, components (sample, component) in meV, if
        the prior has any, and each unknown parameter (sample) under its own name. Means and
        standard deviations of the posterior itself, of all of these, with _mean and _std. Of the
        most probable wire: conductances G_LL … G_RL (mu, B, bias) and misfit (channel) in e²/h, NaN
        where nothing was measured, and T_IV (lead, map_mu, map_B) on a finer grid. Of the wires at
        the maxima of the posterior: potential_maxima (maximum, site) in meV, each unknown parameter
        with _maxima, and the share (maximum) of the posterior; the most probable one first, and as
        many as have 95 % of it together.
        With discrepancy, the standard deviation of that error, discrepancy (channel) in e²/h, whose
        attribute settled is 0 where more turns or samples may change it; log_evidence then is that
        with these errors.
        P_topological (map_mu, map_B), the share of the samples with det r < 0. P_gap (gap, mu, B):
        the share whose lowest excitation, above zero modes where det r < 0, is above each energy
        gap in meV. Attributes: verdict ("converged", "not converged" or "not described by the
        model"), excess (of χ² above its mean, in its standard deviations), log_evidence,
        effective_sample_size (of as many samples as are returned), attempts, rounds, start, noise,
        theta, config_hash (of a model's dataset),
        prior and settings (as JSON: what is known and not, and the temperature and barriers that
        the measurement stated), each known parameter, not_fixed, not_told_apart and at_limit: what
        the data leave open, and what is where the prior ends. With gate instead of mu dims are
        named so.

    Raises
    ------
    ArgumentError
        If the measurement lacks points of the network's grid, is not one wire's or is in siemens,
        if the noise is negative or another argument is out of range, or if prior and measurement
        say different things of a parameter.
    """
    prior = prior_given(prior)
    known = prior if isinstance(prior, Prior) else config_of(prior)
    observation = observation_of(G, known, noise)
    check_progress(progress)
    progress = silent if progress is None else progress
    is_path = checkpoint is None or isinstance(checkpoint, str | Path)
    require(is_path, "checkpoint", "be the path of a file", f"it is {shown(checkpoint)}")
    samples = whole_number_in("samples", samples, 2, 10_000)
    require(samples % 2 == 0, "samples", "be an even number", f"it is {samples}")
    seed = whole_number_in("seed", seed, 0, 2**31)
    discrepancy = whether("discrepancy", discrepancy)
    model, start = network_given(observation, prior, network)
    trained = model if model is None or isinstance(model, TrainedModel) else load_model(model)
    fingerprint = _fingerprint(observation, trained, repr((seed, settings, start)))
    steps = Steps(Checkpoint(checkpoint, fingerprint).cached, progress)
    with threadpool_limits(1, user_api="blas"):  # else the simulation's threads wait for others
        found = invert(observation, trained, seed, settings, steps)
        said, effort = verdict(observation, found), BestEffort(observation, found, True)
        if discrepancy:
            effort = best_effort(observation, found, [seed, Stream.DISCREPANCY], steps)
            found = effort.outcome
        spread = observation.unknowns.site_std(found.answer.covariance)
        misfit = overall_misfit(observation, found.best.data)
        progress(Step(found.attempts - 1, MAPS, 0, misfit, spread))
        result = result_of(effort.observation, found, samples, seed)
    if discrepancy:
        result["discrepancy"] = discrepancy_of(observation, effort)
    result.attrs |= {
        "verdict": said,
        "excess": chi_square_excess(observation, found.best.data),
        "attempts": found.attempts,
        "rounds": found.rounds,
        "start": start,
        "noise": observation.noise,
        "theta": observation.measurement.theta,
        "settings": json.dumps(observation.measurement.stated_settings),
    }
    if isinstance(known, DatasetConfig):
        result.attrs["config_hash"] = known.hash
    return result


def _fingerprint(observation: Observation, trained: TrainedModel | None, options: str) -> bytes:
    """Return all that an inversion depends on."""
    m = observation.measurement
    given = observation.unknowns.prior.to_dict()
    said = json.dumps([SEARCH, given, observation.noise.tolist(), options])
    arrays = m.G, m.mu, m.B, m.bias, np.array(m.theta)
    measured = b"".join(np.ascontiguousarray(x).tobytes() for x in arrays)
    return said.encode() + measured + (b"" if trained is None else trained.fingerprint())
