"""The isolated wire reduced to its two end sites, in real arithmetic, many lanes at once.

Below the gap Eq. S1 is a real symmetric matrix, and the leads touch its end sites alone. So the
inner sites are eliminated from M = (ω − H)/t' in real arithmetic,

    M' = [[E, C], [Cᵀ, D]],   E ← E − C D⁻¹ Cᵀ,   C ← −C D⁻¹ τz,   D ← A_{n+1} − τz D⁻¹ τz,

with D the block of the site that is eliminated next and A_n the onsite blocks of M. A site-dependent
spin rotation U_n = exp(−iσyφn), tan φ = α/2at, has made the hopping −t'τz, t' = √(t² + (α/2a)²), so
that hopping costs signs only; it turns the Zeeman term into V_Z(σx cos 2φn + σz sin 2φn).

Layout: one buffer holds entry k of lane l at s[k·LANES + l], every entry of every 4×4 block its own
scalar in the loop over lanes, the innermost: it then compiles to full-width vector instructions.
A lane is one (μ, ω) of a given wire and field. Only D's 2×2 blocks are ever divided by; the largest
reciprocal of their determinants is kept as a measure of how many digits the lane has lost.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.parameters import FloatArray

LANES = 16
"""(μ, ω) pairs that one call advances together."""
STATE = 40
"""Entries per lane: E (10), C (16), D (10), kinetic, normal, anomalous terms, lost digits."""
E_AT, C_AT, D_AT = 0, 10, 26
KINETIC, NORMAL, ANOMALOUS, GROWTH = 36, 37, 38, 39


@nb.njit(cache=True, fastmath={"contract", "nsz", "arcp"}, error_model="numpy", boundscheck=False)
def eliminate_inner_sites(
    s: FloatArray, V: FloatArray, zeeman_x: FloatArray, zeeman_z: FloatArray
) -> None:  # pragma: no cover
    """Reduce the lanes in s to their end sites.

    Parameters
    ----------
    s : array, shape (STATE · LANES,)
        On entry the lanes' kinetic (2t − μ)/t', normal ω(1 + γ/√(Δ₀²−ω²))/t' and anomalous
        γΔ₀/√(Δ₀²−ω²)/t' terms; on return E, C, D and the largest 1/|det| met.
    V, zeeman_x, zeeman_z : array, shape (site,)
        Potential with barriers and V_Z cos 2φn, V_Z sin 2φn, all in units of t'.
    """
    L = LANES
    last = V.size - 1
    for l in range(L):
        k, w, a = s[36 * L + l], s[37 * L + l], s[38 * L + l]
        x, z, q = zeeman_x[0], zeeman_z[0], k + V[0]
        s[0 * L + l], s[1 * L + l], s[2 * L + l], s[3 * L + l] = w - q - z, -x, a, 0.0
        s[4 * L + l], s[5 * L + l], s[6 * L + l] = w - q + z, 0.0, a
        s[7 * L + l], s[8 * L + l], s[9 * L + l] = w + q - z, -x, w + q + z
        for j in range(16):
            s[(10 + j) * L + l] = 0.0
        s[10 * L + l], s[15 * L + l], s[20 * L + l], s[25 * L + l] = 1.0, 1.0, -1.0, -1.0
        x, z, q = zeeman_x[1], zeeman_z[1], k + V[1]
        s[26 * L + l], s[27 * L + l], s[28 * L + l], s[29 * L + l] = w - q - z, -x, a, 0.0
        s[30 * L + l], s[31 * L + l], s[32 * L + l] = w - q + z, 0.0, a
        s[33 * L + l], s[34 * L + l], s[35 * L + l] = w + q - z, -x, w + q + z
        s[39 * L + l] = 0.0
    for n in range(1, last):
        Vn, x, z = V[n + 1], zeeman_x[n + 1], zeeman_z[n + 1]
        for l in range(L):
            # D = [[P, Q], [Qᵀ, R]]; X = D⁻¹ through the Schur complement S = R − QᵀP⁻¹Q
            p0, p1, p2 = s[26 * L + l], s[27 * L + l], s[30 * L + l]
            q0, q1, q2, q3 = s[28 * L + l], s[29 * L + l], s[31 * L + l], s[32 * L + l]
            det_p = 1.0 / (p0 * p2 - p1 * p1)
            i0, i1, i2 = p2 * det_p, -p1 * det_p, p0 * det_p
            y0, y1 = i0 * q0 + i1 * q2, i0 * q1 + i1 * q3
            y2, y3 = i1 * q0 + i2 * q2, i1 * q1 + i2 * q3
            r0 = s[33 * L + l] - q0 * y0 - q2 * y2
            r1 = s[34 * L + l] - q0 * y1 - q2 * y3
            r2 = s[35 * L + l] - q1 * y1 - q3 * y3
            det_s = 1.0 / (r0 * r2 - r1 * r1)
            x7, x8, x9 = r2 * det_s, -r1 * det_s, r0 * det_s
            x2, x3 = -(y0 * x7 + y1 * x8), -(y0 * x8 + y1 * x9)
            x5, x6 = -(y2 * x7 + y3 * x8), -(y2 * x8 + y3 * x9)
            x0 = i0 - x2 * y0 - x3 * y1
            x1 = i1 - x2 * y2 - x3 * y3
            x4 = i2 - x5 * y2 - x6 * y3
            s[39 * L + l] = max(s[39 * L + l], max(abs(det_p), abs(det_s)))
            # rows of Z = C X, which give C ← −C X τz and E ← E − Z Cᵀ
            a0, a1, a2, a3 = s[10 * L + l], s[11 * L + l], s[12 * L + l], s[13 * L + l]
            b0, b1, b2, b3 = s[14 * L + l], s[15 * L + l], s[16 * L + l], s[17 * L + l]
            c0, c1, c2, c3 = s[18 * L + l], s[19 * L + l], s[20 * L + l], s[21 * L + l]
            d0, d1, d2, d3 = s[22 * L + l], s[23 * L + l], s[24 * L + l], s[25 * L + l]
            z0 = a0 * x0 + a1 * x1 + a2 * x2 + a3 * x3
            z1 = a0 * x1 + a1 * x4 + a2 * x5 + a3 * x6
            z2 = a0 * x2 + a1 * x5 + a2 * x7 + a3 * x8
            z3 = a0 * x3 + a1 * x6 + a2 * x8 + a3 * x9
            s[0 * L + l] -= z0 * a0 + z1 * a1 + z2 * a2 + z3 * a3
            s[1 * L + l] -= z0 * b0 + z1 * b1 + z2 * b2 + z3 * b3
            s[2 * L + l] -= z0 * c0 + z1 * c1 + z2 * c2 + z3 * c3
            s[3 * L + l] -= z0 * d0 + z1 * d1 + z2 * d2 + z3 * d3
            s[10 * L + l], s[11 * L + l], s[12 * L + l], s[13 * L + l] = -z0, -z1, z2, z3
            z0 = b0 * x0 + b1 * x1 + b2 * x2 + b3 * x3
            z1 = b0 * x1 + b1 * x4 + b2 * x5 + b3 * x6
            z2 = b0 * x2 + b1 * x5 + b2 * x7 + b3 * x8
            z3 = b0 * x3 + b1 * x6 + b2 * x8 + b3 * x9
            s[4 * L + l] -= z0 * b0 + z1 * b1 + z2 * b2 + z3 * b3
            s[5 * L + l] -= z0 * c0 + z1 * c1 + z2 * c2 + z3 * c3
            s[6 * L + l] -= z0 * d0 + z1 * d1 + z2 * d2 + z3 * d3
            s[14 * L + l], s[15 * L + l], s[16 * L + l], s[17 * L + l] = -z0, -z1, z2, z3
            z0 = c0 * x0 + c1 * x1 + c2 * x2 + c3 * x3
            z1 = c0 * x1 + c1 * x4 + c2 * x5 + c3 * x6
            z2 = c0 * x2 + c1 * x5 + c2 * x7 + c3 * x8
            z3 = c0 * x3 + c1 * x6 + c2 * x8 + c3 * x9
            s[7 * L + l] -= z0 * c0 + z1 * c1 + z2 * c2 + z3 * c3
            s[8 * L + l] -= z0 * d0 + z1 * d1 + z2 * d2 + z3 * d3
            s[18 * L + l], s[19 * L + l], s[20 * L + l], s[21 * L + l] = -z0, -z1, z2, z3
            z0 = d0 * x0 + d1 * x1 + d2 * x2 + d3 * x3
            z1 = d0 * x1 + d1 * x4 + d2 * x5 + d3 * x6
            z2 = d0 * x2 + d1 * x5 + d2 * x7 + d3 * x8
            z3 = d0 * x3 + d1 * x6 + d2 * x8 + d3 * x9
            s[9 * L + l] -= z0 * d0 + z1 * d1 + z2 * d2 + z3 * d3
            s[22 * L + l], s[23 * L + l], s[24 * L + l], s[25 * L + l] = -z0, -z1, z2, z3
            # D ← A_{n+1} − τz X τz
            w, an, q = s[37 * L + l], s[38 * L + l], s[36 * L + l] + Vn
            s[26 * L + l], s[27 * L + l] = w - q - z - x0, -x - x1
            s[28 * L + l], s[29 * L + l] = an + x2, x3
            s[30 * L + l], s[31 * L + l], s[32 * L + l] = w - q + z - x4, x5, an + x6
            s[33 * L + l], s[34 * L + l], s[35 * L + l] = w + q - z - x7, -x - x8, w + q + z - x9
