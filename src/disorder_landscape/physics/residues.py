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
from disorder_landscape.physics.resonances import CUBIC, upper_index

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


@nb.njit(cache=True)
def _end_to_chiral(end: int, c: ComplexArray, out: ComplexArray) -> None:  # pragma: no cover
    """Write the chiral form, shape (8,), of a vector (u↑, u↓, −v↓, v↑) on one end."""
    half = np.sqrt(0.5)
    out[:] = 0j
    out[2 * end], out[2 * end + 1] = half * (c[1] + c[2]), half * (c[0] - c[3])
    out[4 + 2 * end], out[5 + 2 * end] = half * (c[1] - c[2]), half * (c[0] + c[3])


@nb.njit(cache=True, error_model="numpy")
def conductance_residues(
    z: ComplexArray, v: ComplexArray, G: ComplexArray, terms: ComplexArray, out: ComplexArray
) -> None:  # pragma: no cover
    """Write the residues of G_LL, G_RR, G_LR, G_RL, electrons and holes incident: (pole, 2, 4).

    v: shape (pole, 8), G: G(z*), shape (pole, 8, 8), both in the chiral basis.
    """
    size = v.shape[1]
    y, physical = np.empty(8, dtype=np.complex128), np.empty(8, dtype=np.complex128)
    part = np.empty(4, dtype=np.complex128)
    chiral = np.empty((4, 8), dtype=np.complex128)
    p = np.empty(6, dtype=np.complex128)
    for k in range(z.size):
        y[:] = 0j
        for i in range(size):  # y = Γ v
            for j in range(size):
                if (i // 2) % 2 == (j // 2) % 2:  # on the same end
                    e = upper_index(i, j)
                    value = complex(terms[CUBIC - 1, e].imag)
                    for power in range(CUBIC - 2, -1, -1):
                        value = value * z[k] + terms[power, e].imag
                    y[i] -= 2 * value * v[k, j]
        to_physical(y, physical)
        for block in range(4):
            part[:] = 0j
            first = 2 * (block % 2)
            part[first : first + 2] = physical[2 * block : 2 * block + 2]
            _end_to_chiral(block // 2, part, chiral[block])
        for pair in range(6):
            a, b = PAIRS[pair]
            p[pair] = 0j
            for i in range(size):
                if (i // 2) % 2 == a // 2:
                    for j in range(size):
                        if (j // 2) % 2 == b // 2:
                            p[pair] += chiral[a, i] * np.conj(G[k, i, j]) * chiral[b, j]
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
