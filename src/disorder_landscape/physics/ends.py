"""The leads attached to the two end sites, and the transmission probabilities between them.

With M' of `recursion` the end blocks of the Green's function are G = (M' − Σ_L − Σ_R)⁻¹, an 8×8
complex symmetric matrix per lane, inverted by symmetric sweeps without pivoting: the leads give it
an imaginary part of one sign, which keeps the pivots away from zero. Then (Fisher–Lee) the
probability from channel set a to b is Tr[Γ_b G_ba Γ_a G_ba†], with Γ = −2 Im Σ real symmetric, as Σ
is symmetric.
"""

from __future__ import annotations

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.recursion import C_AT, D_AT, E_AT, LANES

LEFT_ELECTRON, LEFT_HOLE, RIGHT_ELECTRON, RIGHT_HOLE = 0, 1, 2, 3
CHANNELS = np.array([(0, 1), (2, 3), (0, 2), (1, 3), (0, 3), (1, 2)])
"""The two channel sets of each probability: Andreev at L, at R, then ee, hh, eh, he."""
CONDUCTANCE_WEIGHTS = np.array(
    [
        [[2, 0, 1, 0, 1, 0], [0, 2, 1, 0, 0, 1], [0, 0, 1, 0, 0, -1], [0, 0, 1, 0, -1, 0]],
        [[2, 0, 0, 1, 0, 1], [0, 2, 0, 1, 1, 0], [0, 0, 0, 1, -1, 0], [0, 0, 0, 1, 0, -1]],
    ],
    dtype=np.float64,
)
"""G_LL, G_RR, G_LR, G_RL as sums of the probabilities: shape (sign of ω, 4, 6), + first."""


