"""Errors of measurement: what R² a network keeps when the conductances of the test set have them.

The paper: Gaussian errors of 0.01, 0.05 and 0.1 e²/h leave R² = 0.99, 0.98 and 0.97. It does not
say whether the training data had errors too, so both are measured, and local and nonlocal
conductances apart.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from disorder_landscape.learning.metrics import score
from disorder_landscape.learning.model import TrainedModel
from disorder_landscape.learning.scaling import (
    CHANNELS,
    ConductanceArray,
    conductance_array,
    label_array,
)

NOISE = (0.0, 0.001, 0.01, 0.05, 0.1)
"""Standard deviations in e²/h; 0.001 is the noise floor of the experiment that the paper cites."""
CHANNELS_WITH_ERRORS = {
    "all": CHANNELS,
    "local": ("G_LL", "G_RR"),
    "nonlocal": ("G_LR", "G_RL"),
}


def with_errors(
    X: ConductanceArray, noise: float, channels: tuple[str, ...] = CHANNELS, seed: int = 0
) -> ConductanceArray:
    """Return conductances with independent Gaussian errors on some channels.

    Parameters
    ----------
    X : array, shape (…, channel)
        In e²/h.
    noise : float
        Standard deviation in e²/h.
    channels : tuple of str
        Which have errors.
    seed : int
        The errors are a function of it and of the shape alone.
    """
    errors = np.random.default_rng(seed).standard_normal(X.shape, dtype=np.float32)
    on = np.array([name in channels for name in CHANNELS], dtype=np.float32)
    return np.asarray(X + np.float32(noise) * on * errors)


def r2_with_errors(model: TrainedModel, test: xr.Dataset, seed: int = 0) -> xr.Dataset:
    """Return R² of a network over the errors of its test set's conductances.

    Parameters
    ----------
    model : TrainedModel
    test : Dataset
        Conductances with a dim realization, components and alpha, as `chain.read_test_set` gives.
    seed : int
        Of the errors.

    Returns
    -------
    xarray.Dataset
        R2 (channels, noise), noise in e²/h.
    """
    dataset = model.config.dataset
    X, Y = conductance_array(test), label_array(test, model.labels.names)
    R2 = np.array(
        [
            [
                score(
                    Y,
                    model.predict_labels(with_errors(X, noise, channels, seed)),
                    model.labels,
                    dataset.sites,
                ).r2
                for noise in NOISE
            ]
            for channels in CHANNELS_WITH_ERRORS.values()
        ]
    )
    return xr.Dataset(
        {"R2": (("channels", "noise"), R2)},
        coords={"channels": list(CHANNELS_WITH_ERRORS), "noise": list(NOISE)},
    )
