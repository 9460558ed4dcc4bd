"""Poles of the wire with its leads, by inverse iteration on H(z), WIDTH poles at once.

In the space of the levels this is H(z) = E + UᵀΣ(z)U, with the levels ±E and what the ends see of
them, U. One step takes x to (z − H)⁻¹x = R x + R Uᵀ t, M t = U R x (`dressing`), and z to

    z − x_newᵀ x_old / x_newᵀ(1 − H')x_new,    xᵀ(1 − H')x = xᵀx + tᵀS't,

the symmetric Rayleigh quotient (no conjugation), which converges cubically: with the starts of
`pole_starts` the second step moves poles by less than CONVERGED in nearly all sets. No expansion in
the coupling is left. As U x_new = S t, a pole's v, G ≈ v vᵀ/(ω − z), needs no further sum.
"""

from __future__ import annotations

from typing import NamedTuple

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.dressing import (
    ENDS,
    Leads,
    Levels,
    cubics,
    factor,
    isolated_sums,
    reciprocals,
    solve,
)
from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.vectors import WIDTH, everywhere, read, write

FAINT = 1e-9
"""Widths below this (meV) carry no conductance and need no digits."""
STEPS = 2
"""Steps of a batch before it is looked at."""
ROUNDS = 8
"""Most batches per pole."""
CENTRAL = 1e-7
"""Poles with |Re z| below this (meV) are their own mirror images −z*."""
CONVERGED = 3e-4
"""A pole has converged if before the last step it was off by less than this part of its width, and
of the way to the next pole, whose vector is mixed in by as much: cubically, 1e-11 is left. It was
off by |x_old||x_new|/|x_newᵀ(1 − H')x_new| at most; the quotient itself may stand still elsewhere,
where two poles all but meet. There residues of opposite sign are large, and so are their errors."""


class Batch(NamedTuple):
    """WIDTH poles, and room to work on them."""

    zr: FloatArray  # (WIDTH,)
    zi: FloatArray
    x: FloatArray  # (4, level · WIDTH), over +E and over −E: re, im, re, im
    scale: FloatArray  # (WIDTH,), of x, against overflow
    t: FloatArray  # (2, 8 · WIDTH)
    norm: FloatArray  # (2 · WIDTH,), xᵀ(1 − H')x: re, im
    parts: FloatArray  # (8, level · WIDTH), see `reciprocals`
    s: FloatArray  # (4, 20 · WIDTH), see `cubics`
    re: FloatArray  # (UPPER · WIDTH,)
    im: FloatArray
    pivots: FloatArray  # (2, 8 · WIDTH)


@nb.njit(cache=True)
def new_batch(levels: int) -> Batch:  # pragma: no cover
    """Return room for WIDTH poles."""
    W = WIDTH
    return Batch(
        np.empty(W),
        np.empty(W),
        np.empty((4, levels * W)),
        np.empty(W),
        np.empty((2, 8 * W)),
        np.empty(2 * W),
        np.empty((8, levels * W)),
        np.empty((4, 20 * W)),
        np.empty(36 * W),
        np.empty(36 * W),
        np.empty((2, 8 * W)),
    )


@nb.njit(cache=True, error_model="numpy")
def factor_at_energies(levels: Levels, inverse: ComplexArray, b: Batch) -> None:  # pragma: no cover
    """Factor M = S − G_iso at the energies z; S is the cubic `inverse` of `Leads`."""
    reciprocals(b.zr, b.zi, levels.E, b.parts)
    isolated_sums(levels, b.parts, b.re, b.im)
    cubics(inverse, b.zr, b.zi, b.s)
    factor(b.s, b.re, b.im, b.pivots)


