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

REACH = 11.0
"""The nodes span this many kT beyond the largest |V|, where 2e-5 of the kernel is cut."""


@nb.njit(cache=True, fastmath={"contract", "nsz", "reassoc"}, error_model="numpy")
def trigamma(x: float, y: float) -> complex:  # pragma: no cover
    """Return ψ₁(x + iy), x > 0, by recurrence and Stirling's series (DLMF 5.15.8), to 1e-12."""
    re = im = 0.0
    while x * x + y * y < 64.0:
        norm = 1.0 / (x * x + y * y)
        u, v = x * norm, -y * norm
        re += u * u - v * v
        im += 2 * u * v
        x += 1.0
    norm = 1.0 / (x * x + y * y)
    i = complex(x * norm, -y * norm)
    i2 = i * i
    series = 1 / 6 - i2 * (
        1 / 30 - i2 * (1 / 42 - i2 * (1 / 30 - i2 * (5 / 66 - i2 * (691 / 2730))))
    )
    return complex(re, im) + i + i2 * (0.5 + i * series)


@nb.njit(cache=True, error_model="numpy")
def thermal_pole(z: complex, V: float, kT: float) -> complex:  # pragma: no cover
    """Return ∫ dω (−f'(ω − V))/(ω − z), Im z < 0."""
    unit = 1.0 / (2 * np.pi * kT)
    psi = trigamma(0.5 - z.imag * unit, (z.real - V) * unit)
    return complex(psi.imag * unit, -psi.real * unit)


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


def thermal_node_weights(
    bias: FloatArray, kT: float, window: float, nodes: int
) -> tuple[FloatArray, FloatArray]:
    """Return the weights of a smooth function's values at ω_k and at −ω_k, each (bias, node).

    They average the polynomial through all 2·nodes values, and leave a constant as it is.
    """
    x, dx = _kernel_rule()
    u = np.clip((bias[:, None] + kT * x) / window, -1, 1)
    weights = _interpolated(u, dx / dx.sum(), nodes)
    return weights[:, :nodes].copy(), weights[:, nodes:].copy()


def interpolation_weights(u: FloatArray, nodes: int) -> FloatArray:
    """Return the weights, shape (u, 2 · node), of the values at ω_k, then −ω_k, for those at uW."""
    return np.asarray(_interpolated(u[:, None], np.ones(1), nodes))
