// The ends' Green's function in the basis in which particle–hole symmetry is diagonal.
//
// All matrices are real below the gap, so C = τyσy anticommutes with H.  From (L, R) × (u↑, u↓, −v↓, v↑)
// to C = + + + + − − − −: columns 0–3 are (u↓ − v↓)/√2 and (u↑ − v↑)/√2 of L, then of R; columns 4–7
// are (u↓ + v↓)/√2 and (u↑ + v↑)/√2.
#pragma once

#include "../values/symmetric8.hpp"

namespace core {

// Which entries of the chiral basis lie on which end.
constexpr int ENDS[2][4] = {{0, 1, 4, 5}, {2, 3, 6, 7}};

template <class N>
CORE_INLINE void turn_chiral(const N (&m)[8], N (&row)[8]) {
    const double half = 0.70710678118654752440;
    for (int end = 0; end < 2; ++end) {
        const N* of = m + 4 * end;
        row[2 * end] = half * (of[1] + of[2]), row[2 * end + 1] = half * (of[0] - of[3]);
        row[4 + 2 * end] = half * (of[1] - of[2]), row[5 + 2 * end] = half * (of[0] + of[3]);
    }
}

template <class N>
CORE_INLINE void turn_to_sites(const N (&row)[8], N (&m)[8]) {
    const double half = 0.70710678118654752440;
    for (int end = 0; end < 2; ++end) {
        N* of = m + 4 * end;
        of[0] = half * (row[5 + 2 * end] + row[2 * end + 1]), of[3] = half * (row[5 + 2 * end] - row[2 * end + 1]);
        of[1] = half * (row[2 * end] + row[4 + 2 * end]), of[2] = half * (row[2 * end] - row[4 + 2 * end]);
    }
}

// Turn both sides of a matrix by turn_chiral or turn_to_sites.
template <class N, class Turn>
inline void turn_both(Symmetric8<N>& M, Turn turn) {
    N half[8][8], row[8], turned[8];
    for (int i = 0; i < 8; ++i) {
        for (int j = 0; j < 8; ++j) row[j] = M(i, j);
        turn(row, half[i]);
    }
    for (int j = 0; j < 8; ++j) {
        for (int i = 0; i < 8; ++i) row[i] = half[i][j];
        turn(row, turned);
        for (int i = 0; i <= j; ++i) M(i, j) = turned[i];
    }
}

template <class N>
inline void to_chiral(Symmetric8<N>& M) {
    turn_both(M, [](const N (&m)[8], N (&row)[8]) { turn_chiral(m, row); });
}
template <class N>
inline void to_sites(Symmetric8<N>& M) {
    turn_both(M, [](const N (&row)[8], N (&m)[8]) { turn_to_sites(row, m); });
}

}  // namespace core
