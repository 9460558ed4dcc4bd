// The isolated wire reduced to its two end sites.
//
// The leads touch the end sites alone, so the inner sites are eliminated from M = (ω − H)/t',
//
//     M' = [[E, C], [F, D]],   E ← E − C D⁻¹ F,   C ← C D⁻¹,   F ← D⁻¹ F,   D ← A_{n+1} − D⁻¹,
//
// with H of Eq. S1 and its self-energy, D the block of the site that is eliminated next and A_n the
// onsite blocks of M.  A rotation of the spin from site to site, U_n = exp(−iσyφn), tan φ = α/2at,
// has made the hopping −t'τz with t' = √(t² + (α/2a)²), and (−τz)ⁿ at site n makes it t', so that it costs
// nothing.  The one turns the Zeeman term into V_Z(σx cos 2φn + σz sin 2φn), the other gives the pairing
// the sign (−1)ⁿ; at the end the last site is turned back to +1.  In this frame M is symmetric at θ = 0: real below
// the gap of the parent superconductor (Lanes), complex
// above it or where levels are broadened (Complex<Lanes>).  Then F = Cᵀ, and is not kept.  In a tilted
// field the component along the axis of the rotation, V_Z sin θ σy, stays what it is: M is Hermitian
// below the gap, and F = C†; above it or where levels are broadened M is neither that nor symmetric.
//
// Rounding: D is factored, never inverted for E and C.  If a level of the eliminated piece lies at
// ω, D⁻¹ is as large as some g ≫ 1, the next D and C too, and E − C X Cᵀ with an explicit X = D⁻¹
// would lose g² ulps, where the factored E − (W Δ⁻¹) Z, W = C R⁻ᵀ, Z = L⁻¹F, loses g.  The largest |Δ⁻¹| met is
// one measure of it.  It does not show a pair of Majorana modes at the ends of the eliminated piece:
// the pivots stay moderate, C grows as 1/splitting and stays large from site to site, and the terms of
// C D⁻¹ Cᵀ, which cancel, are of the order of |C|².  So the other measure is max|C| at one site times
// max|C| a few sites on: where a level at ω makes C large, it is so for a site or two, and this is of
// the order of g too.  `growth` is the larger one; what is beyond GROWTH_LIMIT is solved by pivoted.hpp.
#pragma once

#include "../values/block4.hpp"

namespace core {

// Sites from one look at C to the next; the last site is looked at, too.  In 8,000 wires (50 to 900
// sites, α to 40 meV nm, a part of them of another µ, mostly at ω = 0), beside those that rounding of µ
// alone changes, a limit of 10⁷ leaves errors up to 1.3e-7 e²/h, and 1.2e-6 with a look at every sixth
// site; the last C alone would leave 2.  None of 50,000 lanes of the paper's wires is beyond it.
constexpr int LOOK_EVERY = 4;
constexpr double GROWTH_LIMIT = 1e7;

// What one wire is in one field, in units of t'; arrays over its sites.
struct WireView {
    int sites;
    const double* V;         // with barriers
    const double* zeeman_x;  // V_Z cos 2φn
    const double* zeeman_z;  // V_Z sin 2φn
    double zeeman_y;
};

// Terms that all sites of a lane share, in units of t'.
template <class N>
struct Terms {
    N kinetic;    // 2t − μ
    N normal;     // ω + γω/√(Δ₀²−ω²)
    N anomalous;  // γΔ₀/√(Δ₀²−ω²)
};

template <class N, class Block = Symmetric4<N>>
struct EndBlocks {
    Block E, D;
    Block4<N> C;
    decltype(size(N())) growth;
};

template <class N>
struct EndBlocks<N, Block4<N>> {
    Block4<N> E, D, C, F_transposed;
    decltype(size(N())) growth;
};

// ⟨↓| −x σx − y σy |↑⟩.
template <class Block, class N>
CORE_INLINE N down_from_up(double x, double y) {
    if constexpr (std::is_same_v<Block, Symmetric4<N>>)
        return -x;
    else
        return {-x, -y};
}

// A_n = normal + anomalous τx − (kinetic + V) τz − x σx − y σy − z σz; in a symmetric one y is zero.
template <class Block, class N>
CORE_INLINE Block onsite(const Terms<N>& of, double V, double x, double y, double z) {
    Block A;
    N q = of.kinetic + V;
    N electron = of.normal - q, hole = of.normal + q;
    N flip = down_from_up<Block, N>(x, y);
    A(0, 0) = electron - z;
    A(1, 0) = flip, A(1, 1) = electron + z;
    A(2, 0) = of.anomalous, A(2, 1) = 0.0, A(2, 2) = hole - z;
    A(3, 0) = 0.0, A(3, 1) = of.anomalous, A(3, 2) = flip, A(3, 3) = hole + z;
    if constexpr (!Block::MIRRORED) {
        A(0, 1) = A(2, 3) = conj(flip);
        A(0, 2) = A(1, 3) = of.anomalous, A(0, 3) = A(1, 2) = 0.0;
    }
    return A;
}

// A − X.
template <class Block>
CORE_INLINE Block minus(const Block& A, const Block& X) {
    Block D;
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i)
#pragma GCC unroll 4
        for (int j = 0; j <= (Block::MIRRORED ? i : 3); ++j) D(i, j) = A(i, j) - X(i, j);
    return D;
}

