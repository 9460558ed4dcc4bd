"""The isolated wire's ends and their leads at WIDTH complex energies at once.

With the levels ±E of the isolated wire and what the ends see of them, U (`levels`),

    G_iso(z) = U (z − E)⁻¹ Uᵀ,   S(z) = Σ(z)⁻¹,   M = S − G_iso,

G_iso and S complex symmetric 8×8 in the chiral basis, S a cubic in the energy. M carries all that
the leads do: (z − H)⁻¹ = R + R Uᵀ M⁻¹ U R with R = (z − E)⁻¹, and G = S M⁻¹ S − S. It is factored
without pivots: its entries stay of order 1/Σ, also at the poles, because a level couples to the
leads by the same U by which it stands in G_iso.

Layout: as in `loewner`, entry k of energy l at [k·WIDTH + l]; real and imaginary parts are arrays
of their own.
"""

from __future__ import annotations

from typing import NamedTuple

import numba as nb
import numpy as np

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.levels import invert
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.vectors import WIDTH, Vector, everywhere, read, write

CUBIC = 4
"""Nodes, and coefficients, of the cubic for Σ(ω)."""
UPPER = 36
"""Entries of the upper triangle of an 8×8 matrix."""
ENDS = np.array([[0, 1, 4, 5], [2, 3, 6, 7]])
"""Which entries of the chiral basis lie on which end."""


def _place(i: int, j: int) -> int:
    a, b = min(i, j), max(i, j)
    if b < 4:
        return 4 * a - a * (a - 1) // 2 + b - a
    if a >= 4:
        a, b = a - 4, b - 4
        return 10 + 4 * a - a * (a - 1) // 2 + b - a
    return 20 + 4 * a + b - 4


PLACES = np.array([[_place(i, j) for j in range(8)] for i in range(8)])
"""Where entry (i, j) of a symmetric matrix stands: C = ++ (10), −− (10), then +− (16)."""


class Levels(NamedTuple):
    """The levels and the products of their weights, as the sums here take them."""

    E: FloatArray  # (level,)
    weight: FloatArray  # (level, 8), what the ends see of ±E: with C = +1, over √2, and C = −1
    products: FloatArray  # (level, UPPER): entries of w wᵀ, by `PLACES`


@nb.njit(cache=True)
def level_products(E: FloatArray, weight: FloatArray) -> Levels:  # pragma: no cover
    """Return what the sums need of the levels."""
    n, size = weight.shape
    half, products = np.empty((n, size)), np.empty((n, UPPER))
    for k in range(n):
        for i in range(size):
            half[k, i] = np.sqrt(0.5) * weight[k, i]
            for j in range(i, size):
                products[k, PLACES[i, j]] = weight[k, i] * weight[k, j]
    return Levels(E, half, products)


class Leads(NamedTuple):
    """The leads around the window, chiral basis: coefficients of 1, ω, ω², ω³, in meV."""

    gamma: ComplexArray  # (CUBIC, 2, 4, 4), of Γ = −2 Im Σ at each end
    inverse: ComplexArray  # (CUBIC, 2, 4, 4), of S = Σ⁻¹
    conjugate: ComplexArray  # (CUBIC, 2, 4, 4), of S(z*)*


@nb.njit(cache=True)
def leads_between(cubic: FloatArray, sigma: ComplexArray) -> Leads:  # pragma: no cover
    """Interpolate Σ, shape (CUBIC, 8, 8) at CUBIC energies; cubic: their inverse Vandermonde."""
    shape = (CUBIC, 2, 4, 4)
    gamma, inverse = np.zeros(shape, dtype=np.complex128), np.zeros(shape, dtype=np.complex128)
    block = np.empty((4, 4), dtype=np.complex128)
    for k in range(CUBIC):
        for end in range(2):
            for i in range(4):
                for j in range(4):
                    block[i, j] = sigma[k, ENDS[end, i], ENDS[end, j]]
            for power in range(CUBIC):
                for i in range(4):
                    for j in range(4):
                        gamma[power, end, i, j] -= 2 * cubic[power, k] * block[i, j].imag
            invert(block)
            for power in range(CUBIC):
                for i in range(4):
                    for j in range(4):
                        inverse[power, end, i, j] += cubic[power, k] * block[i, j]
    return Leads(gamma, inverse, np.conj(inverse))