@nb.njit(cache=True, error_model="numpy")
def _apply_resolvent(levels: Levels, b: Batch) -> None:  # pragma: no cover
    """Replace x by R x, keep x in parts that are no longer needed; write U R x to t."""
    W, zero = WIDTH, everywhere(0.0)
    share = read(b.scale, 0)
    a0, a1, a2, a3, a4, a5, a6, a7 = zero, zero, zero, zero, zero, zero, zero, zero
    c0, c1, c2, c3, c4, c5, c6, c7 = zero, zero, zero, zero, zero, zero, zero, zero
    x0, x1, x2, x3 = b.x[0], b.x[1], b.x[2], b.x[3]
    p0, p1, p2, p3 = b.parts[0], b.parts[1], b.parts[2], b.parts[3]
    o0, o1, o2, o3 = b.parts[4], b.parts[5], b.parts[6], b.parts[7]
    for n in range(levels.E.size):
        at, w = n * W, levels.weight[n]
        re, im = read(x0, at) * share, read(x1, at) * share
        write(o0, at, re)
        write(o1, at, im)
        pr, pi = read(p0, at), read(p1, at)
        ur, ui = re * pr - im * pi, re * pi + im * pr
        re, im = read(x2, at) * share, read(x3, at) * share
        write(o2, at, re)
        write(o3, at, im)
        pr, pi = read(p2, at), read(p3, at)
        dr, di = re * pr - im * pi, re * pi + im * pr
        write(x0, at, ur)
        write(x1, at, ui)
        write(x2, at, dr)
        write(x3, at, di)
        re, im = ur + dr, ui + di
        w0, w1, w2, w3 = everywhere(w[0]), everywhere(w[1]), everywhere(w[2]), everywhere(w[3])
        a0, a1, a2, a3 = a0 + w0 * re, a1 + w1 * re, a2 + w2 * re, a3 + w3 * re
        c0, c1, c2, c3 = c0 + w0 * im, c1 + w1 * im, c2 + w2 * im, c3 + w3 * im
        re, im = ur - dr, ui - di
        w0, w1, w2, w3 = everywhere(w[4]), everywhere(w[5]), everywhere(w[6]), everywhere(w[7])
        a4, a5, a6, a7 = a4 + w0 * re, a5 + w1 * re, a6 + w2 * re, a7 + w3 * re
        c4, c5, c6, c7 = c4 + w0 * im, c5 + w1 * im, c6 + w2 * im, c7 + w3 * im
    tr, ti = b.t[0], b.t[1]
    write(tr, 0, a0)
    write(tr, W, a1)
    write(tr, 2 * W, a2)
    write(tr, 3 * W, a3)
    write(tr, 4 * W, a4)
    write(tr, 5 * W, a5)
    write(tr, 6 * W, a6)
    write(tr, 7 * W, a7)
    write(ti, 0, c0)
    write(ti, W, c1)
    write(ti, 2 * W, c2)
    write(ti, 3 * W, c3)
    write(ti, 4 * W, c4)
    write(ti, 5 * W, c5)
    write(ti, 6 * W, c6)
    write(ti, 7 * W, c7)


@nb.njit(cache=True, error_model="numpy")
def _add_mixed(levels: Levels, b: Batch, overlap: FloatArray) -> None:  # pragma: no cover
    """Add R Uᵀ t to x; write xᵀx to norm and its product with the x kept to overlap."""
    W = WIDTH
    tr, ti = b.t[0], b.t[1]
    r0, r1, r2, r3 = read(tr, 0), read(tr, W), read(tr, 2 * W), read(tr, 3 * W)
    r4, r5, r6, r7 = read(tr, 4 * W), read(tr, 5 * W), read(tr, 6 * W), read(tr, 7 * W)
    i0, i1, i2, i3 = read(ti, 0), read(ti, W), read(ti, 2 * W), read(ti, 3 * W)
    i4, i5, i6, i7 = read(ti, 4 * W), read(ti, 5 * W), read(ti, 6 * W), read(ti, 7 * W)
    x0, x1, x2, x3 = b.x[0], b.x[1], b.x[2], b.x[3]
    p0, p1, p2, p3 = b.parts[0], b.parts[1], b.parts[2], b.parts[3]
    o0, o1, o2, o3 = b.parts[4], b.parts[5], b.parts[6], b.parts[7]
    norm_re, norm_im, over_re, over_im = (
        everywhere(0.0),
        everywhere(0.0),
        everywhere(0.0),
        everywhere(0.0),
    )
    for n in range(levels.E.size):
        at, w = n * W, levels.weight[n]
        w0, w1, w2, w3 = everywhere(w[0]), everywhere(w[1]), everywhere(w[2]), everywhere(w[3])
        er, ei = w0 * r0 + w1 * r1 + w2 * r2 + w3 * r3, w0 * i0 + w1 * i1 + w2 * i2 + w3 * i3
        w0, w1, w2, w3 = everywhere(w[4]), everywhere(w[5]), everywhere(w[6]), everywhere(w[7])
        fr, fi = w0 * r4 + w1 * r5 + w2 * r6 + w3 * r7, w0 * i4 + w1 * i5 + w2 * i6 + w3 * i7
        pr, pi, re, im = read(p0, at), read(p1, at), er + fr, ei + fi
        ur, ui = read(x0, at) + re * pr - im * pi, read(x1, at) + re * pi + im * pr
        pr, pi, re, im = read(p2, at), read(p3, at), er - fr, ei - fi
        dr, di = read(x2, at) + re * pr - im * pi, read(x3, at) + re * pi + im * pr
        write(x0, at, ur)
        write(x1, at, ui)
        write(x2, at, dr)
        write(x3, at, di)
        norm_re = norm_re + ur * ur - ui * ui + dr * dr - di * di
        norm_im = norm_im + ur * ui + dr * di
        pr, pi, re, im = read(o0, at), read(o1, at), read(o2, at), read(o3, at)
        over_re = over_re + ur * pr - ui * pi + dr * re - di * im
        over_im = over_im + ur * pi + ui * pr + dr * im + di * re
    write(b.norm, 0, norm_re)
    write(b.norm, W, norm_im + norm_im)
    write(overlap, 0, over_re)
    write(overlap, W, over_im)


