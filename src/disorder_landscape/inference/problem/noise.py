"""The errors of measured conductances: what is stated of them, and the solver's own."""

from __future__ import annotations

from collections.abc import Container, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from disorder_landscape.arguments import number_in, numbers_of, reals, require
from disorder_landscape.model.parameters import NOISE_FLOOR, FloatArray
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.solver import compiled

SOLVER_ERROR = compiled.core.TOLERANCE
"""In e²/h: the error of the simulation. Smaller noise makes no difference."""
LARGEST_NOISE = 1.0
"""In e²/h, that is accepted."""
_MUST = f"be one number in e²/h, or one for each of {', '.join(CONDUCTANCES)}"


def errors_variance(noise: ArrayLike) -> FloatArray:
    """Return the variance in (e²/h)² of noise, in e²/h, and of the solver's own error together."""
    return np.asarray(noise) ** 2 + SOLVER_ERROR**2


def stated_noise(attrs: Mapping[Any, Any], usual: float = NOISE_FLOOR) -> float | dict[str, float]:
    """Return the noise that a measurement states: one number, one of each channel, or the usual."""
    noise = np.atleast_1d(reals("noise", attrs.get("noise", usual), _MUST)).tolist()
    one_or_all = len(noise) in (1, len(CONDUCTANCES))
    require(one_or_all, "noise", _MUST, f"the measurement states {len(noise)}")
    return _one_or_each(noise)


def parse_noise(text: str) -> float | dict[str, float]:
    """Return the noise that "0.01" or "0.01,0.01,0.001,0.001" describes.

    Raises
    ------
    ArgumentError
        If the text is something else.
    """
    return _one_or_each(numbers_of("noise", text, (1, len(CONDUCTANCES)), _MUST))


def noise_of_channels(
    noise: float | Mapping[str, float], measured: Container[Any] = CONDUCTANCES
) -> FloatArray:
    """Return the standard deviation of each channel's errors in e²/h, shape (channel,).

    Where each has its own, those that were not measured need none.

    Raises
    ------
    ArgumentError
        If it is negative or no number, or not given for each channel.
    """
    if not isinstance(noise, Mapping):
        return np.full(len(CONDUCTANCES), _checked(noise))
    but = f"it is for {', '.join(map(str, noise))}"
    noise = {name: 0.0 for name in CONDUCTANCES if name not in measured} | dict(noise)
    require(set(noise) == set(CONDUCTANCES), "noise", _MUST, but)
    return np.array([_checked(noise[name]) for name in CONDUCTANCES])


def _one_or_each(noise: list[float]) -> float | dict[str, float]:
    """Return one number, or one by the name of each channel, from a list of them."""
    return noise[0] if len(noise) == 1 else dict(zip(CONDUCTANCES, noise, strict=True))


def _checked(noise: object) -> float:
    return number_in("noise", noise, 0.0, LARGEST_NOISE, "e²/h")
