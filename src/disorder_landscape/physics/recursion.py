"""The isolated wire reduced to its two end sites, in real arithmetic, many lanes at once.

Below the gap Eq. S1 is a real symmetric matrix, and the leads touch its end sites alone. So the
inner sites are eliminated from M = (ω − H)/t' in real arithmetic,

    M' = [[E, C], [Cᵀ, D]],   E ← E − C D⁻¹ Cᵀ,   C ← −C D⁻¹ τz,   D ← A_{n+1} − τz D⁻¹ τz,

with D the block of the site that is eliminated next and A_n the onsite blocks of M. A rotation of
the spin from site to site, U_n = exp(−iσyφn), tan φ = α/2at, has made the hopping −t'τz with
t' = √(t² + (α/2a)²), so that it costs signs only; it turns the Zeeman term into
V_Z(σx cos 2φn + σz sin 2φn).

Layout: one buffer holds entry k of lane l at s[k·LANES + l], every entry of every 4×4 block its own
scalar in the loop over lanes, the innermost: it then compiles to full-width vector instructions.
A lane is one (μ, ω) of a given wire and field.

Rounding: D is factored as LΔLᵀ, never inverted for E and C. If a level of the eliminated piece lies
at ω, D⁻¹ is as large as some g ≫ 1, the next D and C too, and E − C X Cᵀ with an explicit X = D⁻¹
would lose g² ulps, where the factored E − (W Δ⁻¹) Wᵀ, W = C L⁻ᵀ, loses g. The largest |Δ⁻¹| met is
kept as the measure of it, and lanes beyond a limit are solved again by `pivoted`.
"""

from __future__ import annotations

