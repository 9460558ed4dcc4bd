// The leads attached to the two end sites, and the probabilities between their channels.
//
// With M' of elimination.hpp the end blocks of the Green's function are G = (M' − Σ_L − Σ_R)⁻¹.  The
// leads give the inverse an imaginary part of one sign, which keeps the pivots of symmetric sweeps
// away from zero; what is not symmetric is pivoted.  Then (Fisher and Lee 1981) the probability from
// channel set a to b is Tr[Γ_b G_ba Γ_a G_ba†], Γ = i(Σ − Σ†); where Σ is symmetric, Γ = −2 Im Σ is real.
#pragma once

#include "../values/square8.hpp"
#include "../values/symmetric8.hpp"
#include "../wire/elimination.hpp"
#include "btk.hpp"

namespace core {

template <class R>
using Ends = Symmetric8<Complex<R>>;

// Σ of the channel sets, each lane with its own: entries 00, 01, 11.
template <class R>
struct LaneLeads {
    Complex<R> of[CHANNELS][3];

    void set(int lane, const LeadSelfEnergy& sigma) {
        for (int c = 0; c < CHANNELS; ++c)
            for (int k = 0; k < 3; ++k) set_lane(of[c][k], lane, sigma.of[c](k / 2, (k + 1) / 2));
    }
    CORE_INLINE R gamma(int c, int i, int j) const { return -2.0 * of[c][i + j].im; }
};

// The same of a tilted field, which is not symmetric.
template <class R>
struct TiltedLaneLeads {
    Complex<R> of[CHANNELS][2][2];

    void set(int lane, const LeadSelfEnergy& sigma) {
        for (int c = 0; c < CHANNELS; ++c)
            for (int k = 0; k < 4; ++k) set_lane(of[c][k / 2][k % 2], lane, sigma.of[c](k / 2, k % 2));
    }
    CORE_INLINE Complex<R> gamma(int c, int i, int j) const {
        Complex<R> one = of[c][i][j], other = of[c][j][i];
        return {-(one.im + other.im), one.re - other.re};
    }
};

template <class R> CORE_INLINE Complex<R> entry(const LaneLeads<R>& leads, int c, int i, int j) { return leads.of[c][i + j]; }
template <class R> CORE_INLINE Complex<R> entry(const TiltedLaneLeads<R>& leads, int c, int i, int j) { return leads.of[c][i][j]; }

// Take the self-energy of the lead on the left end (0) or the right one (1) off a block of its site.
template <class Block, class Leads>
inline void attach_lead(Block& D, const Leads& leads, int end) {
    for (int charge = 0; charge < 2; ++charge)
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j <= (Block::MIRRORED ? i : 1); ++j) {
                auto& at = D(2 * charge + i, 2 * charge + j);
                at = at - entry(leads, 2 * end + charge, i, j);
            }
}

template <class R> CORE_INLINE Complex<R> to_complex(R x) { return {x, R(0.0)}; }
template <class R> CORE_INLINE Complex<R> to_complex(Complex<R> x) { return x; }

// M' as one matrix, left end first.
template <class R, class N>
CORE_INLINE Ends<R> ends_of(const EndBlocks<N>& s) {
    Ends<R> M;
    for (int i = 0; i < 4; ++i) {
        for (int j = i; j < 4; ++j) M(i, j) = to_complex(s.E(i, j)), M(4 + i, 4 + j) = to_complex(s.D(i, j));
        for (int j = 0; j < 4; ++j) M(i, 4 + j) = to_complex(s.C(i, j));
    }
    return M;
}

// G of the two end sites with their leads, in units of 1/t'.
template <class R, class N>
CORE_INLINE Ends<R> attach_leads(const EndBlocks<N>& s, const LaneLeads<R>& leads) {
    Ends<R> G = ends_of<R>(s);
    for (int c = 0; c < CHANNELS; ++c)
        for (int k = 0; k < 3; ++k) {
            Complex<R>& entry = G(2 * c + k / 2, 2 * c + (k + 1) / 2);
            entry = entry - leads.of[c][k];
        }
    invert(G);
    return G;
}

