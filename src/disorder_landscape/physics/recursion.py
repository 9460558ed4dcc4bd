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

What bounds it: 281 multiplications and additions and 4 divisions per site, every operand in the
first cache (10 kB of state): 84,000 operations in the 1.7 µs of a 300-site wire, close to what the
two 256-bit multiply-add units of a Zen 4 core can do. The slopes add 611 per site.

Rounding: D is factored as LΔLᵀ, never inverted for E and C. If a level of the eliminated piece lies
at ω, D⁻¹ is as large as some g ≫ 1, the next D and C too, and E − C X Cᵀ with an explicit X = D⁻¹
would lose g² ulps, where the factored E − (W Δ⁻¹) Wᵀ, W = C L⁻ᵀ, loses g. The largest |Δ⁻¹| met is
one measure of it. It does not show a pair of Majorana modes at the ends of the eliminated piece:
the pivots stay moderate, C grows as 1/splitting and stays large from site to site, and the terms of
C D⁻¹ Cᵀ, which cancel, are of the order of |C|². So the other measure is max|C| at one site times
max|C| a few sites on: where a level at ω makes C large, it is so for a site or two, and this is of
the order of g too. Lanes in which the larger measure is beyond a limit are solved again by
`pivoted`.
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
SLOPES = 40
"""Where dE/dω (10), dC (16), dD (10) and those of the normal and anomalous terms follow."""
NORMAL_SLOPE, ANOMALOUS_SLOPE = 76, 77
STATE_WITH_SLOPES = 78
LOOK_EVERY = 4
"""Sites from one look at C to the next; the last site is looked at, too. In 8,000 wires (50 to 900
sites, α to 40 meV nm, a part of them of another µ, mostly at ω = 0), beside those that roundings of
µ alone change, a limit of 10⁷ leaves errors up to 1.3e-7 e²/h, and 1.2e-6 with a look at every
sixth site; the last C alone would leave 2. None of 50,000 lanes of the paper's wires is beyond it.
A look at every fourth site costs 5 % of the elimination, 1 % with slopes."""
FASTMATH = {"contract", "nsz", "arcp"}


@nb.njit(cache=True)
def _first_two_sites(
    s: FloatArray, V: FloatArray, zeeman_x: FloatArray, zeeman_z: FloatArray
) -> None:  # pragma: no cover
    """Write E, C and D of the first two sites."""
    L = LANES
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


@nb.njit(cache=True, fastmath=FASTMATH, error_model="numpy", boundscheck=False)
def _look_at_coupling(s: FloatArray, last: FloatArray) -> None:  # pragma: no cover
    """Count the product of the largest |C| at the last look and now among the lost digits."""
    L = LANES
    for l in range(L):
        a = max(abs(s[10 * L + l]), abs(s[11 * L + l]), abs(s[12 * L + l]), abs(s[13 * L + l]))
        b = max(abs(s[14 * L + l]), abs(s[15 * L + l]), abs(s[16 * L + l]), abs(s[17 * L + l]))
        c = max(abs(s[18 * L + l]), abs(s[19 * L + l]), abs(s[20 * L + l]), abs(s[21 * L + l]))
        d = max(abs(s[22 * L + l]), abs(s[23 * L + l]), abs(s[24 * L + l]), abs(s[25 * L + l]))
        now = max(a, b, c, d)
        s[39 * L + l] = max(last[l] * now, s[39 * L + l])
        last[l] = now


@nb.njit(cache=True, fastmath=FASTMATH, error_model="numpy", boundscheck=False)
def _eliminate_site(s: FloatArray, Vn: float, x: float, z: float) -> None:  # pragma: no cover
    """Eliminate the site of block D; the next one has the potential Vn and Zeeman terms x, z."""
    L = LANES
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


