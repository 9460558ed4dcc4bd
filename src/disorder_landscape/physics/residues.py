"""Conductances as sums over poles, G₀(ω) = Σ 2 Re[r/(ω − z)] + smooth.

A probability is Tr[Γ_a G_ab Γ_b G_ab†]. On the real axis G† is the function G(z*)†, which is
analytic where G has its poles z. So the residue of the probability at z is

    r_ab = (Γ_a v_a)ᵀ [G_ab(z*)]* (Γ_b v_b),   Γ = −2 Im Σ continued from the real axis,

and the thermal average of every term has a closed form (see `thermal_poles`). As G_iso(z*)* is
G_iso(z), [G(z*)]* = S̄ M̄⁻¹ S̄ − S̄ with S̄(z) = S(z*)* and M̄ = S̄ − G_iso(z) (`dressing`).
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
    add_product,
    cubics,
    of_ends,
    solve_lower,
)
from disorder_landscape.physics.ends import CHANNELS, CONDUCTANCE_WEIGHTS
from disorder_landscape.physics.inverse_iteration import Batch, Poles, factor_at_energies
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.vectors import WIDTH, everywhere, read, write


class Terms(NamedTuple):
    """Σ 2 Re[r/(ω − z)]: padded with zeros to full vectors."""

    zr: FloatArray  # (pole,)
    zi: FloatArray
    re: FloatArray  # (8, pole), of r for G_LL, G_RR, G_LR, G_RL, electrons, then holes incident
    im: FloatArray  # a hole's r is 0 where a pole is its own mirror image


@nb.njit(cache=True, error_model="numpy")
def _widths_seen(leads: Leads, b: Batch, y: FloatArray) -> None:  # pragma: no cover
    """Write y = Γ v, v = S t/√norm; y: (2, 8 · WIDTH)."""
    W = WIDTH
    v = np.empty((2, 8 * W))
    cubics(leads.inverse, b.zr, b.zi, b.s)
    of_ends(b.s[0], b.s[1], b.t[0], b.t[1], v[0], v[1])
    for l in range(W):
        root = 1.0 / np.sqrt(complex(b.norm[l], b.norm[W + l]))
        for i in range(8):
            value = complex(v[0, i * W + l], v[1, i * W + l]) * root
            v[0, i * W + l], v[1, i * W + l] = value.real, value.imag
    cubics(leads.gamma, b.zr, b.zi, b.s)
    of_ends(b.s[0], b.s[1], v[0], v[1], y[0], y[1])


@nb.njit(cache=True, error_model="numpy")
def _split_channels(y: FloatArray, c: FloatArray) -> None:  # pragma: no cover
    """Write y's parts on Le, Lh, Re, Rh: (4, 2, 8 · WIDTH), in the chiral basis.

    The electrons' part of (c₊, c₋) is (c₊ + c₋, c₊ + c₋)/2, the holes' (c₊ − c₋, c₋ − c₊)/2.
    """
    W, half, zero = WIDTH, everywhere(0.5), everywhere(0.0)
    for part in range(2):
        for channel in range(4):
            for i in range(8):
                write(c[channel, part], i * W, zero)
        for end in range(2):
            for i in range(2):
                at, to = (2 * end + i) * W, (4 + 2 * end + i) * W
                p, q = read(y[part], at), read(y[part], to)
                even, odd = half * (p + q), half * (p - q)
                write(c[2 * end, part], at, even)
                write(c[2 * end, part], to, even)
                write(c[2 * end + 1, part], at, odd)
                write(c[2 * end + 1, part], to, zero - odd)


@nb.njit(cache=True, error_model="numpy")
def _amplitudes(
    levels: Levels, leads: Leads, b: Batch, c: FloatArray, p: FloatArray
) -> None:  # pragma: no cover
    """Write cᵀ_a [G(z*)]* c_b of the six CHANNELS: (12, WIDTH), re, then im."""
    W = WIDTH
    f, start = np.empty((4, 2, 8 * W)), np.zeros((12, W))
    factor_at_energies(levels, leads.conjugate, b)
    for channel in range(4):
        g = f[channel]
        of_ends(b.s[0], b.s[1], c[channel, 0], c[channel, 1], g[0], g[1])
    for end in range(2):  # −c_a S̄ c_b, for channels on one end
        re, im = everywhere(0.0), everywhere(0.0)
        a, g = c[2 * end], f[2 * end + 1]
        for i in range(4):
            at = ENDS[end, i] * W
            ar, ai, br, bi = read(a[0], at), read(a[1], at), read(g[0], at), read(g[1], at)
            re, im = re - ar * br + ai * bi, im - ar * bi - ai * br
        write(start[end], 0, re)
        write(start[6 + end], 0, im)
    for channel in range(4):
        solve_lower(b.re, b.im, f[channel, 0], f[channel, 1])
    for pair in range(6):
        x, y = f[CHANNELS[pair, 0]], f[CHANNELS[pair, 1]]
        re, im = add_product(b.pivots, x, y, read(start[pair], 0), read(start[6 + pair], 0))
        write(p[pair], 0, re)
        write(p[6 + pair], 0, im)


@nb.njit(cache=True, error_model="numpy")
def conductance_terms(
    poles: Poles,
    order: NDArray[np.int64],
    paired: int,
    levels: Levels,
    leads: Leads,
    b: Batch,
) -> Terms:  # pragma: no cover
    """Return the terms of the poles `order`, of which the first `paired` have mirror images."""
    W = WIDTH
    count = order.size
    full = (count + W - 1) // W * W
    out = Terms(np.zeros(full), np.full(full, -1.0), np.zeros((8, full)), np.zeros((8, full)))
    y, parts, p = np.empty((2, 8 * W)), np.empty((4, 2, 8 * W)), np.empty((12, W))
    for first in range(0, count, W):
        for l in range(W):
            k = order[min(first + l, count - 1)]
            b.zr[l], b.zi[l] = poles.z[k].real, poles.z[k].imag
            b.norm[l], b.norm[W + l] = poles.norm[k].real, poles.norm[k].imag
            for i in range(8):
                b.t[0, i * W + l], b.t[1, i * W + l] = poles.t[k, i].real, poles.t[k, i].imag
        _widths_seen(leads, b, y)
        _split_channels(y, parts)
        _amplitudes(levels, leads, b, parts, p)
        for part in range(2):
            to = out.re if part == 0 else out.im
            for l in range(min(W, count - first)):
                k = first + l
                for hole in range(2 if k < paired else 1):
                    for c in range(4):
                        total = 0.0
                        for pair in range(6):
                            total += CONDUCTANCE_WEIGHTS[hole, c, pair] * p[6 * part + pair, l]
                        to[4 * hole + c, k] = total
        for l in range(min(W, count - first)):
            out.zr[first + l], out.zi[first + l] = b.zr[l], b.zi[l]
    return out


@nb.njit(cache=True, error_model="numpy")
def sum_poles(omega: FloatArray, terms: Terms, out: FloatArray) -> None:  # pragma: no cover
    """Write Σ 2 Re[r/(ω − z)] over all poles at real ω of either sign, shape (4, ω).

    A mirror image −z* has the residue −r̄* of the other incident charge. The ω fill vectors.
    """
    W, two = WIDTH, everywhere(2.0)
    for first in range(0, omega.size, W):
        w = read(omega, first)
        s0, s1, s2, s3 = everywhere(0.0), everywhere(0.0), everywhere(0.0), everywhere(0.0)
        for k in range(terms.zr.size):
            x, y = everywhere(terms.zr[k]), everywhere(terms.zi[k])
            below, above, square = w - x, w + x, y * y
            norm = two / (below * below + square)
            c, d = below * norm, y * norm
            s0 = s0 + c * everywhere(terms.re[0, k]) - d * everywhere(terms.im[0, k])
            s1 = s1 + c * everywhere(terms.re[1, k]) - d * everywhere(terms.im[1, k])
            s2 = s2 + c * everywhere(terms.re[2, k]) - d * everywhere(terms.im[2, k])
            s3 = s3 + c * everywhere(terms.re[3, k]) - d * everywhere(terms.im[3, k])
            norm = two / (above * above + square)
            c, d = above * norm, y * norm
            s0 = s0 - c * everywhere(terms.re[4, k]) - d * everywhere(terms.im[4, k])
            s1 = s1 - c * everywhere(terms.re[5, k]) - d * everywhere(terms.im[5, k])
            s2 = s2 - c * everywhere(terms.re[6, k]) - d * everywhere(terms.im[6, k])
            s3 = s3 - c * everywhere(terms.re[7, k]) - d * everywhere(terms.im[7, k])
        write(out[0], first, s0)
        write(out[1], first, s1)
        write(out[2], first, s2)
        write(out[3], first, s3)
