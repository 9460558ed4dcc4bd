"""Which poles the wire with its leads has: none lost, none met twice.

Particle–hole symmetry, G(−ω*) = −C G(ω)* C, pairs a pole z, v with −z*, C v*: only those with
Re z ≥ 0 are worked out. Two poles meet on the imaginary axis and part along it; near there the
iteration takes most care.
"""

from __future__ import annotations

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.dressing import ENDS, Leads, Levels
from disorder_landscape.physics.inverse_iteration import CENTRAL, FAINT, Batch, Poles, iterate

EQUAL = 1e-4
"""Poles nearer than this part of their width are one, of two vectors."""
BESIDE = 0.1
"""The other pole on the axis is looked for off the one found, by this part of its width."""


@nb.njit(cache=True)
def _product(poles: Poles, leads: Leads, k: int, m: int) -> complex:  # pragma: no cover
    """Return x_kᵀ(1 − H')x_m."""
    x, y = poles.x[k], poles.x[m]
    re = im = 0.0
    for n in range(x.shape[1]):
        re += x[0, n] * y[0, n] - x[1, n] * y[1, n] + x[2, n] * y[2, n] - x[3, n] * y[3, n]
        im += x[0, n] * y[1, n] + x[1, n] * y[0, n] + x[2, n] * y[3, n] + x[3, n] * y[2, n]
    total, z = complex(re, im), poles.z[k]
    for end in range(2):
        for i in range(4):
            for j in range(4):
                slope = leads.inverse[1, end, i, j] + z * (
                    2 * leads.inverse[2, end, i, j] + 3 * z * leads.inverse[3, end, i, j]
                )
                total += poles.t[k, ENDS[end, i]] * slope * poles.t[m, ENDS[end, j]]
    return total


@nb.njit(cache=True)
def _orthogonalise(poles: Poles, leads: Leads, k: int, at: int) -> float:  # pragma: no cover
    """Take vector `at` out of vector k; return how much of it is left, as a share of its square."""
    overlap = _product(poles, leads, k, at) / poles.norm[at]
    before = after = 0.0
    x, y = poles.x[k], poles.x[at]
    for part in range(0, 4, 2):
        for m in range(x.shape[1]):
            own = complex(x[part, m], x[part + 1, m])
            new = own - overlap * complex(y[part, m], y[part + 1, m])
            before += own.real**2 + own.imag**2
            after += new.real**2 + new.imag**2
            x[part, m], x[part + 1, m] = new.real, new.imag
    for i in range(8):
        poles.t[k, i] -= overlap * poles.t[at, i]
    poles.norm[k] = _product(poles, leads, k, k)
    return after / before


@nb.njit(cache=True)
def _reflect(poles: Poles, k: int) -> None:  # pragma: no cover
    """Replace a pole by its mirror image −z*, of C v*: ±E change places, and t turns to −C t*."""
    poles.z[k] = -np.conj(poles.z[k])
    poles.norm[k] = np.conj(poles.norm[k])
    x = poles.x[k]
    for n in range(x.shape[1]):
        x[0, n], x[2, n] = x[2, n], x[0, n]
        x[1, n], x[3, n] = -x[3, n], -x[1, n]
    for i in range(4):
        poles.t[k, i] = -np.conj(poles.t[k, i])
        poles.t[k, 4 + i] = np.conj(poles.t[k, 4 + i])


@nb.njit(cache=True, error_model="numpy")
def right_half(
    poles: Poles, leads: Leads
) -> tuple[NDArray[np.int64], int, int, int]:  # pragma: no cover
    """Return the poles with mirror images, how many there are, and behind them those without.

    A pole in the left half stands for its mirror image; one that did not converge is left out: near
    the axis another's image may stand for it. Vectors of equal poles (Kramers pairs at
    B = 0) are made orthogonal; one that is not new is left out: of these also returns the last
    central one, and which it equals, or −1.
    """
    z = poles.z
    order = np.empty(z.size, dtype=np.int64)
    found, paired, again, twin = 0, 0, -1, -1
    for central in range(2):
        for k in range(z.size):
            if (abs(z[k].real) <= CENTRAL) != (central == 1) or np.isnan(poles.norm[k]):
                continue
            if z[k].real < -CENTRAL:
                _reflect(poles, k)
            kept = 1.0
            for m in range(found):
                at = order[m]
                faint = abs(z[k].imag) < FAINT  # it may stand twice: it carries nothing
                if not faint and abs(z[at] - z[k]) < EQUAL * abs(z[k].imag):
                    kept = min(kept, _orthogonalise(poles, leads, k, at))
                    if central == 1 and not kept > 0.1:
                        again, twin = k, at
            if kept > 0.1:
                order[found] = k
                found += 1
        if central == 0:
            paired = found
    return order[:found], paired, again, twin


@nb.njit(cache=True, error_model="numpy")
def find_poles(
    start: Poles, both: int, levels: Levels, leads: Leads, b: Batch
) -> tuple[Poles, NDArray[np.int64], int]:  # pragma: no cover
    """Iterate the poles of `start_poles`; return them, their order, and how many have images.

    Where two starts have ended at one pole of the imaginary axis, the other one is looked for on
    either side of it. The order is empty if a pole was lost, or met twice.
    """
    poles = Poles(start.z.copy(), start.x.copy(), start.t, start.norm)
    iterate(poles, np.arange(start.z.size), levels, leads, b)
    order, paired, again, twin = right_half(poles, leads)
    if paired + order.size == both:
        return poles, order, paired
    if again >= 0 and paired + order.size == both - 1:
        for side in (1.0 - BESIDE, 1.0 + BESIDE):
            poles.z[again] = poles.z[twin] * side
            poles.x[again], poles.t[again] = start.x[again], 0.0
            _orthogonalise(poles, leads, again, twin)
            iterate(poles, np.full(1, again), levels, leads, b)
            whole, with_images, _, _ = right_half(poles, leads)
            if with_images + whole.size == both:
                return poles, whole, with_images
    return poles, order[:0], 0
