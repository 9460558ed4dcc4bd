// The isolated wire reduced to its two end sites.
//
// The leads touch the end sites alone, so the inner sites are eliminated from M = (ω − H)/t',
//
//     M' = [[E, C], [Cᵀ, D]],   E ← E − C D⁻¹ Cᵀ,   C ← −C D⁻¹ τz,   D ← A_{n+1} − τz D⁻¹ τz,
//
// with H of Eq. S1 and its self-energy, D the block of the site that is eliminated next and A_n the
// onsite blocks of M.  A rotation of the spin from site to site, U_n = exp(−iσyφn), tan φ = α/2at,
// has made the hopping −t'τz with t' = √(t² + (α/2a)²), so that it costs signs only; it turns the
// Zeeman term into V_Z(σx cos 2φn + σz sin 2φn).  In this frame M is symmetric at θ = 0: real below
// the gap of the parent superconductor (Lanes), complex
// above it or where levels are broadened (Complex<Lanes>).
//
// Rounding: D is factored, never inverted for E and C.  If a level of the eliminated piece lies at
// ω, D⁻¹ is as large as some g ≫ 1, the next D and C too, and E − C X Cᵀ with an explicit X = D⁻¹
// would lose g² ulps, where the factored E − (W Δ⁻¹) Wᵀ, W = C L⁻ᵀ, loses g.  The largest |Δ⁻¹| met is
// one measure of it.  It does not show a pair of Majorana modes at the ends of the eliminated piece:
// the pivots stay moderate, C grows as 1/splitting and stays large from site to site, and the terms of
// C D⁻¹ Cᵀ, which cancel, are of the order of |C|².  So the other measure is max|C| at one site times
// max|C| a few sites on: where a level at ω makes C large, it is so for a site or two, and this is of
// the order of g too.  `growth` is the larger one; what is beyond a limit is solved by pivoted.hpp.
#pragma once

#include "../values/block4.hpp"

namespace core {

// Sites from one look at C to the next; the last site is looked at, too.  In 8,000 wires (50 to 900
// sites, α to 40 meV nm, a part of them of another µ, mostly at ω = 0), beside those that rounding of µ
// alone changes, a limit of 10⁷ leaves errors up to 1.3e-7 e²/h, and 1.2e-6 with a look at every sixth
// site; the last C alone would leave 2.  None of 50,000 lanes of the paper's wires is beyond it.
constexpr int LOOK_EVERY = 4;

// What one wire is in one field, in units of t'; arrays over its sites.
struct WireView {
    int sites;
    const double* V;         // with barriers
    const double* zeeman_x;  // V_Z cos 2φn
    const double* zeeman_z;  // V_Z sin 2φn
};

// Terms that all sites of a lane share, in units of t'.
template <class N>
struct Terms {
    N kinetic;    // 2t − μ
    N normal;     // ω + γω/√(Δ₀²−ω²)
    N anomalous;  // γΔ₀/√(Δ₀²−ω²)
};

template <class N>
struct EndBlocks {
    Symmetric4<N> E, D;
    Block4<N> C;
    decltype(size(N())) growth;
};

// A_n = normal + anomalous τx − (kinetic + V) τz − x σx − z σz.
template <class N>
CORE_INLINE Symmetric4<N> onsite(const Terms<N>& of, double V, double x, double z) {
    Symmetric4<N> A;
    N q = of.kinetic + V;
    N electron = of.normal - q, hole = of.normal + q;
    A(0, 0) = electron - z, A(0, 1) = -x, A(0, 2) = of.anomalous, A(0, 3) = 0.0;
    A(1, 1) = electron + z, A(1, 2) = 0.0, A(1, 3) = of.anomalous;
    A(2, 2) = hole - z, A(2, 3) = -x;
    A(3, 3) = hole + z;
    return A;
}

// A − τz X τz.
template <class N>
CORE_INLINE Symmetric4<N> minus_hopped(const Symmetric4<N>& A, const Symmetric4<N>& X) {
    Symmetric4<N> D;
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i)
#pragma GCC unroll 4
        for (int j = i; j < 4; ++j) D(i, j) = (i < 2) == (j < 2) ? A(i, j) - X(i, j) : A(i, j) + X(i, j);
    return D;
}

// Eliminate the site of block D, before the site of onsite block `next`; return X = D⁻¹.
template <class N>
CORE_INLINE Symmetric4<N> eliminate_site(EndBlocks<N>& s, const Symmetric4<N>& next) {
    Factors4<N> f = factor(s.D);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) s.growth = larger(s.growth, size(f.over[i]));
    N W[4][4];
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
        N U[4];
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) W[i][k] = s.C(i, k);
        solve_lower(f, W[i]);
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) U[k] = W[i][k] * f.over[k];
#pragma GCC unroll 4
        for (int j = 0; j <= i; ++j)
            s.E(j, i) = s.E(j, i) - U[0] * W[j][0] - U[1] * W[j][1] - U[2] * W[j][2] - U[3] * W[j][3];
        solve_upper(f, U);
        s.C(i, 0) = -U[0], s.C(i, 1) = -U[1], s.C(i, 2) = U[2], s.C(i, 3) = U[3];
    }
    Symmetric4<N> X = inverse(f);
    s.D = minus_hopped(next, X);
    return X;
}

template <class N>
CORE_INLINE auto largest_coupling(const Block4<N>& C) {
    auto largest = size(C(0, 0));
    for (int k = 1; k < 16; ++k) largest = larger(largest, size(C(k / 4, k % 4)));
    return largest;
}

template <class N>
CORE_INLINE EndBlocks<N> first_two_sites(const WireView& wire, const Terms<N>& of) {
    EndBlocks<N> s;
    s.E = onsite(of, wire.V[0], wire.zeeman_x[0], wire.zeeman_z[0]);
    s.D = onsite(of, wire.V[1], wire.zeeman_x[1], wire.zeeman_z[1]);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) s.C(i, j) = i != j ? 0.0 : i < 2 ? 1.0 : -1.0;  // τz
    s.growth = 0.0;
    return s;
}

// Take a look at C now and then, see LOOK_EVERY.
template <class N>
CORE_INLINE void look_at_coupling(EndBlocks<N>& s, int n, int sites, decltype(size(N()))& before) {
    if (n % LOOK_EVERY != 0 && n != sites - 1) return;
    auto now = largest_coupling(s.C);
    decltype(now) product = before * now;
    s.growth = larger(s.growth, product);
    before = now;
}

template <class N>
inline EndBlocks<N> eliminate_inner_sites(const WireView& wire, const Terms<N>& of) {
    EndBlocks<N> s = first_two_sites(wire, of);
    decltype(s.growth) before = 1.0;
    for (int n = 2; n < wire.sites; ++n) {
        eliminate_site(s, onsite(of, wire.V[n], wire.zeeman_x[n], wire.zeeman_z[n]));
        look_at_coupling(s, n, wire.sites, before);
    }
    return s;
}

}  // namespace core
