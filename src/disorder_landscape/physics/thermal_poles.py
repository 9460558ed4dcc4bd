"""Thermal averages in closed form (S-I: convolution with −df/dω).

For a pole below the real axis, closing the contour above gives

    ∫ dω (−f'(ω − V))/(ω − z) = ψ₁(½ + i(z − V)/2πkT)/(2πi kT),   Im z < 0,

with the trigamma function ψ₁. What is left of a conductance beside its poles is smooth: the
polynomial through its values at ±ω_k = ±W sin(π(k + ½)/2M), Chebyshev's nodes, is averaged exactly.
"""

from __future__ import annotations

from functools import cache

import numba as nb
import numpy as np

from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.residues import Terms
from disorder_landscape.physics.vectors import WIDTH, everywhere, read, write

SERIES = np.array([-691 / 2730, 5 / 66, -1 / 30, 1 / 42, -1 / 30, 1 / 6])
"""Bernoulli's numbers B₁₂ … B₂, of Stirling's series."""
REACH = 11.0
"""The nodes span this many kT beyond the largest |V|, where 2e-5 of the kernel is cut."""


@nb.njit(cache=True, error_model="numpy")
def trigamma(
    x: FloatArray, y: FloatArray, re: FloatArray, im: FloatArray
) -> None:  # pragma: no cover
    """Write ψ₁(x + iy), x ≥ ½, of WIDTH numbers, to 1e-12.

    By recurrence and Stirling's series (DLMF 5.15.8).
    """
    one, two = everywhere(1.0), everywhere(2.0)
    u, v = read(x, 0), read(y, 0)
    total_re, total_im = everywhere(0.0), everywhere(0.0)
    for _ in range(8):
        norm = one / (u * u + v * v)
        a, b = u * norm, v * norm
        total_re, total_im = total_re + a * a - b * b, total_im - two * a * b
        u = u + one
    norm = one / (u * u + v * v)
    a, b = u * norm, everywhere(0.0) - v * norm  # 1/z
    c, d = a * a - b * b, two * a * b  # 1/z²
    p, q = everywhere(SERIES[0]), everywhere(0.0)
    for k in range(1, SERIES.size):
        p, q = everywhere(SERIES[k]) + p * c - q * d, p * d + q * c
    p, q = everywhere(0.5) + a * p - b * q, a * q + b * p
    write(re, 0, total_re + a + c * p - d * q)
    write(im, 0, total_im + b + c * q + d * p)


@nb.njit(cache=True, error_model="numpy")
def average_poles(
    terms: Terms, bias: FloatArray, kT: float, out: FloatArray
) -> None:  # pragma: no cover
    """Add the averages of Σ 2 Re[r/(ω − z)] to out, shape (bias, 4)."""
    W = WIDTH
    unit = 1.0 / (2 * np.pi * kT)
    x, y, re, im = np.empty(W), np.empty(W), np.empty(W), np.empty(W)
    sums = np.empty((4, W))
    for b in range(bias.size):
        sums[:] = 0.0
        for first in range(0, terms.zr.size, W):
            write(x, 0, everywhere(0.5) - read(terms.zi, first) * everywhere(unit))
            for hole in range(2):
                V = -bias[b] if hole else bias[b]
                write(y, 0, (read(terms.zr, first) - everywhere(V)) * everywhere(unit))
                trigamma(x, y, re, im)
                kr, ki = read(im, 0) * everywhere(2 * unit), read(re, 0) * everywhere(-2 * unit)
                for c in range(4):
                    row = 4 * hole + c
                    rr, ri = read(terms.re[row], first), read(terms.im[row], first)
                    write(sums[c], 0, read(sums[c], 0) + kr * rr - ki * ri)
        for c in range(4):
            for l in range(W):
                out[b, c] += sums[c, l]


def chebyshev_nodes(window: float, nodes: int) -> FloatArray:
    """Return the positive ones of 2·nodes Chebyshev nodes on [−W, W]; shape (node,)."""
    return np.asarray(window * np.sin(np.pi * (np.arange(nodes) + 0.5) / (2 * nodes)))


@cache
def _kernel_rule() -> tuple[FloatArray, FloatArray]:
    """Return Gauss nodes x and their share of the kernel at ω = V + kT x."""
    x, dx = np.polynomial.legendre.leggauss(240)
    return 32 * x, np.cosh(16 * x) ** -2 * dx


@nb.njit(cache=True)
def _interpolated(u: FloatArray, share: FloatArray, nodes: int) -> FloatArray:  # pragma: no cover
    """Return the weights, shape (row, 2 · node), of the values at ω_k, then −ω_k.

    They give Σ_x share_x f(W u_x) of the polynomial f through these values; u has shape (row, x).
    In plain loops, so that the sums do not depend on where arrays lie in memory.
    """
    terms = 2 * nodes
    weights = np.zeros((u.shape[0], terms))
    moments = np.empty(terms)
    for row in range(u.shape[0]):
        moments[:] = 0.0
        for x in range(u.shape[1]):
            before, now = 1.0, u[row, x]
            moments[0] += share[x]
            for n in range(1, terms):
                moments[n] += share[x] * now
                before, now = now, 2 * u[row, x] * now - before
        for k in range(nodes):
            theta = np.pi * (k + 0.5) / terms
            for sign in range(2):
                at = np.sin(theta) if sign == 0 else -np.sin(theta)
                before, now = 1.0, at
                total = 0.5 * moments[0]
                for n in range(1, terms):
                    total += moments[n] * now
                    before, now = now, 2 * at * now - before
                weights[row, sign * nodes + k] = total / nodes
    return weights


def thermal_node_weights(bias: FloatArray, kT: float, window: float, nodes: int) -> FloatArray:
    """Return the weights of a smooth function's values at ω_k, then −ω_k, (bias, 2 · node).

    They average the polynomial through all 2·nodes values, and leave a constant as it is.
    """
    x, dx = _kernel_rule()
    u = np.clip((bias[:, None] + kT * x) / window, -1, 1)
    return np.asarray(_interpolated(u, dx / dx.sum(), nodes))


def interpolation_weights(u: FloatArray, nodes: int) -> FloatArray:
    """Return the weights, shape (u, 2 · node), of the values at ω_k, then −ω_k, for those at uW."""
    return np.asarray(_interpolated(u[:, None], np.ones(1), nodes))