@nb.njit(cache=True, error_model="numpy")
def end_green_functions(
    s: FloatArray, sigma: ComplexArray, energy: NDArray[np.int64], re: FloatArray, im: FloatArray
) -> None:  # pragma: no cover
    """Write −G of the two end sites into re and im, shape (64 · LANES,), in units of 1/t'.

    s is the state that `eliminate_inner_sites` leaves; sigma the leads' self-energies in units of
    t', shape (energy, lead, charge, 2, 2); energy[l] tells which of them belongs to lane l. The
    matrix has the left end's four entries first; entry (i, j) of lane l is at [(8i + j)·LANES + l].
    """
    L = LANES
    upper = 0
    for i in range(4):
        for j in range(i, 4):
            for l in range(L):
                re[(8 * i + j) * L + l] = s[(E_AT + upper) * L + l]
                re[(8 * i + j + 36) * L + l] = s[(D_AT + upper) * L + l]
                im[(8 * i + j) * L + l] = 0.0
                im[(8 * i + j + 36) * L + l] = 0.0
            upper += 1
    for i in range(4):
        for j in range(4):
            for l in range(L):
                re[(8 * i + j + 4) * L + l] = s[(C_AT + 4 * i + j) * L + l]
                im[(8 * i + j + 4) * L + l] = 0.0
    for block in range(4):
        for i in range(2):
            for j in range(i, 2):
                at = (8 * (2 * block + i) + 2 * block + j) * L
                for l in range(L):
                    entry = sigma[energy[l], block // 2, block % 2, i, j]
                    re[at + l] -= entry.real
                    im[at + l] -= entry.imag
    for k in range(8):
        d = 9 * k * L
        for l in range(L):
            norm = 1.0 / (re[d + l] ** 2 + im[d + l] ** 2)
            re[d + l], im[d + l] = re[d + l] * norm, -im[d + l] * norm
        for i in range(8):
            if i == k:
                continue
            # entries (i, k) and (k, j) are stored in the upper triangle
            ik = (8 * min(i, k) + max(i, k)) * L
            for j in range(i, 8):
                if j == k:
                    continue
                kj, ij = (8 * min(j, k) + max(j, k)) * L, (8 * i + j) * L
                for l in range(L):
                    pr = re[ik + l] * re[d + l] - im[ik + l] * im[d + l]
                    pi = re[ik + l] * im[d + l] + im[ik + l] * re[d + l]
                    re[ij + l] -= pr * re[kj + l] - pi * im[kj + l]
                    im[ij + l] -= pr * im[kj + l] + pi * re[kj + l]
        for i in range(8):
            if i == k:
                continue
            ik = (8 * min(i, k) + max(i, k)) * L
            for l in range(L):
                pr = re[ik + l] * re[d + l] - im[ik + l] * im[d + l]
                im[ik + l] = re[ik + l] * im[d + l] + im[ik + l] * re[d + l]
                re[ik + l] = pr
        for l in range(L):
            re[d + l], im[d + l] = -re[d + l], -im[d + l]


@nb.njit(cache=True)
def _probability(
    g: FloatArray, a: int, b: int, A: FloatArray, B: FloatArray, lane: int
) -> float:  # pragma: no cover
    """Return Tr[Γ_a g Γ_b gᵀ] for the real or imaginary part g of block (a, b), a ≤ b."""
    L = LANES
    at = (16 * a + 2 * b) * L + lane
    g00, g01, g10, g11 = g[at], g[at + L], g[at + 8 * L], g[at + 9 * L]
    if a == b:
        g10 = g01
    h00, h01 = A[0] * g00 + A[1] * g10, A[0] * g01 + A[1] * g11
    h10, h11 = A[1] * g00 + A[2] * g10, A[1] * g01 + A[2] * g11
    k00, k01 = h00 * B[0] + h01 * B[1], h00 * B[1] + h01 * B[2]
    k10, k11 = h10 * B[0] + h11 * B[1], h10 * B[1] + h11 * B[2]
    return float(k00 * g00 + k01 * g01 + k10 * g10 + k11 * g11)


@nb.njit(cache=True)
def lane_conductances(
    re: FloatArray, im: FloatArray, sigma: ComplexArray, lane: int, out: FloatArray
) -> None:  # pragma: no cover
    """Write the BTK conductances of one lane at ±ω into out, shape (2, 4): LL, RR, LR, RL.

    sigma: that lane's self-energies, shape (lead, charge, 2, 2). Below the gap the probabilities
    sum to one, so N_e − R_ee + R_he = 2 R_he + T_ee + T_he, a sum without cancellation; and as G is
    symmetric, so are the probabilities.
    """
    gamma = np.empty((4, 3))
    for block in range(4):
        b = sigma[block // 2, block % 2]
        gamma[block, 0], gamma[block, 1] = -2 * b[0, 0].imag, -2 * b[0, 1].imag
        gamma[block, 2] = -2 * b[1, 1].imag
    p = np.empty((4, 4))
    for a in range(4):
        for b in range(a + 1, 4):
            p[a, b] = _probability(re, a, b, gamma[a], gamma[b], lane)
            p[a, b] += _probability(im, a, b, gamma[a], gamma[b], lane)
    andreev_left, andreev_right = p[LEFT_ELECTRON, LEFT_HOLE], p[RIGHT_ELECTRON, RIGHT_HOLE]
    ee, hh = p[LEFT_ELECTRON, RIGHT_ELECTRON], p[LEFT_HOLE, RIGHT_HOLE]
    eh, he = p[LEFT_ELECTRON, RIGHT_HOLE], p[LEFT_HOLE, RIGHT_ELECTRON]
    # at +ω electrons come in, at −ω (by particle–hole symmetry) holes
    out[0, 0], out[0, 1] = 2 * andreev_left + ee + eh, 2 * andreev_right + ee + he
    out[0, 2], out[0, 3] = ee - he, ee - eh
    out[1, 0], out[1, 1] = 2 * andreev_left + hh + he, 2 * andreev_right + hh + eh
    out[1, 2], out[1, 3] = hh - eh, hh - he
