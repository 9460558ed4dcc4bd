"""Whether predicted disorder explains measurements that the network never saw (K'_full of S-II.1).

"Our method's disorder prediction can be verified through the use of additional conductance
measurements": at other μ, B, bias, barriers or angle θ of the field. The predicted wire is
simulated at those settings and compared with the measurement. So are wires with random disorder of
the same model, the controls. If a prediction explains no more than they do, it is wrong, or the
model is. The result of an inversion allows a stricter test: whether the posterior predicts the
measurements within their noise.

Each wire, control or not, is compared at the mean of V that fits best (`mismatch`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import (
    ArgumentError,
    check_progress,
    grid_in,
    require,
    shown,
    whole_number_in,
)
from disorder_landscape.config import DatasetConfig
from disorder_landscape.inference.defaults import CONTROLS, SHIFTS
from disorder_landscape.inference.problem.noise import noise_of_channels, stated_noise
from disorder_landscape.inference.verification.compared import compared
from disorder_landscape.inference.verification.comparison import SIGNIFICANCE, comparison
from disorder_landscape.inference.verification.mismatch import mean_squares, simulations
from disorder_landscape.inference.verification.predictive import p_of_samples
from disorder_landscape.observables.grids import Progress


def verify(
    prediction: xr.Dataset,
    measurements: xr.Dataset | Sequence[xr.Dataset],
    noise: float | Mapping[str, float] | None = None,
    controls: int = CONTROLS,
    seed: int = 0,
    config: DatasetConfig | None = None,
    shifts: ArrayLike = SHIFTS,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Compare measurements with what the predicted wire would show, and with wrong disorder.

    Parameters
    ----------
    prediction : Dataset
        potential (site) in meV and alpha in meV nm of one wire, as `predict` returns them; or what
        `infer` returns, whose mean is taken.
    measurements : Dataset or sequence of them
        G_LL … G_RL in e²/h with dims (mu, B, bias) in any order, and the attributes theta
        (radians), barrier (left and right, meV) and temperature (K), as `conductance` returns them.
        Channels, and single numbers, may be missing (NaN). Of an inversion the first axis is
        that of its measurement, mu or gate. Temperature and barriers that are missing, or stated as
        they were for it, are what it has found.
    noise : float or mapping
        Standard deviation of the measured conductances' errors in e²/h, or of each channel's. By
        default the attribute noise of each measurement, or none.
    controls : int
        How many wires with random disorder; at least 19, so that p can fall to 0.05.
    seed : int
        Of the controls.
    config : DatasetConfig, optional
        Disorder model of the network, from which controls are drawn; by default the paper's with
        the prediction's number of sites and of components. Of an inversion controls are as it has
        found the wire but for disorder and α, which are by default of its prior.
    shifts : array, shape (shift,)
        Means of V in meV that are tried, increasing, with finer steps around the best one then;
        0 takes the potentials as they are.
    progress : callable, optional
        Called with the number of pairs (μ, B) that have just been simulated, and that of all pairs.

    Returns
    -------
    xarray.Dataset
        mismatch and control_mismatch: root-mean-square differences in e²/h, dims (measurement,
        channel) and (control, measurement, channel); ratio (measurement, channel), of the first to
        the median of the second; score and control_score (control), the ratios' root mean square
        over measurements and channels; shift and control_shift (control) in meV; p_value, the
        chance that wrong disorder scores as well; the sentence verdict as attribute. Channels in
        which wrong disorder differs by no more than the noise have no weight in the scores. Of an
        inversion, p_samples: the posterior predictive p-value of the measurements, NaN where it has
        fewer than 49 samples. What is said of a channel is NaN where it was not measured.

    Raises
    ------
    ArgumentError
        If the prediction or a measurement is not one wire's, lacks a variable or an
        attribute, if an older version of `infer` made the prediction, if the settings cannot be
        simulated, or another argument is out of range.
    """
    check_progress(progress)
    must = "be one Dataset or more"
    try:
        given = [measurements] if isinstance(measurements, xr.Dataset) else list(measurements)
    except TypeError:
        raise ArgumentError("measurement", must, f"it is {shown(measurements)}") from None
    require(bool(given), "measurement", must, "there is none")
    known = config is None or isinstance(config, DatasetConfig)
    require(known, "config", "be a DatasetConfig", f"it is {shown(config)}")
    controls = whole_number_in("controls", controls, round(1 / SIGNIFICANCE) - 1, 10_000)
    seed = whole_number_in("seed", seed, 0, 2**63)
    tried = grid_in("shifts", shifts, -1.0, 1.0, "meV")
    wires, measured, samples = compared(prediction, given, controls, seed, config)
    stated = [stated_noise(dataset.attrs, 0.0) if noise is None else noise for dataset in given]
    noises = [noise_of_channels(one, of) for one, of in zip(stated, given, strict=True)]
    there = np.array([m.has_channel for m in measured])
    errors = np.where(there, noises, np.nan)
    of_samples = len(samples or ()) * sum(m.mu.size * m.B.size for m in measured)
    in_all = simulations(len(wires), measured, tried) + of_samples

    def report(done: int) -> None:
        if progress is not None:
            progress(done, in_all)

    squares, shift = mean_squares(wires, measured, tried, errors, report)
    result = comparison(np.sqrt(squares), shift, errors)
    if samples is not None:
        p = p_of_samples(samples, measured, errors, np.random.default_rng([seed, 2]), report)
        result["p_samples"] = ((), p, {"units": "1"})
    return result
