"""What a change at each of a few sites does to up to six quantities, for V, B and α at once.

The rows of X_n are turned to spin along (+) and against (−) the field at site n: e = e+, f = e−,
g = h+, h = h−. V then is the form ee' + ff' − gg' − hh' of each two columns, and B twice
u = ee' − hh' less that of V. α changes t', in whose units all of A_n is measured, and turns the
field: but for multiples of the forms of V and B it is λ + aτx + tσx, λ and a constant, t of the
site. A form of rank two does most of that,

    aτx + tσx + tτz + aσz = ½(ρη' + ηρ'),   ρ = e + f + g − h,   η = t(e+f−g+h) + a(e−f+g+h),

and λ is that of B plus twice n = ff' + hh'. So V costs four products for each two columns, B none,
α two, and u and n additions only, which the core has other units for. V alone is needed for every
site: its forms are contracted with S at once, what is summed over sites only at the end.

Sites are taken SITES at a time, so that the sums and S are loaded once for all of them.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.vectors import Vector, everywhere, load, store

SITES = 3
"""Sites of a block; `trace` is written out for so many."""
ROWS = 6
"""Vectors of a column: e, f, g, h, ρ, η."""


def _tiles() -> list[tuple[int, int]]:
    pairs = []
    for j in range(0, 8, 2):
        for i in range(0, j + 2, 2):
            tile = [(i, j), (i, j + 1), (i + 1, j), (i + 1, j + 1)]
            pairs += [(a, b) for a, b in tile if a <= b]
    return pairs


PAIRS = np.array(_tiles())
"""The two columns of each of the 36 entries of a form, tile by tile."""
TURNED_PAIRS = np.array(
    [(i, j) for i in range(4) for j in range(i, 4)]
    + [(i, j) for i in range(4) for j in range(4, 8)]
    + [(i, j) for i in range(4, 8) for j in range(i, 8)]
)
"""Those of the entries of the form of ρ and η."""
ENTRY = np.zeros((8, 8), dtype=np.int64)
"""Which entry of `PAIRS` two columns are."""
ENTRY[PAIRS[:, 0], PAIRS[:, 1]] = np.arange(36)
SUMS, TURNED = 108, 72
"""Sums over sites: u and n of each entry, then, from TURNED on, the form of ρ and η."""

_options = {"cache": True, "error_model": "numpy"}
Column = tuple[Vector, Vector, Vector, Vector]


@nb.njit(inline="always")
def _column(rows: FloatArray, column: int) -> Column:  # pragma: no cover
    """Return e, f, g, h of a column; columns are counted through the sites of the block."""
    at = ROWS * column
    return load(rows, at), load(rows, at + 1), load(rows, at + 2), load(rows, at + 3)


@nb.njit(inline="always")
def _turned(
    block: FloatArray, at: int, rows: FloatArray, column: int, a: Vector, terms: tuple[float, ...]
) -> Column:  # pragma: no cover
    """Turn a column of P_n or Q_n, by three shears, and write it with its ρ and η."""
    tangent, sine, turn = terms
    e, f, g, h = load(block, at), load(block, at + 4), load(block, at + 8), load(block, at + 12)
    e, g = e + tangent * f, g + tangent * h
    f, h = f - sine * e, h - sine * g
    e, g = e + tangent * f, g + tangent * h
    k, m, to = e + f, g - h, ROWS * column
    store(rows, to, e)
    store(rows, to + 1, f)
    store(rows, to + 2, g)
    store(rows, to + 3, h)
    store(rows, to + 4, k + m)
    store(rows, to + 5, turn * (k - m) + a * ((e + g) + (h - f)))
    return e, f, g, h


@nb.njit(inline="always")
def _form(x: Column, y: Column) -> tuple[Vector, Vector, Vector]:  # pragma: no cover
    """Return the form of V of two columns, u and n."""
    k, m = x[3] * y[3], x[1] * y[1]
    u = x[0] * y[0] - k
    return (u + m) - x[2] * y[2], u, k + m


@nb.njit(**_options)
def add_own_tiles(
    block: FloatArray,
    at: int,
    step: int,
    turns: FloatArray,
    sites: int,
    rows: FloatArray,
    half: int,
    a: Vector,
    forms: FloatArray,
    sums: FloatArray,
) -> None:  # pragma: no cover
    """Take P_n (half 0) or Q_n (half 1) into the rows; add the tile of each pair with itself.

    They start at block[at], one site `step` vectors after the other; turns holds tan ½ψ and sin ψ
    of the turn ψ of each site's spin and t.
    """
    for pair in range(2):
        J = 2 * half + pair
        entry = 2 * J**2 + 5 * J
        to = 2 * entry
        u0, u1, u2 = load(sums, to), load(sums, to + 2), load(sums, to + 4)
        n0, n1, n2 = load(sums, to + 1), load(sums, to + 3), load(sums, to + 5)
        for site in range(sites):
            terms = turns[3 * site], turns[3 * site + 1], turns[3 * site + 2]
            c, source = 8 * site + 2 * J, at + step * site + 2 * pair
            x = _turned(block, source, rows, c, a, terms)
            y = _turned(block, source + 1, rows, c + 1, a, terms)
            v0, u, n = _form(x, x)
            u0, n0 = u0 + u, n0 + n
            v1, u, n = _form(x, y)
            u1, n1 = u1 + u, n1 + n
            v2, u, n = _form(y, y)
            u2, n2 = u2 + u, n2 + n
            store(forms, SITES * entry + site, v0)
            store(forms, SITES * (entry + 1) + site, v1)
            store(forms, SITES * (entry + 2) + site, v2)
        store(sums, to, u0)
        store(sums, to + 1, n0)
        store(sums, to + 2, u1)
        store(sums, to + 3, n1)
        store(sums, to + 4, u2)
        store(sums, to + 5, n2)


@nb.njit(**_options)
def add_tiles(
    rows: FloatArray, sites: int, forms: FloatArray, sums: FloatArray
) -> None:  # pragma: no cover
    """Add the tiles of two pairs of columns."""
    for tile in range(6):
        J = 1 if tile < 1 else 2 if tile < 3 else 3
        I = tile - J * (J - 1) // 2
        i, j, entry = 2 * I, 2 * J, 2 * J**2 + J + 4 * I
        to = 2 * entry
        u0, u1, u2, u3 = load(sums, to), load(sums, to + 2), load(sums, to + 4), load(sums, to + 6)
        n0, n1, n2, n3 = (
            load(sums, to + 1),
            load(sums, to + 3),
            load(sums, to + 5),
            load(sums, to + 7),
        )
        for site in range(sites):
            x, y = _column(rows, 8 * site + i), _column(rows, 8 * site + j)
            v0, u, n = _form(x, y)
            u0, n0 = u0 + u, n0 + n
            z = _column(rows, 8 * site + j + 1)
            v1, u, n = _form(x, z)
            u1, n1 = u1 + u, n1 + n
            x = _column(rows, 8 * site + i + 1)
            v2, u, n = _form(x, y)
            u2, n2 = u2 + u, n2 + n
            v3, u, n = _form(x, z)
            u3, n3 = u3 + u, n3 + n
            store(forms, SITES * entry + site, v0)
            store(forms, SITES * (entry + 1) + site, v1)
            store(forms, SITES * (entry + 2) + site, v2)
            store(forms, SITES * (entry + 3) + site, v3)
        store(sums, to, u0)
        store(sums, to + 1, n0)
        store(sums, to + 2, u1)
        store(sums, to + 3, n1)
        store(sums, to + 4, u2)
        store(sums, to + 5, n2)
        store(sums, to + 6, u3)
        store(sums, to + 7, n3)


@nb.njit(**_options)
def add_turned(rows: FloatArray, sites: int, sums: FloatArray) -> None:  # pragma: no cover
    """Add ρη' + ηρ', of a column with itself ρη."""
    for half in range(2):
        at = TURNED + 26 * half
        k0, k1, k2, k3 = load(sums, at), load(sums, at + 1), load(sums, at + 2), load(sums, at + 3)
        k4, k5, k6 = load(sums, at + 4), load(sums, at + 5), load(sums, at + 6)
        k7, k8, k9 = load(sums, at + 7), load(sums, at + 8), load(sums, at + 9)
        for site in range(sites):
            n = ROWS * (8 * site + 4 * half) + 4
            r0, s0 = load(rows, n), load(rows, n + 1)
            r1, s1 = load(rows, n + ROWS), load(rows, n + ROWS + 1)
            r2, s2 = load(rows, n + 2 * ROWS), load(rows, n + 2 * ROWS + 1)
            r3, s3 = load(rows, n + 3 * ROWS), load(rows, n + 3 * ROWS + 1)
            k0, k4, k7, k9 = k0 + r0 * s0, k4 + r1 * s1, k7 + r2 * s2, k9 + r3 * s3
            k1, k2, k3 = k1 + r0 * s1, k2 + r0 * s2, k3 + r0 * s3
            k5, k6, k8 = k5 + r1 * s2, k6 + r1 * s3, k8 + r2 * s3
            k1, k2, k3 = k1 + s0 * r1, k2 + s0 * r2, k3 + s0 * r3
            k5, k6, k8 = k5 + s1 * r2, k6 + s1 * r3, k8 + s2 * r3
        store(sums, at, k0)
        store(sums, at + 1, k1)
        store(sums, at + 2, k2)
        store(sums, at + 3, k3)
        store(sums, at + 4, k4)
        store(sums, at + 5, k5)
        store(sums, at + 6, k6)
        store(sums, at + 7, k7)
        store(sums, at + 8, k8)
        store(sums, at + 9, k9)
    for i in range(0, 4, 2):
        at = TURNED + 10 + 4 * i
        k0, k1, k2, k3 = load(sums, at), load(sums, at + 1), load(sums, at + 2), load(sums, at + 3)
        k4, k5, k6, k7 = (
            load(sums, at + 4),
            load(sums, at + 5),
            load(sums, at + 6),
            load(sums, at + 7),
        )
        for site in range(sites):
            n = ROWS * (8 * site + i) + 4
            r0, s0 = load(rows, n), load(rows, n + 1)
            r1, s1 = load(rows, n + ROWS), load(rows, n + ROWS + 1)
            n = ROWS * (8 * site + 4) + 4
            r, s = load(rows, n), load(rows, n + 1)
            k0, k4 = k0 + r0 * s, k4 + r1 * s
            k0, k4 = k0 + s0 * r, k4 + s1 * r
            r, s = load(rows, n + ROWS), load(rows, n + ROWS + 1)
            k1, k5 = k1 + r0 * s, k5 + r1 * s
            k1, k5 = k1 + s0 * r, k5 + s1 * r
            r, s = load(rows, n + 2 * ROWS), load(rows, n + 2 * ROWS + 1)
            k2, k6 = k2 + r0 * s, k6 + r1 * s
            k2, k6 = k2 + s0 * r, k6 + s1 * r
            r, s = load(rows, n + 3 * ROWS), load(rows, n + 3 * ROWS + 1)
            k3, k7 = k3 + r0 * s, k7 + r1 * s
            k3, k7 = k3 + s0 * r, k7 + s1 * r
        store(sums, at, k0)
        store(sums, at + 1, k1)
        store(sums, at + 2, k2)
        store(sums, at + 3, k3)
        store(sums, at + 4, k4)
        store(sums, at + 5, k5)
        store(sums, at + 6, k6)
        store(sums, at + 7, k7)


@nb.njit(**_options)
def trace(
    forms: FloatArray,
    S: FloatArray,
    quantities: int,
    sites: int,
    out: FloatArray,
    at: int,
    step: int,
) -> None:  # pragma: no cover
    """Write Tr[S_k F] of quantity k at site m of the block to out[at + m·step + k]."""
    for k in range(0, quantities, 2):
        zero = everywhere(0.0)
        a, b, c, d, e, f = zero, zero, zero, zero, zero, zero
        for entry in range(36):
            s, t = load(S, entry * quantities + k), load(S, entry * quantities + k + 1)
            x, y, z = load(forms, 3 * entry), load(forms, 3 * entry + 1), load(forms, 3 * entry + 2)
            a, b, c = a + s * x, b + s * y, c + s * z
            d, e, f = d + t * x, e + t * y, f + t * z
        store(out, at + k, a)
        store(out, at + k + 1, d)
        if sites > 1:
            store(out, at + step + k, b)
            store(out, at + step + k + 1, e)
        if sites > 2:
            store(out, at + 2 * step + k, c)
            store(out, at + 2 * step + k + 1, f)
