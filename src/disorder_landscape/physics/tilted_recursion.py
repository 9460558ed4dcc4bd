"""The isolated wire reduced to its two end sites in a tilted field, many lanes at once.

The counterpart of `recursion` (same frame, units and order) for θ ≠ 0, row by row. The component of
the field along the spin–orbit axis commutes with the rotation of the spin from site to site, so it
stays what it is, V_Z sin θ σy. Below the gap M is Hermitian then and above it neither Hermitian nor
symmetric: all 64 entries are kept, and one routine serves both sides.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.recursion import LOOK_EVERY

WIDTH = 16
"""(μ, ω) pairs that one call advances together."""


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


@nb.njit(cache=True, fastmath={"contract", "nsz", "arcp"}, error_model="numpy")
def _eliminate_row(
    s: FloatArray, k: int, sign: float, growth: FloatArray
) -> None:  # pragma: no cover
    """Eliminate row k and put its partner on the next site, still without A, in its place."""
    L = WIDTH
    p, w, row = np.empty(2 * L), np.empty(2 * L), np.empty((8, 2 * L))
    pivot = s[18 * k * L : (18 * k + 2) * L]
    for l in range(L):
        norm = 1.0 / (pivot[l] ** 2 + pivot[L + l] ** 2)
        growth[l] = max(growth[l], norm)
        p[l], p[L + l] = pivot[l] * norm, -pivot[L + l] * norm
    for b in range(8):
        at = (16 * k + 2 * b) * L
        row[b] = s[at : at + 2 * L]
    for a in range(8):
        if a == k:
            continue
        at = (16 * a + 2 * k) * L
        u = s[at : at + 2 * L]
        for l in range(L):
            w[l] = u[l] * p[l] - u[L + l] * p[L + l]
            w[L + l] = u[l] * p[L + l] + u[L + l] * p[l]
        for b in range(8):
            if b == k:
                continue
            at = (16 * a + 2 * b) * L
            # slices, so that the compiler sees no index that could be negative, and vectorises
            entry, v = s[at : at + 2 * L], row[b]
            for l in range(L):
                entry[l] -= w[l] * v[l] - w[L + l] * v[L + l]
                entry[L + l] -= w[l] * v[L + l] + w[L + l] * v[l]
        for l in range(2 * L):
            u[l] = -sign * w[l]
    for b in range(8):
        if b == k:
            continue
        at = (16 * k + 2 * b) * L
        entry, v = s[at : at + 2 * L], row[b]
        for l in range(L):
            entry[l] = -sign * (v[l] * p[l] - v[L + l] * p[L + l])
            entry[L + l] = -sign * (v[l] * p[L + l] + v[L + l] * p[l])
    for l in range(2 * L):
        pivot[l] = -p[l]


@nb.njit(cache=True)
def _add_onsite_row(
    s: FloatArray, k: int, sign: float, V: float, field: FloatArray, terms: FloatArray
) -> None:  # pragma: no cover
    """Add the onsite terms between row k and itself and the rows of its site before it."""
    L, kk = WIDTH, 18 * k * WIDTH
    x, y, z = field
    for l in range(L):
        s[kk + l] += terms[1, l] - sign * (terms[0, l] + V) - (z if k % 2 == 0 else -z)
        s[kk + L + l] += terms[2, l]
    if k % 2 == 1:  # entries (k − 1, k) and (k, k − 1) of −xσx − yσy
        for l in range(L):
            s[kk - 16 * L + l] -= x
            s[kk - 15 * L + l] += y
            s[kk - 2 * L + l] -= x
            s[kk - L + l] -= y
    if k % 4 >= 2:
        for l in range(L):
            s[kk - 32 * L + l] += terms[3, l]
            s[kk - 31 * L + l] += terms[4, l]
            s[kk - 4 * L + l] += terms[3, l]
            s[kk - 3 * L + l] += terms[4, l]


@nb.njit(cache=True)
def eliminate_inner_sites_tilted(
    V: FloatArray, field: FloatArray, terms: FloatArray, s: FloatArray, growth: FloatArray
) -> None:  # pragma: no cover
    """Reduce M of the isolated wire to its two end sites, for WIDTH lanes.

    Row after row is eliminated. A row couples to its partner on the next site alone, by ±1, so the
    partner takes its place in the matrix: with u the column and v the row of the pivot k, p the
    pivot's inverse and A the onsite block of the next site,

        s_ab ← s_ab − u_a p v_b,   s_ak ← A_ak ∓ u_a p,   s_kb ← A_kb ∓ p v_b,   s_kk ← A_kk − p.

    Parameters
    ----------
    V : array, shape (site,)
    field : array, shape (site, 3)
        The Zeeman term's components x, y, z in the rotated frame.
    terms : array, shape (5, WIDTH)
        The kinetic term, real and imaginary part of the normal and of the anomalous one.
    s : array, shape (128 · WIDTH,)
        On return the 8×8 matrix, left end first; entry (a, b) of lane l has its real part at
        [(16a + 2b)·WIDTH + l] and its imaginary part WIDTH further on.
    growth : array, shape (WIDTH,)
        On return the largest |p|², or product of the largest |C|² at one look and at the next.
    """
    s[:] = 0.0
    growth[:] = 0.0
    coupling = np.ones(WIDTH)
    for site in range(V.size):
        for i in range(4):
            k, sign = (i if site == 0 else i + 4), (1.0 if i < 2 else -1.0)
            if site == 1:  # entries (i, i + 4) and (i + 4, i)
                s[(18 * i + 8) * WIDTH : (18 * i + 9) * WIDTH] = sign
                s[(18 * i + 64) * WIDTH : (18 * i + 65) * WIDTH] = sign
            elif site > 1:
                _eliminate_row(s, k, sign, growth)
            _add_onsite_row(s, k, sign, V[site], field[site], terms)
        if site > 1 and (site % LOOK_EVERY == 0 or site == V.size - 1):
            look_at_coupling(s, coupling, growth)