@nb.njit(cache=True, fastmath=FASTMATH, error_model="numpy", boundscheck=False)
def _differentiate_site(s: FloatArray, Vn: float, x: float, z: float) -> None:  # pragma: no cover
    """Carry dE, dC and dD over the site that `_eliminate_site` has just eliminated.

    With X = D⁻¹, Y = C X (both read off the new D and C) and Z = dC − Y dD of the old blocks,

        dE ← dE − Z Yᵀ − Y dCᵀ,   dC ← −Z X τz,   dD ← dA + τz X dD X τz.
    """
    L = LANES
    for l in range(L):
        w, an, q = s[37 * L + l], s[38 * L + l], s[36 * L + l] + Vn
        x00, x01 = w - q - z - s[26 * L + l], -x - s[27 * L + l]
        x02, x03 = s[28 * L + l] - an, s[29 * L + l]
        x11, x12, x13 = w - q + z - s[30 * L + l], s[31 * L + l], s[32 * L + l] - an
        x22, x23, x33 = w + q - z - s[33 * L + l], -x - s[34 * L + l], w + q + z - s[35 * L + l]
        d00, d01, d02, d03 = s[66 * L + l], s[67 * L + l], s[68 * L + l], s[69 * L + l]
        d11, d12, d13 = s[70 * L + l], s[71 * L + l], s[72 * L + l]
        d22, d23 = s[73 * L + l], s[74 * L + l]
        d33 = s[75 * L + l]
        y00, y01 = -s[10 * L + l], -s[11 * L + l]
        y02, y03 = s[12 * L + l], s[13 * L + l]
        y10, y11 = -s[14 * L + l], -s[15 * L + l]
        y12, y13 = s[16 * L + l], s[17 * L + l]
        y20, y21 = -s[18 * L + l], -s[19 * L + l]
        y22, y23 = s[20 * L + l], s[21 * L + l]
        y30, y31 = -s[22 * L + l], -s[23 * L + l]
        y32, y33 = s[24 * L + l], s[25 * L + l]
        c00, c01, c02, c03 = s[50 * L + l], s[51 * L + l], s[52 * L + l], s[53 * L + l]
        c10, c11, c12, c13 = s[54 * L + l], s[55 * L + l], s[56 * L + l], s[57 * L + l]
        c20, c21, c22, c23 = s[58 * L + l], s[59 * L + l], s[60 * L + l], s[61 * L + l]
        c30, c31, c32, c33 = s[62 * L + l], s[63 * L + l], s[64 * L + l], s[65 * L + l]
        z00 = c00 - y00 * d00 - y01 * d01 - y02 * d02 - y03 * d03
        z01 = c01 - y00 * d01 - y01 * d11 - y02 * d12 - y03 * d13
        z02 = c02 - y00 * d02 - y01 * d12 - y02 * d22 - y03 * d23
        z03 = c03 - y00 * d03 - y01 * d13 - y02 * d23 - y03 * d33
        z10 = c10 - y10 * d00 - y11 * d01 - y12 * d02 - y13 * d03
        z11 = c11 - y10 * d01 - y11 * d11 - y12 * d12 - y13 * d13
        z12 = c12 - y10 * d02 - y11 * d12 - y12 * d22 - y13 * d23
        z13 = c13 - y10 * d03 - y11 * d13 - y12 * d23 - y13 * d33
        z20 = c20 - y20 * d00 - y21 * d01 - y22 * d02 - y23 * d03
        z21 = c21 - y20 * d01 - y21 * d11 - y22 * d12 - y23 * d13
        z22 = c22 - y20 * d02 - y21 * d12 - y22 * d22 - y23 * d23
        z23 = c23 - y20 * d03 - y21 * d13 - y22 * d23 - y23 * d33
        z30 = c30 - y30 * d00 - y31 * d01 - y32 * d02 - y33 * d03
        z31 = c31 - y30 * d01 - y31 * d11 - y32 * d12 - y33 * d13
        z32 = c32 - y30 * d02 - y31 * d12 - y32 * d22 - y33 * d23
        z33 = c33 - y30 * d03 - y31 * d13 - y32 * d23 - y33 * d33
        s[40 * L + l] -= z00 * y00 + z01 * y01 + z02 * y02 + z03 * y03
        s[40 * L + l] -= y00 * c00 + y01 * c01 + y02 * c02 + y03 * c03
        s[41 * L + l] -= z00 * y10 + z01 * y11 + z02 * y12 + z03 * y13
        s[41 * L + l] -= y00 * c10 + y01 * c11 + y02 * c12 + y03 * c13
        s[42 * L + l] -= z00 * y20 + z01 * y21 + z02 * y22 + z03 * y23
        s[42 * L + l] -= y00 * c20 + y01 * c21 + y02 * c22 + y03 * c23
        s[43 * L + l] -= z00 * y30 + z01 * y31 + z02 * y32 + z03 * y33
        s[43 * L + l] -= y00 * c30 + y01 * c31 + y02 * c32 + y03 * c33
        s[44 * L + l] -= z10 * y10 + z11 * y11 + z12 * y12 + z13 * y13
        s[44 * L + l] -= y10 * c10 + y11 * c11 + y12 * c12 + y13 * c13
        s[45 * L + l] -= z10 * y20 + z11 * y21 + z12 * y22 + z13 * y23
        s[45 * L + l] -= y10 * c20 + y11 * c21 + y12 * c22 + y13 * c23
        s[46 * L + l] -= z10 * y30 + z11 * y31 + z12 * y32 + z13 * y33
        s[46 * L + l] -= y10 * c30 + y11 * c31 + y12 * c32 + y13 * c33
        s[47 * L + l] -= z20 * y20 + z21 * y21 + z22 * y22 + z23 * y23
        s[47 * L + l] -= y20 * c20 + y21 * c21 + y22 * c22 + y23 * c23
        s[48 * L + l] -= z20 * y30 + z21 * y31 + z22 * y32 + z23 * y33
        s[48 * L + l] -= y20 * c30 + y21 * c31 + y22 * c32 + y23 * c33
        s[49 * L + l] -= z30 * y30 + z31 * y31 + z32 * y32 + z33 * y33
        s[49 * L + l] -= y30 * c30 + y31 * c31 + y32 * c32 + y33 * c33
        s[50 * L + l] = -(z00 * x00 + z01 * x01 + z02 * x02 + z03 * x03)
        s[51 * L + l] = -(z00 * x01 + z01 * x11 + z02 * x12 + z03 * x13)
        s[52 * L + l] = z00 * x02 + z01 * x12 + z02 * x22 + z03 * x23
        s[53 * L + l] = z00 * x03 + z01 * x13 + z02 * x23 + z03 * x33
        s[54 * L + l] = -(z10 * x00 + z11 * x01 + z12 * x02 + z13 * x03)
        s[55 * L + l] = -(z10 * x01 + z11 * x11 + z12 * x12 + z13 * x13)
        s[56 * L + l] = z10 * x02 + z11 * x12 + z12 * x22 + z13 * x23
        s[57 * L + l] = z10 * x03 + z11 * x13 + z12 * x23 + z13 * x33
        s[58 * L + l] = -(z20 * x00 + z21 * x01 + z22 * x02 + z23 * x03)
        s[59 * L + l] = -(z20 * x01 + z21 * x11 + z22 * x12 + z23 * x13)
        s[60 * L + l] = z20 * x02 + z21 * x12 + z22 * x22 + z23 * x23
        s[61 * L + l] = z20 * x03 + z21 * x13 + z22 * x23 + z23 * x33
        s[62 * L + l] = -(z30 * x00 + z31 * x01 + z32 * x02 + z33 * x03)
        s[63 * L + l] = -(z30 * x01 + z31 * x11 + z32 * x12 + z33 * x13)
        s[64 * L + l] = z30 * x02 + z31 * x12 + z32 * x22 + z33 * x23
        s[65 * L + l] = z30 * x03 + z31 * x13 + z32 * x23 + z33 * x33
        t00 = x00 * d00 + x01 * d01 + x02 * d02 + x03 * d03
        t01 = x00 * d01 + x01 * d11 + x02 * d12 + x03 * d13
        t02 = x00 * d02 + x01 * d12 + x02 * d22 + x03 * d23
        t03 = x00 * d03 + x01 * d13 + x02 * d23 + x03 * d33
        t10 = x01 * d00 + x11 * d01 + x12 * d02 + x13 * d03
        t11 = x01 * d01 + x11 * d11 + x12 * d12 + x13 * d13
        t12 = x01 * d02 + x11 * d12 + x12 * d22 + x13 * d23
        t13 = x01 * d03 + x11 * d13 + x12 * d23 + x13 * d33
        t20 = x02 * d00 + x12 * d01 + x22 * d02 + x23 * d03
        t21 = x02 * d01 + x12 * d11 + x22 * d12 + x23 * d13
        t22 = x02 * d02 + x12 * d12 + x22 * d22 + x23 * d23
        t23 = x02 * d03 + x12 * d13 + x22 * d23 + x23 * d33
        t30 = x03 * d00 + x13 * d01 + x23 * d02 + x33 * d03
        t31 = x03 * d01 + x13 * d11 + x23 * d12 + x33 * d13
        t32 = x03 * d02 + x13 * d12 + x23 * d22 + x33 * d23
        t33 = x03 * d03 + x13 * d13 + x23 * d23 + x33 * d33
        s[66 * L + l] = s[76 * L + l] + (t00 * x00 + t01 * x01 + t02 * x02 + t03 * x03)
        s[67 * L + l] = t00 * x01 + t01 * x11 + t02 * x12 + t03 * x13
        s[68 * L + l] = s[77 * L + l] - (t00 * x02 + t01 * x12 + t02 * x22 + t03 * x23)
        s[69 * L + l] = -(t00 * x03 + t01 * x13 + t02 * x23 + t03 * x33)
        s[70 * L + l] = s[76 * L + l] + (t10 * x01 + t11 * x11 + t12 * x12 + t13 * x13)
        s[71 * L + l] = -(t10 * x02 + t11 * x12 + t12 * x22 + t13 * x23)
        s[72 * L + l] = s[77 * L + l] - (t10 * x03 + t11 * x13 + t12 * x23 + t13 * x33)
        s[73 * L + l] = s[76 * L + l] + (t20 * x02 + t21 * x12 + t22 * x22 + t23 * x23)
        s[74 * L + l] = t20 * x03 + t21 * x13 + t22 * x23 + t23 * x33
        s[75 * L + l] = s[76 * L + l] + (t30 * x03 + t31 * x13 + t32 * x23 + t33 * x33)


