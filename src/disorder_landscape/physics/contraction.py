"""What a change at one site does to the four conductances, for V, B and α at once.

See `columns` for the mathematics and the layout. X_n is cut into pairs of columns and the forms
into 2×2 tiles; the pairs are taken in order, each with those before it, so that every form is
built where its columns are at hand.
"""

from __future__ import annotations

import numba as nb

from disorder_landscape.physics.columns import FORMS, OPTIONS, ROWS, SCALED, SITE_SUM, SUM, V_SUM
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.recursion import LANES

Pair = tuple[float, ...]


@nb.njit(**OPTIONS)
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


@nb.njit(**OPTIONS)
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
