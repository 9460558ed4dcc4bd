// det r at ω = 0 (T_IV of the paper): r = −1 + iΓ^½GΓ^½ (Fisher and Lee 1981) of one end, so that
// det r = det(−1 + iΓG), real by particle–hole symmetry.
#pragma once

#include "leads/attach.hpp"

namespace core {

// The determinant of a 4×4 matrix by Gauss's elimination with partial pivoting, one lane.
inline Amplitude determinant(Amplitude (&M)[4][4]) {
    Amplitude product = 1.0;
    for (int k = 0; k < 4; ++k) {
        int pivot = k;
        for (int i = k + 1; i < 4; ++i)
            if (std::abs(M[i][k]) > std::abs(M[pivot][k])) pivot = i;
        if (pivot != k) {
            std::swap(M[k], M[pivot]);
            product = -product;
        }
        product *= M[k][k];
        for (int i = k + 1; i < 4; ++i) {
            Amplitude factor = M[i][k] / M[k][k];
            for (int j = k + 1; j < 4; ++j) M[i][j] -= factor * M[k][j];
        }
    }
    return product;
}

template <class Ends, class Leads>
inline double reflection_determinant(const Ends& G, const Leads& leads, int lead, int lane) {
    Amplitude M[4][4];
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            int charge = i / 2, first = 4 * lead + 2 * charge;
            Amplitude total = 0.0;
            for (int k = 0; k < 2; ++k)
                total += of_lane(leads.gamma(2 * lead + charge, i % 2, k), lane) * of_lane(G(first + k, 4 * lead + j), lane);
            M[i][j] = Amplitude(0.0, 1.0) * total - (i == j ? 1.0 : 0.0);
        }
    return determinant(M).real();
}

}  // namespace core