import numba as nb

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
        γΔ₀/√(Δ₀²−ω²)/t' terms; on return E, C, D and the largest 1/|Δ| met.
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
            # D = LΔLᵀ with unit lower triangular L; r = 1/Δ
            d0, d1, d2, d3 = s[26 * L + l], s[27 * L + l], s[28 * L + l], s[29 * L + l]
            r0 = 1.0 / d0
            l10, l20, l30 = d1 * r0, d2 * r0, d3 * r0
            e2, e3 = s[31 * L + l] - l10 * d2, s[32 * L + l] - l10 * d3
            r1 = 1.0 / (s[30 * L + l] - l10 * d1)
            l21, l31 = e2 * r1, e3 * r1
            f3 = s[34 * L + l] - l20 * d3 - l21 * e3
            r2 = 1.0 / (s[33 * L + l] - l20 * d2 - l21 * e2)
            l32 = f3 * r2
            r3 = 1.0 / (s[35 * L + l] - l30 * d3 - l31 * e3 - l32 * f3)
            growth = max(abs(r0), abs(r1), abs(r2), abs(r3), s[39 * L + l])
            s[39 * L + l] = growth
            # rows of W = C L⁻ᵀ and U = W Δ⁻¹; then E ← E − U Wᵀ and C ← −U L⁻¹ τz
            a0, a1 = s[10 * L + l], s[11 * L + l] - l10 * s[10 * L + l]
            a2 = s[12 * L + l] - l20 * a0 - l21 * a1
            a3 = s[13 * L + l] - l30 * a0 - l31 * a1 - l32 * a2
            b0, b1 = s[14 * L + l], s[15 * L + l] - l10 * s[14 * L + l]
            b2 = s[16 * L + l] - l20 * b0 - l21 * b1
            b3 = s[17 * L + l] - l30 * b0 - l31 * b1 - l32 * b2
            c0, c1 = s[18 * L + l], s[19 * L + l] - l10 * s[18 * L + l]
            c2 = s[20 * L + l] - l20 * c0 - l21 * c1
            c3 = s[21 * L + l] - l30 * c0 - l31 * c1 - l32 * c2
            d0, d1 = s[22 * L + l], s[23 * L + l] - l10 * s[22 * L + l]
            d2 = s[24 * L + l] - l20 * d0 - l21 * d1
            d3 = s[25 * L + l] - l30 * d0 - l31 * d1 - l32 * d2
            u0, u1, u2, u3 = a0 * r0, a1 * r1, a2 * r2, a3 * r3
            s[0 * L + l] -= u0 * a0 + u1 * a1 + u2 * a2 + u3 * a3
            s[1 * L + l] -= u0 * b0 + u1 * b1 + u2 * b2 + u3 * b3
            s[2 * L + l] -= u0 * c0 + u1 * c1 + u2 * c2 + u3 * c3
            s[3 * L + l] -= u0 * d0 + u1 * d1 + u2 * d2 + u3 * d3
            u2 -= u3 * l32
            u1 -= u2 * l21 + u3 * l31
            u0 -= u1 * l10 + u2 * l20 + u3 * l30
            s[10 * L + l], s[11 * L + l], s[12 * L + l], s[13 * L + l] = -u0, -u1, u2, u3
            u0, u1, u2, u3 = b0 * r0, b1 * r1, b2 * r2, b3 * r3
            s[4 * L + l] -= u0 * b0 + u1 * b1 + u2 * b2 + u3 * b3
            s[5 * L + l] -= u0 * c0 + u1 * c1 + u2 * c2 + u3 * c3
            s[6 * L + l] -= u0 * d0 + u1 * d1 + u2 * d2 + u3 * d3
            u2 -= u3 * l32
            u1 -= u2 * l21 + u3 * l31
            u0 -= u1 * l10 + u2 * l20 + u3 * l30
            s[14 * L + l], s[15 * L + l], s[16 * L + l], s[17 * L + l] = -u0, -u1, u2, u3
            u0, u1, u2, u3 = c0 * r0, c1 * r1, c2 * r2, c3 * r3
            s[7 * L + l] -= u0 * c0 + u1 * c1 + u2 * c2 + u3 * c3
            s[8 * L + l] -= u0 * d0 + u1 * d1 + u2 * d2 + u3 * d3
            u2 -= u3 * l32
            u1 -= u2 * l21 + u3 * l31
            u0 -= u1 * l10 + u2 * l20 + u3 * l30
            s[18 * L + l], s[19 * L + l], s[20 * L + l], s[21 * L + l] = -u0, -u1, u2, u3
            u0, u1, u2, u3 = d0 * r0, d1 * r1, d2 * r2, d3 * r3
            s[9 * L + l] -= u0 * d0 + u1 * d1 + u2 * d2 + u3 * d3
            u2 -= u3 * l32
            u1 -= u2 * l21 + u3 * l31
            u0 -= u1 * l10 + u2 * l20 + u3 * l30
            s[22 * L + l], s[23 * L + l], s[24 * L + l], s[25 * L + l] = -u0, -u1, u2, u3
            # X = L⁻ᵀ Δ⁻¹ L⁻¹ and D ← A_{n+1} − τz X τz
            m20, m31 = l21 * l10 - l20, l32 * l21 - l31
            m30 = -l30 - l31 * -l10 - l32 * m20
            x23, x13, x03 = -r3 * l32, r3 * m31, r3 * m30
            y12, y02, y01 = -r2 * l21, r2 * m20, -r1 * l10
            x22, x12, x02 = r2 - x23 * l32, y12 - x13 * l32, y02 - x03 * l32
            x11, x01 = r1 - y12 * l21 + x13 * m31, y01 - y02 * l21 + x03 * m31
            x00 = r0 - y01 * l10 + y02 * m20 + x03 * m30
            w, an, q = s[37 * L + l], s[38 * L + l], s[36 * L + l] + Vn
            s[26 * L + l], s[27 * L + l] = w - q - z - x00, -x - x01
            s[28 * L + l], s[29 * L + l] = an + x02, x03
            s[30 * L + l], s[31 * L + l], s[32 * L + l] = w - q + z - x11, x12, an + x13
            s[33 * L + l], s[34 * L + l], s[35 * L + l] = w + q - z - x22, -x - x23, w + q + z - r3
