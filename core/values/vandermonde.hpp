// Polynomials through given points.
#pragma once

namespace core {

// The inverse of the nodes' Vandermonde matrix: coefficient i of a polynomial is Σ_k inverse[i][k] f(node k).
// Its columns are the coefficients of the Lagrange polynomials.
template <int n>
inline void invert_vandermonde(const double (&node)[n], double (&inverse)[n][n]) {
    for (int k = 0; k < n; ++k) {
        double coefficient[n] = {1.0}, scale = 1.0;
        int degree = 0;
        for (int j = 0; j < n; ++j) {
            if (j == k) continue;
            for (int i = ++degree; i >= 0; --i) coefficient[i] = (i > 0 ? coefficient[i - 1] : 0.0) - node[j] * coefficient[i];
            scale *= node[k] - node[j];
        }
        for (int i = 0; i < n; ++i) inverse[i][k] = coefficient[i] / scale;
    }
}

}  // namespace core