@nb.njit(cache=True)
def eliminate_inner_sites(
    s: FloatArray, V: FloatArray, zeeman_x: FloatArray, zeeman_z: FloatArray
) -> None:  # pragma: no cover
    """Reduce the lanes in s to their end sites.

    Parameters
    ----------
    s : array, shape (STATE · LANES,)
        On entry the lanes' kinetic (2t − μ)/t', normal ω(1 + γ/√(Δ₀²−ω²))/t' and anomalous
        γΔ₀/√(Δ₀²−ω²)/t' terms; on return E, C, D and how many ulps were lost: the largest 1/|Δ|
        met, or product of max|C| at two looks in a row.
    V, zeeman_x, zeeman_z : array, shape (site,)
        Potential with barriers and V_Z cos 2φn, V_Z sin 2φn, all in units of t'.
    """
    coupling = np.ones(LANES)
    _first_two_sites(s, V, zeeman_x, zeeman_z)
    for n in range(2, V.size):
        _eliminate_site(s, V[n], zeeman_x[n], zeeman_z[n])
        if n % LOOK_EVERY == 0 or n == V.size - 1:
            _look_at_coupling(s, coupling)


@nb.njit(cache=True)
def eliminate_inner_sites_with_slopes(
    s: FloatArray, V: FloatArray, zeeman_x: FloatArray, zeeman_z: FloatArray
) -> None:  # pragma: no cover
    """Reduce the lanes in s to their end sites and differentiate what is left with respect to ω.

    As `eliminate_inner_sites`, with s of shape (STATE_WITH_SLOPES · LANES,): on entry also the
    derivatives of the normal and anomalous terms, on return also those of E, C and D.
    """
    L = LANES
    coupling = np.ones(L)
    _first_two_sites(s, V, zeeman_x, zeeman_z)
    for k in range(36 * L):
        s[SLOPES * L + k] = 0.0
    for block in (40, 66):  # E and D of a single site
        for l in range(L):
            normal, anomalous = s[76 * L + l], s[77 * L + l]
            for entry in (0, 4, 7, 9):
                s[(block + entry) * L + l] = normal
            s[(block + 2) * L + l] = anomalous
            s[(block + 6) * L + l] = anomalous
    for n in range(2, V.size):
        _eliminate_site(s, V[n], zeeman_x[n], zeeman_z[n])
        if n % LOOK_EVERY == 0 or n == V.size - 1:
            _look_at_coupling(s, coupling)
        _differentiate_site(s, V[n], zeeman_x[n], zeeman_z[n])
