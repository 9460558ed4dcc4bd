"""Derivatives as differences of exact averages: slow, and good at every temperature.

Near a narrow anticrossing of levels a conductance bends within a fraction of kT: steps are small,
and two of them tell the error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from disorder_landscape.model.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.solver import routes
from disorder_landscape.solver.quadrature import thermal_quadrature

STEPS = {
    "V": 1e-2,
    "mu": 4e-4,
    "B": 6e-4,
    "alpha": 8e-3,
    "barrier_left": 1e-2,
    "barrier_right": 1e-2,
    "g": 2e-2,
    "gamma": 4e-4,
    "delta0": 4e-4,
    "dissipation": 1e-4,
}
"""The larger of two steps in units of each parameter; levels move by no more than 0.4 µeV or so."""
STEP_OF_KT = 0.02
"""That of the bias and of kT, in kT."""
AT_LEAST_ZERO = ("alpha", "g", "gamma", "dissipation")
"""Parameters that may not be negative: next to zero their steps go up alone."""


def difference(
    wire: Nanowire, mu: FloatArray, B: FloatArray, bias: FloatArray, temperature: float, name: str
) -> tuple[FloatArray, FloatArray]:
    """Return the derivatives with respect to a parameter, of a wire without a critical field.

    Returns
    -------
    array, shape (mu, B, bias, 4), with a last axis site by V
        In e²/h per unit of the parameter.
    array, shape (mu, B)
        Their estimated error as a share of the largest.
    """
    point = _Point(wire, mu, B, bias, temperature)
    if name == "V":
        each = [
            _extrapolated(partial(point.average_at_site, n), STEPS[name], upwards=False)
            for n in range(wire.sites)
        ]
        slopes, errors = (np.stack(part, axis=-1) for part in zip(*each, strict=True))
    else:
        kT = BOLTZMANN * temperature
        step = (STEPS | {"bias": STEP_OF_KT * kT, "temperature": STEP_OF_KT * temperature})[name]
        upwards = name in AT_LEAST_ZERO and getattr(wire, name) < step
        slopes, errors = _extrapolated(partial(point.average_at, name), step, upwards)
    over = tuple(range(2, slopes.ndim))
    largest = np.maximum(abs(slopes).max(axis=over), np.finfo(float).tiny)
    return slopes, errors.max(axis=over) / largest


@dataclass(frozen=True)
class _Point:
    """What an average depends on."""

    wire: Nanowire
    mu: FloatArray
    B: FloatArray
    bias: FloatArray
    temperature: float

    def average(self) -> FloatArray:
        """Return the averages, shape (mu, B, bias, 4)."""
        point = self.mu, self.B, self.bias, self.temperature
        # the closed form is good to 1e-6 e²/h or so below the gap, and to 1e-5 where it reaches it
        below = routes.stays_below_gap([self.wire], self.bias, self.temperature)
        average = routes.thermal_average if below else thermal_quadrature
        return np.asarray(average([self.wire], *point).conductance[0])

    def average_at(self, name: str, change: float) -> FloatArray:
        """Return them with a parameter changed."""
        if name in ("mu", "B", "bias", "temperature"):
            changed = {name: getattr(self, name) + change}
            return replace(self, **changed).average()
        if name.startswith("barrier"):
            left, right = self.wire.barrier
            both = (left + change, right) if name == "barrier_left" else (left, right + change)
            return replace(self, wire=replace(self.wire, barrier=both)).average()
        changed = {name: getattr(self.wire, name) + change}
        return replace(self, wire=replace(self.wire, **changed)).average()

    def average_at_site(self, n: int, change: float) -> FloatArray:
        """Return them with one site's V changed."""
        V = self.wire.potential.copy()
        V[n] += change
        return replace(self, wire=replace(self.wire, potential=V)).average()


def _extrapolated(
    average: Callable[[float], FloatArray], step: float, upwards: bool
) -> tuple[FloatArray, FloatArray]:
    """Return the derivative from differences over a step and half of it, and its error."""
    if upwards:
        at = [average(k * step / 2) for k in range(5)]
        whole = (4 * at[2] - 3 * at[0] - at[4]) / (2 * step)
        half = (4 * at[1] - 3 * at[0] - at[2]) / step
    else:
        whole = (average(step) - average(-step)) / (2 * step)
        half = (average(step / 2) - average(-step / 2)) / step
    found = (4 * half - whole) / 3
    return found, abs(found - half)
