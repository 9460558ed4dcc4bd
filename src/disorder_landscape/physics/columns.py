"""How a wire's end blocks answer to every site: two real sweeps, then one contraction per site.

M = (ω − H)/t' of `recursion`, reduced to its two end sites, is M' = Xᵀ M X, where X_n = [P_n Q_n]
is the wave at site n that the left or the right end site drives while the other is held at zero.
Eliminating the inner sites from the right, or from the left, D ← A_n − τz D⁻¹ τz, gives

    P_n = −D_n⁻¹ τz P_{n−1} (right sweep),   Q_n = −D_n⁻¹ τz Q_{n+1} (left sweep),

and E and D of M' as the last D of each, C = P_{N−2}ᵀ τz. To first order M' changes by X_nᵀ dA_n X_n
with the onsite block A_n, so a conductance by Tr[S X_nᵀ dA_n X_n], S real symmetric, one for each
conductance and lane (`responses`). All work per site is real.

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

Pair = tuple[float, ...]
_options = {
    "cache": True,
    "fastmath": {"contract", "nsz", "arcp"},
    "error_model": "numpy",
}


@nb.njit(**_options)
def start(b: FloatArray, V: float, x: float, z: float) -> None:  # pragma: no cover
    """Set D to the onsite block of a site with potential V and Zeeman terms x and z."""
    L = LANES
    for l in range(L):
        w, a, q = b[1 * L + l], b[2 * L + l], b[0 * L + l] + V
        b[4 * L + l], b[5 * L + l], b[6 * L + l], b[7 * L + l] = w - q - z, -x, a, 0.0
        b[8 * L + l], b[9 * L + l], b[10 * L + l] = w - q + z, 0.0, a
        b[11 * L + l], b[12 * L + l], b[13 * L + l] = w + q - z, -x, w + q + z


@nb.njit(**_options)
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


@nb.njit(**_options)
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


@nb.njit(**_options)
def _rotate(
    b: FloatArray, block: FloatArray, first: int, c: float, s: float
) -> None:  # pragma: no cover
    """Write P_n or Q_n as columns of the rows of X_n; (c, s) is the spin along the field."""
    L = LANES
    rows = b[(ROWS + first) * L :]
    for l in range(L):
        up, down = block[0 * L + l], block[4 * L + l]
        rows[0 * L + l], rows[8 * L + l] = c * up + s * down, c * down - s * up
        up, down = block[8 * L + l], block[12 * L + l]
        rows[16 * L + l], rows[24 * L + l] = c * up + s * down, c * down - s * up
        up, down = block[1 * L + l], block[5 * L + l]
        rows[1 * L + l], rows[9 * L + l] = c * up + s * down, c * down - s * up
        up, down = block[9 * L + l], block[13 * L + l]
        rows[17 * L + l], rows[25 * L + l] = c * up + s * down, c * down - s * up
        up, down = block[2 * L + l], block[6 * L + l]
        rows[2 * L + l], rows[10 * L + l] = c * up + s * down, c * down - s * up
        up, down = block[10 * L + l], block[14 * L + l]
        rows[18 * L + l], rows[26 * L + l] = c * up + s * down, c * down - s * up
        up, down = block[3 * L + l], block[7 * L + l]
        rows[3 * L + l], rows[11 * L + l] = c * up + s * down, c * down - s * up
        up, down = block[11 * L + l], block[15 * L + l]
        rows[19 * L + l], rows[27 * L + l] = c * up + s * down, c * down - s * up


@nb.njit(inline="always")
def _entry(
    b: FloatArray, at: int, tau: float, field: float, turned: float
) -> tuple[float, float, float, float]:  # pragma: no cover
    """Add an entry of the forms to those of all sites; return its parts of the four traces."""
    L = LANES
    b[at] += field
    b[at + L] += turned
    return tau * b[at + 2 * L], tau * b[at + 3 * L], tau * b[at + 4 * L], tau * b[at + 5 * L]


@nb.njit(inline="always")
def _columns(b: FloatArray, j: int, l: int, turn: float) -> Pair:  # pragma: no cover
    """Return columns j, j + 1 of X_n, and of [c (normal + anomalous τx) + turn σx] X_n."""
    L = LANES
    i, w, a = (ROWS + j) * L + l, b[SCALED * L + l], b[(SCALED + 1) * L + l]
    e, f, g, h = b[i], b[i + 8 * L], b[i + 16 * L], b[i + 24 * L]
    i += L
    E, F, G, H = b[i], b[i + 8 * L], b[i + 16 * L], b[i + 24 * L]
    p, q = w * e + a * g + turn * f, w * f + a * h + turn * e
    r, s = w * g + a * e + turn * h, w * h + a * f + turn * g
    P, Q = w * E + a * G + turn * F, w * F + a * H + turn * E
    R, S = w * G + a * E + turn * H, w * H + a * F + turn * G
    return e, f, g, h, E, F, G, H, p, q, r, s, P, Q, R, S


@nb.njit(inline="always")
def _tile(b: FloatArray, tile: int, row: int, l: int, x: Pair) -> Pair:  # pragma: no cover
    """Add the forms of columns `row`, `row + 1` with the columns x; return their four traces."""
    L = LANES
    i = (ROWS + row) * L + l
    e, f, g, h = b[i], b[i + 8 * L], b[i + 16 * L], b[i + 24 * L]
    i += L
    E, F, G, H = b[i], b[i + 8 * L], b[i + 16 * L], b[i + 24 * L]
    i = (FORMS + 24 * tile) * L + l
    u, v = e * x[0] - h * x[3], f * x[1] - g * x[2]
    p = _entry(b, i, u + v, u - v, e * x[8] + f * x[9] + g * x[10] + h * x[11])
    u, v = e * x[4] - h * x[7], f * x[5] - g * x[6]
    q = _entry(b, i + 6 * L, u + v, u - v, e * x[12] + f * x[13] + g * x[14] + h * x[15])
    u, v = E * x[0] - H * x[3], F * x[1] - G * x[2]
    r = _entry(b, i + 12 * L, u + v, u - v, E * x[8] + F * x[9] + G * x[10] + H * x[11])
    u, v = E * x[4] - H * x[7], F * x[5] - G * x[6]
    s = _entry(b, i + 18 * L, u + v, u - v, E * x[12] + F * x[13] + G * x[14] + H * x[15])
    return (
        p[0] + q[0] + r[0] + s[0],
        p[1] + q[1] + r[1] + s[1],
        p[2] + q[2] + r[2] + s[2],
        p[3] + q[3] + r[3] + s[3],
    )


@nb.njit(inline="always")
def _diagonal_tile(b: FloatArray, tile: int, l: int, x: Pair) -> Pair:  # pragma: no cover
    """Add the forms of the columns x with themselves; return their four traces."""
    L = LANES
    i = (FORMS + 24 * tile) * L + l
    e, f, g, h, E, F, G, H, p, q, r, s, P, Q, R, S = x
    u, v = e * e - h * h, f * f - g * g
    k = _entry(b, i, u + v, u - v, e * p + f * q + g * r + h * s)
    u, v = e * E - h * H, f * F - g * G
    m = _entry(b, i + 6 * L, u + v, u - v, e * P + f * Q + g * R + h * S)
    u, v = E * E - H * H, F * F - G * G
    n = _entry(b, i + 18 * L, u + v, u - v, E * P + F * Q + G * R + H * S)
    return k[0] + m[0] + n[0], k[1] + m[1] + n[1], k[2] + m[2] + n[2], k[3] + m[3] + n[3]


@nb.njit(inline="always")
def _add(b: FloatArray, l: int, t: Pair) -> None:  # pragma: no cover
    """Add four traces to those of the site."""
    L = LANES
    b[48 * L + l] += t[0]
    b[49 * L + l] += t[1]
    b[50 * L + l] += t[2]
    b[51 * L + l] += t[3]


@nb.njit(**_options)
def contract(
    b: FloatArray, P: FloatArray, Q: FloatArray, V: float, c: float, s: float, turn: float
) -> None:  # pragma: no cover
    """Write the four Tr[S X_nᵀ τz X_n] to SITE_SUM; add the site to what is summed over sites."""
    L = LANES
    _rotate(b, P, 0, c, s)
    _rotate(b, Q, 4, c, s)
    for l in range(L):
        x = _columns(b, 0, l, turn)
        t = _diagonal_tile(b, 0, l, x)
        b[48 * L + l], b[49 * L + l], b[50 * L + l], b[51 * L + l] = t[0], t[1], t[2], t[3]
    for l in range(L):
        x = _columns(b, 2, l, turn)
        t = _diagonal_tile(b, 2, l, x)
        _add(b, l, t)
        _add(b, l, _tile(b, 1, 0, l, x))
    for l in range(L):
        x = _columns(b, 4, l, turn)
        t = _diagonal_tile(b, 5, l, x)
        _add(b, l, t)
        _add(b, l, _tile(b, 3, 0, l, x))
        _add(b, l, _tile(b, 4, 2, l, x))
    for l in range(L):
        x = _columns(b, 6, l, turn)
        t = _diagonal_tile(b, 9, l, x)
        _add(b, l, t)
        _add(b, l, _tile(b, 6, 0, l, x))
        _add(b, l, _tile(b, 7, 2, l, x))
        _add(b, l, _tile(b, 8, 4, l, x))
    for k in range(4 * L):
        b[SUM * L + k] += b[SITE_SUM * L + k]
        b[V_SUM * L + k] += V * b[SITE_SUM * L + k]