@nb.njit(cache=True, error_model="numpy")
def reciprocals(
    zr: FloatArray, zi: FloatArray, E: FloatArray, parts: FloatArray
) -> None:  # pragma: no cover
    """Write 1/(z − E) and 1/(z + E), then half their sum and difference; (8, level · WIDTH)."""
    W = WIDTH
    x, y, one, half = read(zr, 0), read(zi, 0), everywhere(1.0), everywhere(0.5)
    p, q, r, s = parts[0], parts[1], parts[2], parts[3]
    even_re, even_im, odd_re, odd_im = parts[4], parts[5], parts[6], parts[7]
    square, minus = y * y, everywhere(0.0) - y
    for n in range(E.size):
        level, at = everywhere(E[n]), n * W
        below, above = x - level, x + level
        near, far = one / (below * below + square), one / (above * above + square)
        a, b, c, d = below * near, minus * near, above * far, minus * far
        write(p, at, a)
        write(q, at, b)
        write(r, at, c)
        write(s, at, d)
        write(even_re, at, half * (a + c))
        write(even_im, at, half * (b + d))
        write(odd_re, at, half * (a - c))
        write(odd_im, at, half * (b - d))


@nb.njit(cache=True, error_model="numpy")
def isolated_sums(
    levels: Levels, parts: FloatArray, re: FloatArray, im: FloatArray
) -> None:  # pragma: no cover
    """Write G_iso, shape (UPPER · WIDTH,) each, from `reciprocals`; four entries per pass."""
    W, zero = WIDTH, everywhere(0.0)
    products = levels.products
    for e in range(0, UPPER, 4):
        real, imag = (parts[4], parts[5]) if e < 20 else (parts[6], parts[7])
        a, b, c, d = zero, zero, zero, zero
        f, g, h, k = zero, zero, zero, zero
        for n in range(levels.E.size):
            row, x, y = products[n], read(real, n * W), read(imag, n * W)
            q, r, s, t = (
                everywhere(row[e]),
                everywhere(row[e + 1]),
                everywhere(row[e + 2]),
                everywhere(row[e + 3]),
            )
            a, b, c, d = a + q * x, b + r * x, c + s * x, d + t * x
            f, g, h, k = f + q * y, g + r * y, h + s * y, k + t * y
        write(re, e * W, a)
        write(re, (e + 1) * W, b)
        write(re, (e + 2) * W, c)
        write(re, (e + 3) * W, d)
        write(im, e * W, f)
        write(im, (e + 1) * W, g)
        write(im, (e + 2) * W, h)
        write(im, (e + 3) * W, k)


@nb.njit(cache=True, error_model="numpy")
def cubics(
    terms: ComplexArray, zr: FloatArray, zi: FloatArray, parts: FloatArray
) -> None:  # pragma: no cover
    """Write a cubic's values and slopes: (4, 20 · WIDTH), re, im, re, im, ten entries per end."""
    W = WIDTH
    x, y = read(zr, 0), read(zi, 0)
    re, im, slope_re, slope_im = parts[0], parts[1], parts[2], parts[3]
    for end in range(2):
        at = 10 * end * W
        for i in range(4):
            for j in range(i, 4):
                a, b = terms[3, end, i, j], terms[2, end, i, j]
                c, d = terms[1, end, i, j], terms[0, end, i, j]
                ar, ai = everywhere(a.real), everywhere(a.imag)
                br, bi = everywhere(b.real), everywhere(b.imag)
                pr, pi = ar * x - ai * y + br, ar * y + ai * x + bi  # az + b
                cr, ci = everywhere(c.real), everywhere(c.imag)
                qr, qi = pr * x - pi * y + cr, pr * y + pi * x + ci  # az² + bz + c
                write(re, at, qr * x - qi * y + everywhere(d.real))
                write(im, at, qr * y + qi * x + everywhere(d.imag))
                pr, pi = ar * x - ai * y + pr, ar * y + ai * x + pi  # 2az + b
                write(slope_re, at, qr + pr * x - pi * y)
                write(slope_im, at, qi + pr * y + pi * x)
                at += W


