// G of the isolated wire's ends and its slope by ω, from M' and dM'/dω (elimination.hpp): G = M'⁻¹ and
// dG = −G dM' G, in the chiral basis.
//
// M' is real here, and the wire with one end taken off may have a level at ω: only with pivoting does the
// inverse keep all digits.  Each lane exchanges its own rows.
#pragma once

#include "../wire/slopes.hpp"
#include "chiral.hpp"

namespace core {

// The inverse of a symmetric matrix by Gauss–Jordan elimination of [M | 1] with partial pivoting.
template <class R>
inline Symmetric8<R> pivoted_inverse(const Symmetric8<R>& M) {
    R a[8][16];
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) a[i][j] = M(i, j), a[i][8 + j] = i == j ? 1.0 : 0.0;
    for (int k = 0; k < 8; ++k) {
        for (int i = k + 1; i < 8; ++i) {
            R here = size(a[k][k]), there = size(a[i][k]);
            for (int j = k; j < 16; ++j) {
                R upper = where_greater(there, here, a[i][j], a[k][j]);
                a[i][j] = where_greater(there, here, a[k][j], a[i][j]);
                a[k][j] = upper;
            }
        }
        R over = inverse(a[k][k]);
        for (int j = k; j < 16; ++j) a[k][j] = a[k][j] * over;
        for (int i = 0; i < 8; ++i) {
            if (i == k) continue;
            R factor = a[i][k];
            for (int j = k; j < 16; ++j) a[i][j] = a[i][j] - factor * a[k][j];
        }
    }
    Symmetric8<R> G;
    for (int i = 0; i < 8; ++i)
        for (int j = i; j < 8; ++j) G(i, j) = a[i][8 + j];
    return G;
}

template <class R>
inline Symmetric8<R> both_ends(const Symmetric4<R>& E, const Block4<R>& C, const Symmetric4<R>& D) {
    Symmetric8<R> M;
    for (int i = 0; i < 4; ++i) {
        for (int j = i; j < 4; ++j) M(i, j) = E(i, j), M(4 + i, 4 + j) = D(i, j);
        for (int j = 0; j < 4; ++j) M(i, 4 + j) = C(i, j);
    }
    return M;
}

template <class R>
inline void isolated_ends(const EndBlocks<R>& s, const EndSlopes<R>& d, Symmetric8<R>& G, Symmetric8<R>& slope) {
    const Symmetric8<R> M = both_ends(s.E, s.C, s.D), dM = both_ends(d.E, d.C, d.D);
    G = pivoted_inverse(M);
    for (int i = 0; i < 8; ++i) {
        R row[8];  // of G dM
        for (int k = 0; k < 8; ++k) {
            row[k] = 0.0;
            for (int j = 0; j < 8; ++j) row[k] = row[k] + G(i, j) * dM(j, k);
        }
        for (int j = i; j < 8; ++j) {
            R total = 0.0;
            for (int k = 0; k < 8; ++k) total = total - row[k] * G(k, j);
            slope(i, j) = total;
        }
    }
    to_chiral(G);
    to_chiral(slope);
}

}  // namespace core