template <class N>
CORE_INLINE Square8<N> ends_of(const EndBlocks<N, Block4<N>>& s) {
    Square8<N> M;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            M(i, j) = s.E(i, j), M(4 + i, 4 + j) = s.D(i, j);
            M(i, 4 + j) = s.C(i, j), M(4 + j, i) = s.F_transposed(i, j);
        }
    return M;
}

template <class N>
CORE_INLINE Square8<N> ends_of(const EndBlocks<N, Hermitian4<N>>& s) {
    Square8<N> M;
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < i; ++j) {
            M(i, j) = s.E(i, j), M(4 + i, 4 + j) = s.D(i, j);
            M(j, i) = conj(s.E(i, j)), M(4 + j, 4 + i) = conj(s.D(i, j));
        }
        M(i, i) = s.E(i, i).re, M(4 + i, 4 + i) = s.D(i, i).re;
        for (int j = 0; j < 4; ++j) M(i, 4 + j) = s.C(i, j), M(4 + j, i) = conj(s.C(i, j));
    }
    return M;
}

template <class R, class Block>
inline Square8<Complex<R>> attach_leads(const EndBlocks<Complex<R>, Block>& s, const TiltedLaneLeads<R>& leads) {
    Square8<Complex<R>> M = ends_of(s);
    for (int c = 0; c < CHANNELS; ++c)
        for (int k = 0; k < 4; ++k) {
            Complex<R>& entry = M(2 * c + k / 2, 2 * c + k % 2);
            entry = entry - leads.of[c][k / 2][k % 2];
        }
    return inverted(M);
}

// Tr[Γ_a G_ab Γ_b G_ab†].
template <class R, class Ends, class Leads>
CORE_INLINE R probability(const Ends& G, const Leads& leads, int a, int b) {
    R total = 0.0;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            Complex<R> left = G(2 * a, 2 * b + j) * leads.gamma(a, i, 0) + G(2 * a + 1, 2 * b + j) * leads.gamma(a, i, 1);
            Complex<R> right = G(2 * a + i, 2 * b) * leads.gamma(b, 0, j) + G(2 * a + i, 2 * b + 1) * leads.gamma(b, 1, j);
            total = total + left.re * right.re + left.im * right.im;
        }
    return total;
}

// All P[out][in]; of a symmetric G it is symmetric.
template <class R, class Ends, class Leads>
CORE_INLINE void fill_probabilities(const Ends& G, const Leads& leads, R (&P)[4][4]) {
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < (Ends::SYMMETRIC ? a + 1 : 4); ++b) {
            P[a][b] = probability<R>(G, leads, a, b);
            if (Ends::SYMMETRIC) P[b][a] = P[a][b];
        }
}

template <class R, class Ends, class Leads>
CORE_INLINE Conductances<R> lossless_conductances_of_ends(const Ends& G, const Leads& leads) {
    R P[4][4];
    fill_probabilities(G, leads, P);
    return lossless_conductances(P);
}

// total − Im Γg.
template <class R> CORE_INLINE R minus_imaginary(R total, R gamma, Complex<R> g) { return total - gamma * g.im; }
template <class R> CORE_INLINE R minus_imaginary(R total, Complex<R> gamma, Complex<R> g) {
    return total - gamma.re * g.im - gamma.im * g.re;
}

// Where the parent superconductor, or the bath of the wire's levels, absorbs.  With r = −1 + iΓ^½GΓ^½,
// N − Tr rr† = −2 Im Tr ΓG − Tr ΓGΓG†, closed channels included.
template <class R, class Ends, class Leads>
CORE_INLINE Conductances<R> lossy_conductances_of_ends(const Ends& G, const Leads& leads) {
    R P[4][4], net[4];
    fill_probabilities(G, leads, P);
    for (int a = 0; a < 4; ++a) {
        R absorbed = 0.0;
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j)
                absorbed = minus_imaginary(absorbed, leads.gamma(a, i, j), G(2 * a + j, 2 * a + i));
        net[a] = 2.0 * absorbed - P[a][a];
    }
    return conductances(P, net);
}

}  // namespace core
