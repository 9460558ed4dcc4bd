"""What is believed of one parameter before the measurement: known, uniform or normal.

Each is a function of a standard normal number ξ, so that all unknowns together are white noise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtr, ndtri

from disorder_landscape.arguments import ArgumentError, number_in, reals, require, shown
from disorder_landscape.model.parameters import FloatArray

LARGEST = 1e9
"""Mean or standard deviation that may be stated: more than any parameter may be."""
FARTHEST, LEAST = 5.0, 3.0
"""Values are taken for no more than so many standard deviations off, which is one in 2 million; and
for no more than the second, which is one in 400, where the parameter's range ends there."""


@dataclass(frozen=True)
class Uniform:
    """Any number between two is as likely."""

    low: float
    high: float

    @property
    def range(self) -> tuple[float, float]:
        """The least and the largest value."""
        return self.low, self.high

    @property
    def mean(self) -> float:
        """The middle."""
        return (self.low + self.high) / 2

    @property
    def std(self) -> float:
        """The standard deviation."""
        return float((self.high - self.low) / np.sqrt(12))

    def value(self, xi: ArrayLike) -> FloatArray:
        """Return the values that standard normal numbers stand for."""
        return np.asarray(self.low + (self.high - self.low) * ndtr(_within(xi)))

    def slope(self, xi: ArrayLike) -> FloatArray:
        """Return the derivatives of the values."""
        density = np.exp(-0.5 * np.square(_within(xi))) / np.sqrt(2 * np.pi)
        return np.asarray((self.high - self.low) * density)

    def standard(self, value: ArrayLike) -> FloatArray:
        """Return the standard normal numbers of values; of those outside, the farthest."""
        share = (np.asarray(value) - self.low) / (self.high - self.low)
        return _within(ndtri(np.clip(share, 0.0, 1.0)))


@dataclass(frozen=True)
class Normal:
    """A normal distribution, cut where it is next to nothing: five standard deviations away.

    A prior cuts it where the parameter's range ends, if that is three or more away from the mean.

    Raises
    ------
    ArgumentError
        If mean or standard deviation are no numbers, or too large.
    """

    mean: float
    std: float
    limits: tuple[float, float] = field(
        default=(-np.inf, np.inf), init=False, repr=False, compare=False
    )

    def __post_init__(self) -> None:
        for name, value in _moments("", self.mean, self.std).items():
            object.__setattr__(self, name, value)

    @property
    def range(self) -> tuple[float, float]:
        """The least and the largest value."""
        low, high = self.value([-FARTHEST, FARTHEST]).tolist()
        return low, high

    def value(self, xi: ArrayLike) -> FloatArray:
        """Return the values that standard normal numbers stand for."""
        return np.clip(self.mean + self.std * _within(xi), *self.limits)

    def slope(self, xi: ArrayLike) -> FloatArray:
        """Return the derivatives of the values."""
        return np.full(np.shape(xi), self.std)

    def standard(self, value: ArrayLike) -> FloatArray:
        """Return the standard normal numbers of values; of those outside, the farthest."""
        return _within((np.asarray(value) - self.mean) / self.std)

    def cut_to(self, low: float, high: float) -> Normal:
        """Return it cut where a range ends, if that is far enough from the mean."""
        found = Normal(self.mean, self.std)
        if min(self.mean - low, high - self.mean) >= LEAST * self.std * (1 - 1e-9):
            object.__setattr__(found, "limits", (low, high))
        return found


Distribution = Uniform | Normal
Belief = float | Distribution
"""Of one parameter: its value, if it is known."""


def _within(xi: ArrayLike) -> FloatArray:
    return np.clip(xi, -FARTHEST, FARTHEST)


def _moments(of: str, mean: object, std: object) -> dict[str, float]:
    """Return mean and standard deviation, checked, of something whose name comes before theirs."""
    return {
        "mean": number_in(f"{of}mean", mean, -LARGEST, LARGEST),
        "std": number_in(f"{of}std", std, 0.0, LARGEST),
    }


def belief_of(name: str, given: object, low: float, high: float, unit: str) -> Belief:
    """Return what a number, a pair or a mapping of mean and std says of a parameter.

    Raises
    ------
    ArgumentError
        If it is something else, or reaches beyond [low, high].
    """
    must = "be a number, a pair (low, high), or a normal distribution (mean and std)"
    if isinstance(given, Mapping):
        require(set(given) == {"mean", "std"}, name, must, f"it is {shown(dict(given))}")
        given = Normal(**_moments(f"{name}.", given["mean"], given["std"]))
    if isinstance(given, tuple | list):
        pair = reals(name, given, must)
        require(pair.shape == (2,), name, must, f"it is {shown(given)}")
        is_range = bool(np.isfinite(pair).all() and pair[0] < pair[1])
        ordered = "be a pair (low, high) of finite numbers, the smaller one first"
        require(is_range, name, ordered, f"they are {pair[0]:g} and {pair[1]:g}")
        given = Uniform(*pair.tolist())
    if not isinstance(given, Uniform | Normal):
        try:
            return number_in(name, given, low, high, unit)
        except ArgumentError as error:
            if np.ndim(given) == 0 and not isinstance(given, str | None):  # type: ignore[arg-type]
                raise
            raise ArgumentError(name, must, f"it is {shown(given)}") from error
    if isinstance(given, Normal):
        given = given.cut_to(low, high)
    least, most = given.range
    wide = bool(np.isfinite([least, most]).all()) and least < most
    require(wide, name, "be a distribution of some width", f"it is {shown(given)}")
    within = f"stay from {low:g} to {high:g} {unit}".rstrip()
    reaches = f"it reaches from {least:g} to {most:g}"
    if isinstance(given, Normal):
        reaches += f", and the nearer end is within {LEAST:g} std: give a pair (low, high) instead"
    require(low <= least and most <= high, name, within, reaches)
    return given
