"""How a wire's end blocks answer to every site: two real sweeps, then one contraction per site.

M = (ω − H)/t' of `recursion`, reduced to its two end sites, is M' = Xᵀ M X, where X_n = [P_n Q_n]
is the wave at site n that the left or the right end site drives while the other is held at zero.
Eliminating the inner sites from the right, or from the left, D ← A_n − τz D⁻¹ τz, gives

    P_n = −D_n⁻¹ τz P_{n−1} (right sweep),   Q_n = −D_n⁻¹ τz Q_{n+1} (left sweep),

and E and D of M' as the last D of each, C = P_{N−2}ᵀ τz. To first order M' changes by X_nᵀ dA_n X_n
with the onsite block A_n, so a conductance by Tr[S X_nᵀ dA_n X_n], S real symmetric, one for each
conductance and lane (`responses`); `contraction` sums it. All work per site is real.

It is done in the frame of spin along (+) and against (−) the field at site n: rows e+, e−, h+, h−
of X_n. There V and B are diagonal. α changes t', in whose units all of A_n is measured, and turns
the field, which is off-diagonal in spin: dA_n/dα = c (normal + anomalous τx) + turn σx plus
multiples of the forms of V and B.

Layout as in `recursion`: entry k of lane l at b[k·LANES + l]. A site's record holds its L (6) and
1/Δ (4), then P_n (16).
"""

from __future__ import annotations

import numba as nb

from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.recursion import LANES

RECORD, P_AT = 26, 10
"""Entries per lane of a site's record, and where P_n starts in it."""
KINETIC, NORMAL, ANOMALOUS, GROWTH, D_AT = 0, 1, 2, 3, 4
SCALED, ROWS, SITE_SUM, SUM, V_SUM, FORMS, ENTRIES = 14, 16, 48, 52, 56, 60, 300
"""Where the entries of b start: the terms of the lane, the largest |1/Δ| met, D;
c·(normal, anomalous); the rows of X_n, four traces of site n, their sums over n without and with
the factor V_n; ten 2×2 tiles of the upper triangle, 4 entries of (form of B, form of α, four S)."""

OPTIONS = {
    "cache": True,
    "fastmath": {"contract", "nsz", "arcp"},
    "error_model": "numpy",
}


@nb.njit(**OPTIONS)
def start(b: FloatArray, V: float, x: float, z: float) -> None:  # pragma: no cover
    """Set D to the onsite block of a site with potential V and Zeeman terms x and z."""
    L = LANES
    for l in range(L):
        w, a, q = b[1 * L + l], b[2 * L + l], b[0 * L + l] + V
        b[4 * L + l], b[5 * L + l], b[6 * L + l], b[7 * L + l] = w - q - z, -x, a, 0.0
        b[8 * L + l], b[9 * L + l], b[10 * L + l] = w - q + z, 0.0, a
        b[11 * L + l], b[12 * L + l], b[13 * L + l] = w + q - z, -x, w + q + z


@nb.njit(**OPTIONS)
def factor(
    b: FloatArray, site: FloatArray, V: float, x: float, z: float
) -> None:  # pragma: no cover
    """Record D = LΔLᵀ with its site, then D ← A − τz D⁻¹ τz with A of the next site."""
    L = LANES
    for l in range(L):
        d0, d1, d2, d3 = b[4 * L + l], b[5 * L + l], b[6 * L + l], b[7 * L + l]
        r0 = 1.0 / d0
        l10, l20, l30 = d1 * r0, d2 * r0, d3 * r0
        e2, e3 = b[9 * L + l] - l10 * d2, b[10 * L + l] - l10 * d3
        r1 = 1.0 / (b[8 * L + l] - l10 * d1)
        l21, l31 = e2 * r1, e3 * r1
        f3 = b[12 * L + l] - l20 * d3 - l21 * e3
        r2 = 1.0 / (b[11 * L + l] - l20 * d2 - l21 * e2)
        l32 = f3 * r2
        r3 = 1.0 / (b[13 * L + l] - l30 * d3 - l31 * e3 - l32 * f3)
        b[3 * L + l] = max(abs(r0), abs(r1), abs(r2), abs(r3), b[3 * L + l])
        site[0 * L + l], site[1 * L + l], site[2 * L + l] = l10, l20, l21
        site[3 * L + l], site[4 * L + l], site[5 * L + l] = l30, l31, l32
        site[6 * L + l], site[7 * L + l] = r0, r1
        site[8 * L + l], site[9 * L + l] = r2, r3
        m20, m31 = l21 * l10 - l20, l32 * l21 - l31
        m30 = -l30 - l31 * -l10 - l32 * m20
        x23, x13, x03 = -r3 * l32, r3 * m31, r3 * m30
        y12, y02, y01 = -r2 * l21, r2 * m20, -r1 * l10
        x22, x12, x02 = r2 - x23 * l32, y12 - x13 * l32, y02 - x03 * l32
        x11, x01 = r1 - y12 * l21 + x13 * m31, y01 - y02 * l21 + x03 * m31
        x00 = r0 - y01 * l10 + y02 * m20 + x03 * m30
        w, a, q = b[1 * L + l], b[2 * L + l], b[0 * L + l] + V
        b[4 * L + l], b[5 * L + l] = w - q - z - x00, -x - x01
        b[6 * L + l], b[7 * L + l] = a + x02, x03
        b[8 * L + l], b[9 * L + l], b[10 * L + l] = w - q + z - x11, x12, a + x13
        b[11 * L + l], b[12 * L + l], b[13 * L + l] = w + q - z - x22, -x - x23, w + q + z - r3


