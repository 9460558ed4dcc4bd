// The basis of the ends in which antiparticles are complex conjugates.
//
// Of an end's e↑, e↓, h↑, h↓ particle–hole symmetry C = τyσy (and conjugation) makes −h↓, h↑, e↓, −e↑.  So
// (e↑ − h↓)/√2, (e↓ + h↑)/√2, i(e↑ + h↓)/√2 and i(e↓ − h↑)/√2 are their own antiparticles: columns of a unitary W.
#pragma once

#include <numbers>

#include "../values/complex.hpp"

namespace core {

namespace detail {

template <class N> CORE_INLINE N times_i(N x) { return {-x.im, x.re}; }

template <class N>
struct Quarter {
    N of[4];
};

// W†x, and xᵀW as (Wᵀx), of one end.
template <bool ADJOINT, class N>
CORE_INLINE Quarter<N> majorana_parts(N up, N down, N hole_up, N hole_down) {
    using R = typename N::Real;
    const R half = std::numbers::sqrt2 / 2;
    N a = (up - hole_down) * half, b = (down + hole_up) * half, c = (up + hole_down) * half, d = (down - hole_up) * half;
    c = times_i(c), d = times_i(d);
    if constexpr (ADJOINT) return {{a, b, -c, -d}};
    else return {{a, b, c, d}};
}

// Wx, and xᵀW† as (W*x).
template <bool CONJUGATE, class N>
CORE_INLINE Quarter<N> site_parts(N a, N b, N c, N d) {
    using R = typename N::Real;
    const R half = CONJUGATE ? -std::numbers::sqrt2 / 2 : std::numbers::sqrt2 / 2, whole = std::numbers::sqrt2 / 2;
    N same = a * whole, cross = b * whole, ic = times_i(c) * half, id = times_i(d) * half;
    return {{same + ic, cross + id, cross - id, ic - same}};
}

// Replace rows, then columns of both ends by what these functions make of four of them.
template <class N, class Rows, class Columns>
inline void of_both_ends(N (&M)[8][8], Rows of_rows, Columns of_columns) {
    for (int j = 0; j < 8; ++j)
        for (int end = 0; end < 8; end += 4) {
            Quarter<N> found = of_rows(M[end][j], M[end + 1][j], M[end + 2][j], M[end + 3][j]);
            for (int i = 0; i < 4; ++i) M[end + i][j] = found.of[i];
        }
    for (int i = 0; i < 8; ++i)
        for (int end = 0; end < 8; end += 4) {
            Quarter<N> found = of_columns(M[i][end], M[i][end + 1], M[i][end + 2], M[i][end + 3]);
            for (int j = 0; j < 4; ++j) M[i][end + j] = found.of[j];
        }
}

}  // namespace detail

// M ← W†MW.
template <class N>
inline void to_majorana(N (&M)[8][8]) {
    detail::of_both_ends(M, detail::majorana_parts<true, N>, detail::majorana_parts<false, N>);
}

// M ← WMW†.
template <class N>
inline void from_majorana(N (&M)[8][8]) {
    detail::of_both_ends(M, detail::site_parts<false, N>, detail::site_parts<true, N>);
}

}  // namespace core
