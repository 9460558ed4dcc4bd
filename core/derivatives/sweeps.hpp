// How the wire's end blocks answer to every site: real sweeps from both ends.
//
// M = (ω − H)/t' of elimination.hpp, reduced to its two end sites, is M' = Xᵀ M X, where
// X_n = [P_n Q_n] is the wave at site n that the left or the right end site drives while the other one
// is held at zero.  Eliminating the inner sites from the right, or from the left, D ← A_n − τz D⁻¹ τz,
// gives
//
//     P_n = −D_n⁻¹ τz P_{n−1} (right sweep),   Q_n = −D_n⁻¹ τz Q_{n+1} (left sweep),
//
// and E and D of M' as the last D of each, C = P_{N−2}ᵀ τz.  To first order M' changes by X_nᵀ dA_n X_n
// with the onsite block A_n, so a conductance by Tr[S X_nᵀ dA_n X_n] (Feynman 1939, Hellmann 1937, for
// a block), S real symmetric, one for each conductance and lane: see responses.hpp and contraction.hpp.
//
// As in elimination.hpp D is factored, and the waves never see its inverse, which would lose digits
// near the levels of the eliminated piece.  `growth` is the largest |1/Δ|, |P_n| of one look times
// |P_n| of the next, and squared entry of M', which cancels against large X_n.
#pragma once

#include "../wire/elimination.hpp"

namespace core {

// What a sweep leaves at a site; P_n takes the place of the factors that it was made with.
template <class R>
struct Site {
    Factors4<R> left;
    union {
        Factors4<R> right;
        Block4<R> P;
    };
};

template <class R>
CORE_INLINE Block4<R> unit(double size) {
    Block4<R> block;
#pragma GCC unroll 16
    for (int k = 0; k < 16; ++k) block(k / 4, k % 4) = k % 5 == 0 ? size : 0.0;
    return block;
}

// A − τz X τz.
template <class R>
CORE_INLINE Symmetric4<R> minus_hopped(const Symmetric4<R>& A, const Symmetric4<R>& X) {
    Symmetric4<R> D;
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i)
#pragma GCC unroll 4
        for (int j = 0; j <= i; ++j) D(i, j) = (i < 2) == (j < 2) ? A(i, j) - X(i, j) : A(i, j) + X(i, j);
    return D;
}

// −D⁻¹ τz times the wave at the neighbour.
template <class R>
CORE_INLINE Block4<R> carried(const Factors4<R>& D, const Block4<R>& wave) {
    Block4<R> to;
#pragma GCC unroll 4
    for (int c = 0; c < 4; ++c) {
        R x[4] = {-wave(0, c), -wave(1, c), wave(2, c), wave(3, c)};
        solve_lower(D, x);
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) x[k] = x[k] * D.over[k];
        solve_upper(D, x);
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) to(k, c) = x[k];
    }
    return to;
}

// Factor D, and go on to D of the neighbour, whose onsite block is A.
template <class R>
CORE_INLINE Factors4<R> step(Symmetric4<R>& D, const Symmetric4<R>& A, R& growth) {
    Factors4<R> f = factor(D);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) growth = larger(growth, size(f.over[i]));
    D = minus_hopped(A, inverse(f));
    return f;
}

// Fill the sites, and return M'.
template <class R>
inline EndBlocks<R> sweep(const WireView& wire, const Terms<R>& of, Site<R>* sites) {
    int last = wire.sites - 1;
    auto block = [&](int n) { return onsite<Symmetric4<R>>(of, wire.V[n], wire.zeeman_x[n], 0.0, wire.zeeman_z[n]); };
    Symmetric4<R> left = block(1), right = block(last - 1);
    R growth = 0.0, before = 1.0;
    for (int n = 1; n < last; ++n) {  // both at once: each waits for its divisions
        sites[n].left = step(left, block(n + 1), growth);
        sites[last - n].right = step(right, block(last - n - 1), growth);
    }
    Block4<R> P = unit<R>(1.0);
    sites[0].P = P, sites[last].P = unit<R>(0.0);
    for (int n = 1; n < last; ++n) {
        P = carried(sites[n].right, P);
        sites[n].P = P;
        if (n % LOOK_EVERY == 0) {
            R now = largest(P), product = before * now;
            growth = larger(growth, product);
            before = now;
        }
    }
    EndBlocks<R> ends;
    ends.E = right, ends.D = left;
    R most = largest(P);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) ends.C(i, j) = j < 2 ? P(j, i) : -P(j, i);
    for (int k = 0; k < 10; ++k) most = larger(most, larger(size(left.entry[k]), size(right.entry[k])));
    R square = most * most;
    ends.growth = larger(growth, square);
    return ends;
}

}  // namespace core
