"""The isolated wire reduced to its two end sites, in complex arithmetic, many lanes at once.

The counterpart of `recursion` (same frame, units and order) for energies above the gap, where Σ(ω)
is complex: rows instead of sites are eliminated, in loops instead of written-out scalars. Im M is
positive definite there, so elimination needs no pivoting; where M is real, or almost, the largest
inverse pivot and the products of |C| tell how many digits were lost, as in `recursion`.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.recursion import LOOK_EVERY

WIDTH = 16
"""(μ, ω) pairs that one call advances together."""


@nb.njit(cache=True, fastmath={"contract", "nsz", "arcp"}, error_model="numpy")
def _eliminate_row(
    s: FloatArray, k: int, sign: float, growth: FloatArray
) -> None:  # pragma: no cover
    """Eliminate row k and put its partner on the next site, still without A, in its place."""
    L = WIDTH
    p, w, column = np.empty(2 * L), np.empty(2 * L), np.empty((8, 2 * L))
    pivot = s[18 * k * L : (18 * k + 2) * L]
    for l in range(L):
        norm = 1.0 / (pivot[l] ** 2 + pivot[L + l] ** 2)
        growth[l] = max(growth[l], norm)
        p[l], p[L + l] = pivot[l] * norm, -pivot[L + l] * norm
    for a in range(8):
        at = (16 * min(a, k) + 2 * max(a, k)) * L
        column[a] = s[at : at + 2 * L]
    for a in range(8):
        if a == k:
            continue
        u = column[a]
        for l in range(L):
            w[l] = u[l] * p[l] - u[L + l] * p[L + l]
            w[L + l] = u[l] * p[L + l] + u[L + l] * p[l]
        for b in range(a, 8):
            at = (16 * a + 2 * b) * L
            # slices, so that the compiler sees no index that could be negative, and vectorises
            entry, v = s[at : at + 2 * L], column[b]
            for l in range(L):
                entry[l] -= w[l] * v[l] - w[L + l] * v[L + l]
                entry[L + l] -= w[l] * v[L + l] + w[L + l] * v[l]
        at = (16 * min(a, k) + 2 * max(a, k)) * L
        entry = s[at : at + 2 * L]
        for l in range(2 * L):
            entry[l] = -sign * w[l]
    for l in range(2 * L):
        pivot[l] = -p[l]


@nb.njit(cache=True)
def _add_onsite_row(
    s: FloatArray, k: int, sign: float, V: float, x: float, z: float, terms: FloatArray
) -> None:  # pragma: no cover
    """Add the onsite terms between row k and itself and the rows of its site before it."""
    L, kk = WIDTH, 18 * k * WIDTH
    for l in range(L):
        s[kk + l] += terms[1, l] - sign * (terms[0, l] + V) - (z if k % 2 == 0 else -z)
        s[kk + L + l] += terms[2, l]
    if k % 2 == 1:
        for l in range(L):
            s[kk - 16 * L + l] -= x
    if k % 4 >= 2:
        for l in range(L):
            s[kk - 32 * L + l] += terms[3, l]
            s[kk - 31 * L + l] += terms[4, l]


@nb.njit(cache=True)
def look_at_coupling(
    s: FloatArray, last: FloatArray, growth: FloatArray
) -> None:  # pragma: no cover
    """Count the product of the largest |C|² at the last look and now among the lost digits."""
    L = WIDTH
    for l in range(L):
        now = 0.0
        for a in range(4):
            for b in range(4, 8):
                at = (16 * a + 2 * b) * L + l
                now = max(now, s[at] ** 2 + s[at + L] ** 2)
        growth[l] = max(growth[l], last[l] * now)
        last[l] = now


@nb.njit(cache=True)
def eliminate_inner_sites_complex(
    V: FloatArray,
    zeeman_x: FloatArray,
    zeeman_z: FloatArray,
    terms: FloatArray,
    s: FloatArray,
    growth: FloatArray,
) -> None:  # pragma: no cover
    """Reduce M of the isolated wire to its two end sites, for WIDTH lanes.

    Row after row is eliminated. A row couples to its partner on the next site alone, by ±1, so the
    partner takes its place in the matrix: with w the column of the pivot k, p the pivot's inverse
    and A the onsite block of the next site,

        s_ab ← s_ab − w_a p w_b,   s_ak ← A_ak ∓ w_a p,   s_kk ← A_kk − p.

    Parameters
    ----------
    V, zeeman_x, zeeman_z : array, shape (site,)
    terms : array, shape (5, WIDTH)
        The kinetic term, real and imaginary part of the normal and of the anomalous one.
    s : array, shape (128 · WIDTH,)
        On return the 8×8 matrix, left end first; entry (a, b), a ≤ b, of lane l has its real part
        at [(16a + 2b)·WIDTH + l] and its imaginary part WIDTH further on.
    growth : array, shape (WIDTH,)
        On return the largest |p|², or product of the largest |C|² at one look and at the next.
    """
    s[:] = 0.0
    growth[:] = 0.0
    coupling = np.ones(WIDTH)
    for site in range(V.size):
        for i in range(4):
            k, sign = (i if site == 0 else i + 4), (1.0 if i < 2 else -1.0)
            if site == 1:
                s[(18 * i + 8) * WIDTH : (18 * i + 9) * WIDTH] = sign  # entry (i, i + 4)
            elif site > 1:
                _eliminate_row(s, k, sign, growth)
            _add_onsite_row(s, k, sign, V[site], zeeman_x[site], zeeman_z[site], terms)
        if site > 1 and (site % LOOK_EVERY == 0 or site == V.size - 1):
            look_at_coupling(s, coupling, growth)
