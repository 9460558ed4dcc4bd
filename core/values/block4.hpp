// 4×4 blocks, one site of the wire or the coupling of two, and how they are factored.
//
// D = LΔRᵀ with unit lower triangular L and R (Golub and Van Loan, Matrix Computations, 3.2 and 4.1);
// of a symmetric block R is L.  All loops have constant bounds and are unrolled, so that entries live
// in registers.
#pragma once

#include "dual.hpp"

namespace core {

template <class N>
struct Block4 {
    static constexpr bool SYMMETRIC = false;
    N entry[4][4];
    CORE_INLINE N& operator()(int i, int j) { return entry[i][j]; }
    CORE_INLINE const N& operator()(int i, int j) const { return entry[i][j]; }
};

// Upper triangle, row by row.
template <class N>
struct Symmetric4 {
    static constexpr bool SYMMETRIC = true;
    static constexpr int ROW[4] = {0, 3, 5, 6};  // entry (i, j), i ≤ j, is at ROW[i] + j
    N entry[10];
    CORE_INLINE N& operator()(int i, int j) { return i <= j ? entry[ROW[i] + j] : entry[ROW[j] + i]; }
    CORE_INLINE const N& operator()(int i, int j) const { return i <= j ? entry[ROW[i] + j] : entry[ROW[j] + i]; }
};

// Unit lower triangular.
template <class N>
struct Triangle4 {
    N l10, l20, l21, l30, l31, l32;
};

// L = R and the reciprocals of Δ.
template <class N>
struct Factors4 : Triangle4<N> {
    N over[4];
    CORE_INLINE const Triangle4<N>& left() const { return *this; }
    CORE_INLINE const Triangle4<N>& right() const { return *this; }
};

// L, R and the reciprocals of Δ.
template <class N>
struct GeneralFactors4 {
    Triangle4<N> L, R;
    N over[4];
    CORE_INLINE const Triangle4<N>& left() const { return L; }
    CORE_INLINE const Triangle4<N>& right() const { return R; }
};

template <class N>
CORE_INLINE Factors4<N> factor(const Symmetric4<N>& D) {
    Factors4<N> f;
    f.over[0] = inverse(D(0, 0));
    f.l10 = D(0, 1) * f.over[0], f.l20 = D(0, 2) * f.over[0], f.l30 = D(0, 3) * f.over[0];
    N e2 = D(1, 2) - f.l10 * D(0, 2), e3 = D(1, 3) - f.l10 * D(0, 3);
    f.over[1] = inverse(D(1, 1) - f.l10 * D(0, 1));
    f.l21 = e2 * f.over[1], f.l31 = e3 * f.over[1];
    N f3 = D(2, 3) - f.l20 * D(0, 3) - f.l21 * e3;
    f.over[2] = inverse(D(2, 2) - f.l20 * D(0, 2) - f.l21 * e2);
    f.l32 = f3 * f.over[2];
    f.over[3] = inverse(D(3, 3) - f.l30 * D(0, 3) - f.l31 * e3 - f.l32 * f3);
    return f;
}

template <class N>
CORE_INLINE GeneralFactors4<N> factor(Block4<N> D) {
    GeneralFactors4<N> f;
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
        f.over[k] = inverse(D(k, k));
#pragma GCC unroll 4
        for (int i = k + 1; i < 4; ++i) {
            D(i, k) = D(i, k) * f.over[k];
#pragma GCC unroll 4
            for (int j = k + 1; j < 4; ++j) D(i, j) = D(i, j) - D(i, k) * D(k, j);
        }
#pragma GCC unroll 4
        for (int j = k + 1; j < 4; ++j) D(k, j) = D(k, j) * f.over[k];
    }
    f.L = {D(1, 0), D(2, 0), D(2, 1), D(3, 0), D(3, 1), D(3, 2)};
    f.R = {D(0, 1), D(0, 2), D(1, 2), D(0, 3), D(1, 3), D(2, 3)};
    return f;
}

// L⁻ᵀΔ⁻¹L⁻¹, the inverse of the factored block.
template <class N>
CORE_INLINE Symmetric4<N> inverse(const Factors4<N>& f) {
    const N &l10 = f.l10, &l20 = f.l20, &l21 = f.l21, &l30 = f.l30, &l31 = f.l31, &l32 = f.l32;
    const N* r = f.over;
    N m20 = l21 * l10 - l20, m31 = l32 * l21 - l31, m30 = l31 * l10 - l30 - l32 * m20;
    N x23 = -(r[3] * l32), x13 = r[3] * m31, x03 = r[3] * m30;
    N y12 = -(r[2] * l21), y02 = r[2] * m20, y01 = -(r[1] * l10);
    Symmetric4<N> X;
    X(3, 3) = r[3], X(2, 3) = x23, X(1, 3) = x13, X(0, 3) = x03;
    X(2, 2) = r[2] - x23 * l32, X(1, 2) = y12 - x13 * l32, X(0, 2) = y02 - x03 * l32;
    X(1, 1) = r[1] - y12 * l21 + x13 * m31, X(0, 1) = y01 - y02 * l21 + x03 * m31;
    X(0, 0) = r[0] - y01 * l10 + y02 * m20 + x03 * m30;
    return X;
}

// x ← x L⁻ᵀ for a row x.
template <class N>
CORE_INLINE void solve_lower(const Triangle4<N>& L, N (&x)[4]) {
    x[1] = x[1] - L.l10 * x[0];
    x[2] = x[2] - L.l20 * x[0] - L.l21 * x[1];
    x[3] = x[3] - L.l30 * x[0] - L.l31 * x[1] - L.l32 * x[2];
}

// x ← x L⁻¹ for a row x.
template <class N>
CORE_INLINE void solve_upper(const Triangle4<N>& L, N (&x)[4]) {
    x[2] = x[2] - x[3] * L.l32;
    x[1] = x[1] - x[2] * L.l21 - x[3] * L.l31;
    x[0] = x[0] - x[1] * L.l10 - x[2] * L.l20 - x[3] * L.l30;
}

// R⁻ᵀΔ⁻¹L⁻¹, the same of a general one.
template <class N>
CORE_INLINE Block4<N> inverse(const GeneralFactors4<N>& f) {
    const auto& [r10, r20, r21, r30, r31, r32] = f.R;
    N m20 = r21 * r10 - r20, m31 = r32 * r21 - r31, m30 = r31 * r10 - r30 - r32 * m20;
    const N* over = f.over;
    Block4<N> X{{{over[0], -(r10 * over[1]), m20 * over[2], m30 * over[3]},
                 {0.0, over[1], -(r21 * over[2]), m31 * over[3]},
                 {0.0, 0.0, over[2], -(r32 * over[3])},
                 {0.0, 0.0, 0.0, over[3]}}};
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) solve_upper(f.L, X.entry[i]);
    return X;
}

}  // namespace core
