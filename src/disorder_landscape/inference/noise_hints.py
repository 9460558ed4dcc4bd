"""Hints at noise that is other than what is stated, or than what a network was trained with."""

from __future__ import annotations

import numpy as np

from disorder_landscape.config import TrainingConfig
from disorder_landscape.inference.optimum import TOLERATED
from disorder_landscape.inference.problem.noise import noise_of_channels
from disorder_landscape.model.parameters import NOISE_FLOOR, FloatArray

UNTRAINED = 2.0
"""A network guesses badly if errors are more than so many times those of its training."""
ALIKE = 1.1
"""Misfits are those of noise if they differ by less than this factor between the channels, …"""
OTHERWISE = 1.25
"""… and that noise is not the stated one if they are more or less than it by this factor. …"""
FAR_LESS = 0.5
"""… If all misfits are less than this share of it, it is not either, whatever they are."""


def noise_hint(training: TrainingConfig, noise: float | dict[str, float]) -> str:
    """Return a line about a network that was trained with smaller errors only, or nothing."""
    most, known = noise_of_channels(noise).max(), training.largest_noise
    if training.noise_up_to is not None or most <= UNTRAINED * max(known, NOISE_FLOOR):
        return ""
    return (
        f"This network was trained with errors of up to {known:g} e²/h: for {most:g} e²/h one of "
        "the models named ..._noisy guesses better, and the inversion takes less time."
    )


def stated_noise_hint(misfit: FloatArray, noise: FloatArray, excess: float) -> str:
    """Return a line about noise that is other than stated; empty without any sign of that.

    What a model lacks makes some channels worse than others; noise makes all alike. Unknowns that
    are about as many as the data explain them whatever the noise is.

    Parameters
    ----------
    misfit, noise : array, shape (channel,)
        In e²/h; NaN where nothing was measured.
    excess : float
        Of χ² above its mean, in its standard deviations.
    """
    there = np.isfinite(misfit) & (noise > 0)
    times = misfit[there] / noise[there]
    if times.size == 0 or abs(excess) < TOLERATED:
        return ""
    if times.max() < FAR_LESS:
        return (
            f"The misfit is {times.max():.2g} times the noise at most: the noise may be smaller "
            "than was stated, and so the error bars."
        )
    if times.max() > ALIKE * times.min():
        return ""
    if 1 / OTHERWISE < times.mean() < OTHERWISE or (times.size == 1 and times.mean() > 1):
        return ""
    other = "larger" if times.mean() > 1 else "smaller, and so the error bars"
    return (
        f"The misfit is {times.mean():.2g} times the noise in all channels alike: the noise "
        f"may be other than was stated: {other}."
    )
