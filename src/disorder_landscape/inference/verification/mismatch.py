"""Mismatches of measurements and simulated wires, each at the mean of V that fits best.

The mean of V is none of the paper's labels (S-II.1: it has a standard deviation of 0.01 meV), so
that a prediction may lack it. It acts as a shift of μ, which an experiment would calibrate, and
moves levels by more than kT. So each wire is compared at the shift within ±0.03 meV that fits
best. The shift is found with the measurements at θ = 0, where there are any, since they are
simulated faster.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.verification.comparison import scores
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.observables.conductance import conductance

FINER = np.linspace(-0.8, 0.8, 9)
"""Means of V that are tried around the best one, in units of the step before, which is about kT."""


def simulations(wires: int, measured: Sequence[Measurement], shifts: FloatArray) -> int:
    """Return how many pairs (μ, B) `mean_squares` simulates."""
    tries = np.where(_decide(measured), shifts.size + _finer(shifts).size, 1)
    pairs = np.array([m.mu.size * m.B.size for m in measured])
    return wires * int(tries @ pairs)


def mean_squares(
    wires: Sequence[Nanowire],
    measured: Sequence[Measurement],
    shifts: FloatArray,
    noise: FloatArray,
    progress: Callable[[int], None],
) -> tuple[FloatArray, FloatArray]:
    """Return mean squared differences, and the means of V at which they are the least.

    Parameters
    ----------
    wires : sequence of Nanowire
        The predicted one first, then those with wrong disorder.
    measured : sequence of Measurement
    shifts : array, shape (shift,)
        Means of V in meV that are tried, increasing.
    noise : array, shape (measurement, channel)
        Standard deviations of errors in e²/h.
    progress : callable
        Called with the number of pairs (μ, B) that have just been simulated.

    Returns
    -------
    array, shape (wire, measurement, channel)
        In (e²/h)², NaN where nothing was measured.
    array, shape (wire,)
        In meV.
    """
    deciding = _decide(measured)
    finer = _finer(shifts)
    first = [m for m, decides in zip(measured, deciding, strict=True) if decides]
    found = np.array([_of_wire(wire, first, shifts, progress) for wire in wires])
    typical = np.sqrt(np.median(found[1:], axis=(0, 1)))
    squares = np.empty((len(wires), len(measured), len(CONDUCTANCES)))
    best = np.empty(len(wires))
    for w, wire in enumerate(wires):
        coarse = shifts[scores(found[w], typical, noise[deciding]).argmin()]
        tried = np.append(shifts, coarse + finer)
        further = _of_wire(wire, first, coarse + finer, progress)
        at_tried = np.concatenate([found[w], further])
        chosen = scores(at_tried, typical, noise[deciding]).argmin()
        best[w], squares[w, deciding] = tried[chosen], at_tried[chosen]
        others = [m for m, decides in zip(measured, deciding, strict=True) if not decides]
        squares[w, ~deciding] = _of_wire(wire, others, best[w : w + 1], progress)[0]
    return squares, best


def _decide(measured: Sequence[Measurement]) -> NDArray[np.bool_]:
    """Return which measurements decide on the shift, shape (measurement,)."""
    tilted = np.array([m.theta != 0 for m in measured])
    return np.asarray(tilted == tilted.all())


def _finer(shifts: FloatArray) -> FloatArray:
    return FINER * np.diff(shifts).min() if shifts.size > 1 else np.empty(0)


def _of_wire(
    wire: Nanowire,
    measured: Sequence[Measurement],
    shifts: FloatArray,
    progress: Callable[[int], None],
) -> FloatArray:
    """Return mean squared differences of a wire, shape (shift, measurement, channel)."""
    squares = np.empty((shifts.size, len(measured), len(CONDUCTANCES)))
    for i, m in enumerate(measured if shifts.size else []):
        shifted = np.round(m.mu - shifts[:, None], 9)  # V + δ at μ is V at μ − δ
        mu, back = np.unique(shifted, return_inverse=True)
        here = replace(wire, barrier=m.barrier)
        found = conductance(here, mu, m.B, m.bias, m.temperature, theta=m.theta)
        for c, name in enumerate(CONDUCTANCES):
            simulated = found[name].to_numpy()[back.reshape(shifted.shape)]
            off = (simulated - m.G[..., c])[:, np.isfinite(m.G[..., c])]
            squares[:, i, c] = (off**2).mean(axis=1) if off.size else np.nan
        progress(shifted.size * m.B.size)
    return squares