@nb.njit(cache=True, error_model="numpy")
def factor(
    s: FloatArray, re: FloatArray, im: FloatArray, pivots: FloatArray
) -> None:  # pragma: no cover
    """Turn G_iso into L and the reciprocals of Δ, S − G_iso = LΔLᵀ; s: from `cubics`.

    Lower entries of L stand at the places of the upper triangle; pivots: (2, 8 · WIDTH).
    """
    W, one = WIDTH, everywhere(1.0)
    size = pivots.shape[1] // W  # 8, but not for the compiler: it would unroll everything
    for at in range(0, UPPER * W, W):
        write(re, at, everywhere(0.0) - read(re, at))
        write(im, at, everywhere(0.0) - read(im, at))
    source = 0
    for end in range(2):
        for i in range(4):
            for j in range(i, 4):
                at = PLACES[ENDS[end, i], ENDS[end, j]] * W
                write(re, at, read(re, at) + read(s[0], source))
                write(im, at, read(im, at) + read(s[1], source))
                source += W
    for k in range(size):
        at = PLACES[k, k] * W
        dr, di = read(re, at), read(im, at)
        norm = one / (dr * dr + di * di)
        dr, di = dr * norm, everywhere(0.0) - di * norm
        write(pivots[0], k * W, dr)
        write(pivots[1], k * W, di)
        for i in range(k + 1, size):
            at = PLACES[k, i] * W
            ar, ai = read(re, at), read(im, at)
            lr, li = ar * dr - ai * di, ar * di + ai * dr
            for j in range(i, size):
                fr, fi = read(re, PLACES[k, j] * W), read(im, PLACES[k, j] * W)
                to = PLACES[i, j] * W
                write(re, to, read(re, to) - lr * fr + li * fi)
                write(im, to, read(im, to) - lr * fi - li * fr)
        for i in range(k + 1, size):
            at = PLACES[k, i] * W
            ar, ai = read(re, at), read(im, at)
            write(re, at, ar * dr - ai * di)
            write(im, at, ar * di + ai * dr)


@nb.njit(cache=True, error_model="numpy")
def solve_lower(
    re: FloatArray, im: FloatArray, xr: FloatArray, xi: FloatArray
) -> None:  # pragma: no cover
    """Replace x, shape (8 · WIDTH,), by L⁻¹x."""
    W = WIDTH
    size = xr.size // W
    for i in range(1, size):
        a, b = read(xr, i * W), read(xi, i * W)
        for k in range(i):
            at = PLACES[k, i] * W
            lr, li, c, d = read(re, at), read(im, at), read(xr, k * W), read(xi, k * W)
            a, b = a - lr * c + li * d, b - lr * d - li * c
        write(xr, i * W, a)
        write(xi, i * W, b)


@nb.njit(cache=True, error_model="numpy")
def solve(
    re: FloatArray, im: FloatArray, pivots: FloatArray, xr: FloatArray, xi: FloatArray
) -> None:  # pragma: no cover
    """Replace x, shape (8 · WIDTH,), by M⁻¹x."""
    W = WIDTH
    size = xr.size // W
    solve_lower(re, im, xr, xi)
    for i in range(size - 1, -1, -1):
        c, d = read(xr, i * W), read(xi, i * W)
        pr, pi = read(pivots[0], i * W), read(pivots[1], i * W)
        a, b = c * pr - d * pi, c * pi + d * pr
        for k in range(i + 1, size):
            at = PLACES[i, k] * W
            lr, li, c, d = read(re, at), read(im, at), read(xr, k * W), read(xi, k * W)
            a, b = a - lr * c + li * d, b - lr * d - li * c
        write(xr, i * W, a)
        write(xi, i * W, b)


@nb.njit(cache=True, error_model="numpy")
def add_product(
    pivots: FloatArray, f: FloatArray, g: FloatArray, re: Vector, im: Vector
) -> tuple[Vector, Vector]:  # pragma: no cover
    """Return re + i·im + xᵀM⁻¹y, given f = L⁻¹x and g = L⁻¹y, each (2, 8 · WIDTH)."""
    for at in range(0, f.shape[1], WIDTH):
        ar, ai, br, bi = read(f[0], at), read(f[1], at), read(g[0], at), read(g[1], at)
        dr, di = read(pivots[0], at), read(pivots[1], at)
        qr, qi = ar * br - ai * bi, ar * bi + ai * br
        re, im = re + qr * dr - qi * di, im + qr * di + qi * dr
    return re, im


@nb.njit(cache=True, error_model="numpy")
def of_ends(
    s_re: FloatArray,
    s_im: FloatArray,
    xr: FloatArray,
    xi: FloatArray,
    yr: FloatArray,
    yi: FloatArray,
) -> None:  # pragma: no cover
    """Write S x, for S (20 · WIDTH,) from `cubics` and x, y of shape (8 · WIDTH,)."""
    W = WIDTH
    for end in range(2):
        for i in range(4):
            a, b = everywhere(0.0), everywhere(0.0)
            for j in range(4):
                at = (10 * end + PLACES[i, j]) * W
                to = ENDS[end, j] * W
                sr, si, c, d = read(s_re, at), read(s_im, at), read(xr, to), read(xi, to)
                a, b = a + sr * c - si * d, b + sr * d + si * c
            write(yr, ENDS[end, i] * W, a)
            write(yi, ENDS[end, i] * W, b)