@nb.njit(**OPTIONS)
def carry(site: FloatArray, source: FloatArray, target: FloatArray) -> None:  # pragma: no cover
    """Write −D⁻¹ τz times the 4×4 block `source` to `target`, D = LΔLᵀ as recorded."""
    L = LANES
    for l in range(L):
        l10, l20, l21 = site[0 * L + l], site[1 * L + l], site[2 * L + l]
        l30, l31, l32 = site[3 * L + l], site[4 * L + l], site[5 * L + l]
        r0, r1, r2, r3 = site[6 * L + l], site[7 * L + l], site[8 * L + l], site[9 * L + l]
        v0 = -source[0 * L + l]
        v1 = -source[4 * L + l] - l10 * v0
        v2 = source[8 * L + l] - l20 * v0 - l21 * v1
        v3 = (source[12 * L + l] - l30 * v0 - l31 * v1 - l32 * v2) * r3
        v2 = v2 * r2 - l32 * v3
        v1 = v1 * r1 - l21 * v2 - l31 * v3
        target[0 * L + l] = v0 * r0 - l10 * v1 - l20 * v2 - l30 * v3
        target[4 * L + l], target[8 * L + l], target[12 * L + l] = v1, v2, v3
        v0 = -source[1 * L + l]
        v1 = -source[5 * L + l] - l10 * v0
        v2 = source[9 * L + l] - l20 * v0 - l21 * v1
        v3 = (source[13 * L + l] - l30 * v0 - l31 * v1 - l32 * v2) * r3
        v2 = v2 * r2 - l32 * v3
        v1 = v1 * r1 - l21 * v2 - l31 * v3
        target[1 * L + l] = v0 * r0 - l10 * v1 - l20 * v2 - l30 * v3
        target[5 * L + l], target[9 * L + l], target[13 * L + l] = v1, v2, v3
        v0 = -source[2 * L + l]
        v1 = -source[6 * L + l] - l10 * v0
        v2 = source[10 * L + l] - l20 * v0 - l21 * v1
        v3 = (source[14 * L + l] - l30 * v0 - l31 * v1 - l32 * v2) * r3
        v2 = v2 * r2 - l32 * v3
        v1 = v1 * r1 - l21 * v2 - l31 * v3
        target[2 * L + l] = v0 * r0 - l10 * v1 - l20 * v2 - l30 * v3
        target[6 * L + l], target[10 * L + l], target[14 * L + l] = v1, v2, v3
        v0 = -source[3 * L + l]
        v1 = -source[7 * L + l] - l10 * v0
        v2 = source[11 * L + l] - l20 * v0 - l21 * v1
        v3 = (source[15 * L + l] - l30 * v0 - l31 * v1 - l32 * v2) * r3
        v2 = v2 * r2 - l32 * v3
        v1 = v1 * r1 - l21 * v2 - l31 * v3
        target[3 * L + l] = v0 * r0 - l10 * v1 - l20 * v2 - l30 * v3
        target[7 * L + l], target[11 * L + l], target[15 * L + l] = v1, v2, v3
