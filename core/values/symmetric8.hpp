// Complex or real symmetric 8×8 matrices of the wire's two ends, one in each lane.
#pragma once

#include "block4.hpp"

namespace core {

// Upper triangle, row by row.
template <class N>
struct Symmetric8 {
    static constexpr bool SYMMETRIC = true;
    static constexpr int place(int i, int j) {
        return i <= j ? i * 7 - i * (i - 1) / 2 + j : j * 7 - j * (j - 1) / 2 + i;
    }
    N entry[36];
    CORE_INLINE N& operator()(int i, int j) { return entry[place(i, j)]; }
    CORE_INLINE const N& operator()(int i, int j) const { return entry[place(i, j)]; }
};

// Invert in place by symmetric sweeps without pivoting; return the largest |1/pivot|.
template <class N>
inline auto invert(Symmetric8<N>& M) {
    decltype(size(N())) growth = 0.0;
    for (int k = 0; k < 8; ++k) {
        N over = inverse(M(k, k));
        growth = larger(growth, size(over));
        N row[8], scaled[8];
        for (int i = 0; i < 8; ++i) row[i] = M(i, k), scaled[i] = row[i] * over;
        for (int i = 0; i < 8; ++i)
            for (int j = i; j < 8; ++j)
                if (i != k && j != k) M(i, j) = M(i, j) - scaled[i] * row[j];
        for (int i = 0; i < 8; ++i) M(i, k) = scaled[i];
        M(k, k) = -over;
    }
    for (N& entry : M.entry) entry = -entry;
    return growth;
}

}  // namespace core
