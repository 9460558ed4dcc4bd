"""Conductances as sums over poles, G₀(ω) = Σ 2 Re[r/(ω − z)] + smooth.

A probability is Tr[Γ_a G_ab Γ_b G_ab†]. On the real axis G† is the function G(z*)†, which is
analytic where G has its poles z. So the residue of the probability at z is

    r_ab = (Γ_a v_a)ᵀ [G_ab(z*)]* (Γ_b v_b),   Γ = −2 Im Σ continued from the real axis,

and the thermal average of every term has a closed form (see `thermal_poles`).
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.resonances import (
    CUBIC,
    POLES,
    dressed_green_functions,
    upper_index,
)

PAIRS = ((0, 1), (2, 3), (0, 2), (1, 3), (0, 3), (1, 2))
"""Pairs of channel sets Le, Lh, Re, Rh: Andreev at L, at R, then ee, hh, eh, he."""


@nb.njit(cache=True)
def to_physical(v: ComplexArray, out: ComplexArray) -> None:  # pragma: no cover
    """Undo `levels.to_chiral` for a vector."""
    half = np.sqrt(0.5)
    for end in range(2):
        c0, c1, c2, c3 = v[2 * end], v[2 * end + 1], v[4 + 2 * end], v[5 + 2 * end]
        out[4 * end], out[4 * end + 1] = half * (c1 + c3), half * (c0 + c2)
        out[4 * end + 2], out[4 * end + 3] = half * (c0 - c2), half * (c3 - c1)


@nb.njit(cache=True, error_model="numpy")
def conductance_residues(
    z: ComplexArray,
    v: ComplexArray,
    E: FloatArray,
    products: FloatArray,
    terms: ComplexArray,
    out: ComplexArray,
) -> None:  # pragma: no cover
    """Write the residues of G_LL, G_RR, G_LR, G_RL, electrons and holes incident: (pole, 2, 4)."""
    sigma = np.empty((POLES, 8, 8), dtype=np.complex128)
    G = np.empty((POLES, 8, 8), dtype=np.complex128)
    rows, columns = np.empty((8, 8), dtype=np.complex128), np.empty((8, 8), dtype=np.complex128)
    gamma, g_rows = np.empty((8, 8), dtype=np.complex128), np.empty((8, 8), dtype=np.complex128)
    vector, y = np.empty(8, dtype=np.complex128), np.empty(8, dtype=np.complex128)
    p = np.empty(6, dtype=np.complex128)
    for first in range(0, z.size, POLES):
        last = min(first + POLES, z.size)
        dressed_green_functions(np.conj(z[first:last]), E, products, terms, sigma, G)
        for k in range(first, last):
            to_physical(v[k], vector)
            for i in range(8):
                to_physical(G[k - first, i], rows[i])
                for j in range(8):
                    at = upper_index(i, j)
                    value = 0j
                    for power in range(CUBIC - 1, -1, -1):
                        value = value * z[k] - 2 * terms[power, at].imag
                    gamma[i, j] = value
            for i in range(8):
                to_physical(gamma[i], g_rows[i])
            for i in range(8):
                to_physical(rows[:, i], columns[i])
                to_physical(g_rows[:, i], gamma[i])
            for a in range(0, 8, 2):  # y = Γ v
                for i in range(a, a + 2):
                    y[i] = gamma[i, a] * vector[a] + gamma[i, a + 1] * vector[a + 1]
            for pair in range(6):
                a, b = PAIRS[pair]
                p[pair] = 0j
                for i in range(2 * a, 2 * a + 2):
                    for j in range(2 * b, 2 * b + 2):
                        p[pair] += y[i] * np.conj(columns[j, i]) * y[j]
            al, ar, ee, hh, eh, he = p
            r = out[k]
            r[0, 0], r[0, 1] = 2 * al + ee + eh, 2 * ar + ee + he
            r[0, 2], r[0, 3] = ee - he, ee - eh
            r[1, 0], r[1, 1] = 2 * al + hh + he, 2 * ar + hh + eh
            r[1, 2], r[1, 3] = hh - eh, hh - he


@nb.njit(cache=True, error_model="numpy")
def pole_sum(
    w: float, z: ComplexArray, r: ComplexArray, paired: int, out: FloatArray
) -> None:  # pragma: no cover
    """Write Σ 2 Re[r/(ω − z)] over all poles at a real ω of either sign, shape (4,).

    A mirror image −z* has the residue −r̄* of the other incident charge.
    """
    out[:] = 0.0
    for k in range(z.size):
        zr, zi = z[k].real, z[k].imag
        norm = 2.0 / ((w - zr) ** 2 + zi * zi)
        ar, ai = (w - zr) * norm, zi * norm
        for c in range(4):
            out[c] += ar * r[k, 0, c].real - ai * r[k, 0, c].imag
        if k < paired:
            norm = 2.0 / ((w + zr) ** 2 + zi * zi)
            ar, ai = -(w + zr) * norm, zi * norm
            for c in range(4):
                out[c] += ar * r[k, 1, c].real - ai * r[k, 1, c].imag
