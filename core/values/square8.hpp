// 8×8 matrices of the wire's two ends without symmetry, one in each lane.
#pragma once

#include "block4.hpp"

namespace core {

template <class N>
struct Square8 {
    static constexpr bool SYMMETRIC = false;
    N entry[8][8];
    CORE_INLINE N& operator()(int i, int j) { return entry[i][j]; }
    CORE_INLINE const N& operator()(int i, int j) const { return entry[i][j]; }
};

template <int W>
CORE_INLINE Complex<Lanes<W>> where_greater(Lanes<W> a, Lanes<W> b, Complex<Lanes<W>> x, Complex<Lanes<W>> y) {
    return {where_greater(a, b, x.re, y.re), where_greater(a, b, x.im, y.im)};
}

// Swap x and y in the lanes where a > b.
template <class R, class N>
CORE_INLINE void swap_where_greater(R a, R b, N& x, N& y) {
    N kept = x;
    x = where_greater(a, b, y, x);
    y = where_greater(a, b, kept, y);
}

// M⁻¹ by Gauss's elimination with partial pivoting (Golub and Van Loan, 3.4), in each lane its own:
// every larger entry below a pivot is swapped up to it.
template <class N>
inline Square8<N> inverted(Square8<N> M) {
    Square8<N> X;
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) X(i, j) = i == j ? 1.0 : 0.0;
    N over[8];
    for (int k = 0; k < 8; ++k) {
        for (int i = k + 1; i < 8; ++i) {
            const auto below = size(M(i, k)), pivot = size(M(k, k));
            for (int j = k; j < 8; ++j) swap_where_greater(below, pivot, M(k, j), M(i, j));
            for (int j = 0; j < 8; ++j) swap_where_greater(below, pivot, X(k, j), X(i, j));
        }
        over[k] = inverse(M(k, k));
        for (int i = k + 1; i < 8; ++i) {
            const N factor = M(i, k) * over[k];
            for (int j = k + 1; j < 8; ++j) M(i, j) = M(i, j) - factor * M(k, j);
            for (int j = 0; j < 8; ++j) X(i, j) = X(i, j) - factor * X(k, j);
        }
    }
    for (int i = 7; i >= 0; --i)
        for (int j = 0; j < 8; ++j) {
            for (int k = i + 1; k < 8; ++k) X(i, j) = X(i, j) - M(i, k) * X(k, j);
            X(i, j) = X(i, j) * over[i];
        }
    return X;
}

}  // namespace core