// Eliminate the site of block D, before the site of onsite block `next`; return X = D⁻¹.
template <class N, class Block>
CORE_INLINE Block eliminate_site(EndBlocks<N, Block>& s, const Block& next) {
    const auto f = factor(s.D);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) s.growth = larger(size(f.over[i]), s.growth);  // of a complex 0 it is NaN
    Block4<N> Z;  // of which this is the transpose: of a symmetric M W, of a Hermitian one W*
    if constexpr (!Block::MIRRORED) {
        Z = s.F_transposed;
#pragma GCC unroll 4
        for (int j = 0; j < 4; ++j) solve_lower(f.left(), Z.entry[j]);
    }
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
        N W[4], U[4];
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) W[k] = s.C(i, k);
        solve_lower(f.right(), W);
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) U[k] = W[k] * f.over[k];
        if constexpr (Block::MIRRORED)
            for (int k = 0; k < 4; ++k) Z(i, k) = mirrored<typename Block::Pivot>(W[k]);
#pragma GCC unroll 4
        for (int j = 0; j <= (Block::MIRRORED ? i : 3); ++j)
            s.E(i, j) = s.E(i, j) - U[0] * Z(j, 0) - U[1] * Z(j, 1) - U[2] * Z(j, 2) - U[3] * Z(j, 3);
        solve_upper(f.left(), U);
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) s.C(i, k) = U[k];
    }
    if constexpr (!Block::MIRRORED) {
#pragma GCC unroll 4
        for (int j = 0; j < 4; ++j) {
#pragma GCC unroll 4
            for (int k = 0; k < 4; ++k) Z(j, k) = Z(j, k) * f.over[k];
            solve_upper(f.right(), Z.entry[j]);
        }
        s.F_transposed = Z;
    }
    Block X = inverse(f);
    s.D = minus(next, X);
    return X;
}

template <class N>
CORE_INLINE auto largest(const Block4<N>& C) {
    auto found = size(C(0, 0));
    for (int k = 1; k < 16; ++k) found = larger(found, size(C(k / 4, k % 4)));
    return found;
}

template <class N, class Block>
CORE_INLINE auto largest_coupling(const EndBlocks<N, Block>& s) {
    if constexpr (Block::MIRRORED)
        return largest(s.C);
    else
        return larger(largest(s.C), largest(s.F_transposed));
}

template <class N, class Block = Symmetric4<N>>
CORE_INLINE EndBlocks<N, Block> first_two_sites(const Block& first, const Block& second) {
    EndBlocks<N, Block> s;
    s.E = first;
    s.D = second;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) s.C(i, j) = i == j ? -1.0 : 0.0;
    if constexpr (!Block::MIRRORED) s.F_transposed = s.C;
    s.growth = 0.0;
    return s;
}

// Turn the last of the sites back from (−τz)ⁿ: its own block, and what couples it to the first.
template <class Block>
CORE_INLINE void turn_back_onsite(int sites, Block& D) {
    if (sites % 2 == 1) return;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j <= (Block::MIRRORED ? i : 3); ++j)
            if ((i < 2) != (j < 2)) D(i, j) = -D(i, j);
}
template <class N>
CORE_INLINE void turn_back_coupling(int sites, Block4<N>& C) {
    if (sites % 2 == 1) return;
    for (int i = 0; i < 4; ++i) C(i, 0) = -C(i, 0), C(i, 1) = -C(i, 1);
}

// The terms of even sites, then of odd ones.
template <class N>
struct TermsOfSites {
    Terms<N> of[2];
    explicit TermsOfSites(const Terms<N>& terms) : of{terms, terms} { of[1].anomalous = -terms.anomalous; }
    CORE_INLINE const Terms<N>& operator()(int n) const { return of[n % 2]; }
};

// Take a look at C now and then, see LOOK_EVERY.
template <class N, class Block>
CORE_INLINE void look_at_coupling(EndBlocks<N, Block>& s, int n, int sites, decltype(size(N()))& before) {
    if (n % LOOK_EVERY != 0 && n != sites - 1) return;
    auto now = largest_coupling(s);
    decltype(now) product = before * now;
    s.growth = larger(s.growth, product);
    before = now;
}

// Block: Symmetric4<N>, Hermitian4<N> or Block4<N>, as M is.
template <class N, class Block = Symmetric4<N>>
inline EndBlocks<N, Block> eliminate_inner_sites(const WireView& wire, const Terms<N>& of) {
    const TermsOfSites<N> terms(of);
    auto A = [&](int n) { return onsite<Block>(terms(n), wire.V[n], wire.zeeman_x[n], wire.zeeman_y, wire.zeeman_z[n]); };
    EndBlocks<N, Block> s = first_two_sites<N>(A(0), A(1));
    decltype(s.growth) before = 1.0;
    for (int n = 2; n < wire.sites; ++n) {
        eliminate_site(s, A(n));
        look_at_coupling(s, n, wire.sites, before);
    }
    turn_back_onsite(wire.sites, s.D), turn_back_coupling(wire.sites, s.C);
    if constexpr (!Block::MIRRORED) turn_back_coupling(wire.sites, s.F_transposed);
    return s;
}

}  // namespace core
