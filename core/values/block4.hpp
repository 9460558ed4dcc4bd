// 4×4 blocks, one site of the wire or the coupling of two, and how they are factored.
//
// D = LΔRᵀ with unit lower triangular L and R (Golub and Van Loan, Matrix Computations, 3.2 and 4.1):
// R is L if D is symmetric, and L* if it is Hermitian, where Δ is real.  All loops have constant bounds
// and are unrolled, so that entries live in registers.
#pragma once

#include "complex.hpp"

namespace core {

template <class N>
struct Block4 {
    static constexpr bool MIRRORED = false;  // whether one half says what the other one is
    N entry[4][4];
    CORE_INLINE N& operator()(int i, int j) { return entry[i][j]; }
    CORE_INLINE const N& operator()(int i, int j) const { return entry[i][j]; }
};

// Upper triangle, row by row.
template <class N>
struct Symmetric4 {
    using Number = N;
    using Pivot = N;  // of the type that Δ has
    static constexpr bool MIRRORED = true;
    static constexpr int ROW[4] = {0, 3, 5, 6};  // entry (i, j), i ≤ j, is at ROW[i] + j
    N entry[10];
    CORE_INLINE N& operator()(int i, int j) { return i <= j ? entry[ROW[i] + j] : entry[ROW[j] + i]; }
    CORE_INLINE const N& operator()(int i, int j) const { return i <= j ? entry[ROW[i] + j] : entry[ROW[j] + i]; }
};

// Lower triangle, row by row; imaginary parts on the diagonal are rounding, and not looked at.
template <class N>
struct Hermitian4 {
    using Number = N;
    using Pivot = decltype(size(N()));
    static constexpr bool MIRRORED = true;
    N entry[10];
    CORE_INLINE N& operator()(int i, int j) { return entry[i * (i + 1) / 2 + j]; }
    CORE_INLINE const N& operator()(int i, int j) const { return entry[i * (i + 1) / 2 + j]; }
};

// What the other half of a block with pivots P has where one half has x.
template <class P, class N>
CORE_INLINE N mirrored(N x) {
    if constexpr (std::is_same_v<N, P>)
        return x;
    else
        return conj(x);
}

template <class P, class N>
CORE_INLINE P as_pivot(N x) {
    if constexpr (std::is_same_v<N, P>)
        return x;
    else
        return x.re;
}

// Unit lower triangular.
template <class N>
struct Triangle4 {
    N l10, l20, l21, l30, l31, l32;
};

// L and the reciprocals of Δ, P: those of a mirrored block.
template <class N, class P = N>
struct Factors4 : Triangle4<N> {
    using Block = std::conditional_t<std::is_same_v<N, P>, Symmetric4<N>, Hermitian4<N>>;
    P over[4];
    CORE_INLINE const Triangle4<N>& left() const { return *this; }
    CORE_INLINE Triangle4<N> right() const {
        const auto& [l10, l20, l21, l30, l31, l32] = left();
        return {mirrored<P>(l10), mirrored<P>(l20), mirrored<P>(l21), mirrored<P>(l30), mirrored<P>(l31), mirrored<P>(l32)};
    }
};

// L, R and the reciprocals of Δ.
template <class N>
struct GeneralFactors4 {
    Triangle4<N> L, R;
    N over[4];
    CORE_INLINE const Triangle4<N>& left() const { return L; }
    CORE_INLINE const Triangle4<N>& right() const { return R; }
};

template <class Block>
    requires Block::MIRRORED
CORE_INLINE auto factor(const Block& D) {
    using N = typename Block::Number;
    using P = typename Block::Pivot;
    Factors4<N, P> f;
    f.over[0] = inverse(as_pivot<P>(D(0, 0)));
    f.l10 = D(1, 0) * f.over[0], f.l20 = D(2, 0) * f.over[0], f.l30 = D(3, 0) * f.over[0];
    N r10 = mirrored<P>(f.l10), r20 = mirrored<P>(f.l20), r30 = mirrored<P>(f.l30);
    N e2 = D(2, 1) - r10 * D(2, 0), e3 = D(3, 1) - r10 * D(3, 0);
    N d1 = D(1, 1) - r10 * D(1, 0);
    f.over[1] = inverse(as_pivot<P>(d1));
    f.l21 = e2 * f.over[1], f.l31 = e3 * f.over[1];
    N r21 = mirrored<P>(f.l21), r31 = mirrored<P>(f.l31);
    N f3 = D(3, 2) - r20 * D(3, 0) - r21 * e3;
    N d2 = D(2, 2) - r20 * D(2, 0) - r21 * e2;
    f.over[2] = inverse(as_pivot<P>(d2));
    f.l32 = f3 * f.over[2];
    N d3 = D(3, 3) - r30 * D(3, 0) - r31 * e3 - mirrored<P>(f.l32) * f3;
    f.over[3] = inverse(as_pivot<P>(d3));
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

// R⁻ᵀΔ⁻¹L⁻¹, the inverse of the factored block: of a mirrored one, and below of a general one.
template <class N, class P>
CORE_INLINE auto inverse(const Factors4<N, P>& f) {
    const auto& [l10, l20, l21, l30, l31, l32] = f.left();
    const P* r = f.over;
    N m20 = l21 * l10 - l20, m31 = l32 * l21 - l31, m30 = l31 * l10 - l30 - l32 * m20;
    N r10 = mirrored<P>(l10), r21 = mirrored<P>(l21), r32 = mirrored<P>(l32), n31 = mirrored<P>(m31);
    N x32 = -(l32 * r[3]), x31 = m31 * r[3], x30 = m30 * r[3];
    N y21 = -(l21 * r[2]), y20 = m20 * r[2], y10 = -(l10 * r[1]);
    typename Factors4<N, P>::Block X;
    X(3, 3) = r[3], X(3, 2) = x32, X(3, 1) = x31, X(3, 0) = x30;
    X(2, 2) = N(r[2]) - x32 * r32, X(2, 1) = y21 - x31 * r32, X(2, 0) = y20 - x30 * r32;
    X(1, 1) = N(r[1]) - y21 * r21 + x31 * n31, X(1, 0) = y10 - y20 * r21 + x30 * n31;
    X(0, 0) = N(r[0]) - y10 * r10 + y20 * mirrored<P>(m20) + x30 * mirrored<P>(m30);
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
