"""A value of ours, and how far chance may have moved it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

import numpy as np
from scipy.stats import sem, t

from disorder_landscape.model.parameters import FloatArray

COVERAGE = 0.95
"""Of an interval."""
FEWEST_SEEDS = 3
"""Two values tell next to nothing of their spread."""


@dataclass(frozen=True)
class Value:
    """A value, and the interval of COVERAGE that it has over seeds, if there are enough."""

    value: float
    interval: tuple[float, float] | None = None

    def scaled(self, factor: float) -> Value:
        """Return it times a positive factor."""
        interval = self.interval and (factor * self.interval[0], factor * self.interval[1])
        return Value(factor * self.value, interval)

    def from_one(self) -> Value:
        """Return it subtracted from one."""
        interval = self.interval and (1 - self.interval[1], 1 - self.interval[0])
        return Value(1 - self.value, interval)


def mean_over_seeds(values: Sequence[float]) -> Value:
    """Return the mean over trainings of other seeds, or over wires, with Student's interval."""
    mean = fmean(values)
    if len(values) < FEWEST_SEEDS:
        return Value(mean)
    half = float(t.ppf((1 + COVERAGE) / 2, len(values) - 1) * sem(values))
    return Value(mean, (mean - half, mean + half))


def with_resampled(value: float | FloatArray, resampled: FloatArray) -> Value:
    """Return a value with the percentiles of what it is for resampled seeds (bootstrap)."""
    tail = (1 - COVERAGE) / 2
    low, high = np.quantile(resampled, [tail, 1 - tail])
    return Value(float(value), (float(low), float(high)))