@nb.njit(cache=True, error_model="numpy")
def _add_slope(b: Batch) -> None:  # pragma: no cover
    """Add tᵀS't to the norm."""
    W, two = WIDTH, everywhere(2.0)
    re, im = read(b.norm, 0), read(b.norm, W)
    tr, ti, slope_re, slope_im = b.t[0], b.t[1], b.s[2], b.s[3]
    at = 0
    for end in range(2):
        for i in range(4):
            ar, ai = read(tr, ENDS[end, i] * W), read(ti, ENDS[end, i] * W)
            for j in range(i, 4):
                cr, ci = read(tr, ENDS[end, j] * W), read(ti, ENDS[end, j] * W)
                pr, pi = ar * cr - ai * ci, ar * ci + ai * cr
                sr, si = read(slope_re, at), read(slope_im, at)
                if i != j:
                    pr, pi = two * pr, two * pi
                re, im = re + sr * pr - si * pi, im + sr * pi + si * pr
                at += W
    write(b.norm, 0, re)
    write(b.norm, W, im)


@nb.njit(cache=True, error_model="numpy")
def _step(levels: Levels, leads: Leads, b: Batch, overlap: FloatArray) -> None:  # pragma: no cover
    """Improve the poles and their vectors."""
    W = WIDTH
    factor_at_energies(levels, leads.inverse, b)
    _apply_resolvent(levels, b)
    solve(b.re, b.im, b.pivots, b.t[0], b.t[1])
    _add_mixed(levels, b, overlap)
    _add_slope(b)
    for l in range(W):
        norm = complex(b.norm[l], b.norm[W + l])
        shift = complex(overlap[l], overlap[W + l]) / norm
        b.zr[l] -= shift.real
        b.zi[l] = min(b.zi[l] - shift.imag, -1e-16)
        b.scale[l] = 1.0 / np.sqrt(abs(norm))


class Poles(NamedTuple):
    """Poles z with their vectors: G ≈ v vᵀ/(ω − z), v = S t/√norm."""

    z: ComplexArray  # (pole,)
    x: FloatArray  # (pole, 4, level), over +E and over −E: re, im, re, im
    t: ComplexArray  # (pole, 8)
    norm: ComplexArray  # (pole,), xᵀ(1 − H')x


@nb.njit(cache=True)
def _isolation(z: ComplexArray, p: int) -> float:  # pragma: no cover
    """Return how far from pole p the next one, or the mirror image of one, is."""
    x, y = z[p].real, z[p].imag
    nearest = 2 * abs(x) if abs(x) > CENTRAL else np.inf
    nearest *= nearest
    for k in range(z.size):
        if k != p:
            across, along = abs(x) - abs(z[k].real), y - z[k].imag
            nearest = min(nearest, across * across + along * along)
    return float(np.sqrt(nearest))


@nb.njit(cache=True, error_model="numpy")
def iterate(
    poles: Poles, active: NDArray[np.int64], levels: Levels, leads: Leads, b: Batch
) -> None:  # pragma: no cover
    """Iterate the active poles and their vectors in place; `active` is destroyed.

    On entry z and x are approximations, see `pole_starts`. The norm of a pole that does
    not converge is NaN.
    """
    W, size = WIDTH, levels.E.size
    overlap, left = np.empty(2 * W), active.size
    for _ in range(ROUNDS):
        waiting, left = left, 0
        for first in range(0, waiting, W):
            some = min(W, waiting - first)
            for l in range(W):
                p = active[first + min(l, some - 1)]
                b.zr[l], b.zi[l], b.scale[l] = poles.z[p].real, poles.z[p].imag, 1.0
                x = poles.x[p]
                for part in range(4):
                    for n in range(size):
                        b.x[part, n * W + l] = x[part, n]
            for _ in range(STEPS):
                _step(levels, leads, b, overlap)
            for l in range(some):
                p = active[first + l]
                x, before, after = poles.x[p], 0.0, 0.0
                for part in range(4):
                    for n in range(size):
                        x[part, n] = b.x[part, n * W + l] * b.scale[l]
                        after += x[part, n] ** 2
                        before += b.parts[4 + part, n * W + l] ** 2
                for i in range(8):
                    t = complex(b.t[0, i * W + l], b.t[1, i * W + l])
                    poles.t[p, i] = t * b.scale[l]
                norm = complex(b.norm[l], b.norm[W + l])
                poles.norm[p] = norm * b.scale[l] ** 2
                poles.z[p] = complex(b.zr[l], b.zi[l])
                off = np.sqrt(before * after) * b.scale[l]
                if not off <= CONVERGED * (FAINT + min(-b.zi[l], _isolation(poles.z, p))):
                    active[left] = p
                    left += 1
        if left == 0:
            break
    for k in range(left):
        poles.norm[active[k]] = np.nan
