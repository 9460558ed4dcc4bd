// The levels far outside the window, as a polynomial in the energy.
//
// What they leave in the ends' Green's function, with t = ω²,
//
//     G₊₊ = ω Σ a aᵀ/(t − E²),   G₊₋ = Σ a bᵀ E/(t − E²),   G₋₋ = ω Σ b bᵀ/(t − E²),
//
// hardly changes over the window: the polynomial in t through Chebyshev's nodes of 0 ≤ t ≤ (NEAR·W)² is
// within 34^−FAR_TERMS of each 1/(t − E²) there.  So poles need to know the other levels alone, half of all.
#pragma once

#include <numbers>

#include "../values/complex.hpp"
#include "../values/vandermonde.hpp"
#include "levels.hpp"

namespace core {

constexpr double NEAR = 1.15;  // levels up to so many windows are poles
constexpr double FAR = 3.0;    // levels from so many times NEAR windows on are far
constexpr int FAR_TERMS = 7;   // coefficients of the polynomial

constexpr int UPPER = 36, SAME = 20;  // entries of a symmetric matrix; those within one chirality
// Where entry (i, j) of a symmetric matrix stands: C = ++ (10), −− (10), then +− (16).
constexpr int place(int i, int j) {
    int a = i < j ? i : j, b = i < j ? j : i;
    auto triangle = [](int p, int q) { return 4 * p - p * (p - 1) / 2 + q - p; };
    return b < 4 ? triangle(a, b) : a >= 4 ? 10 + triangle(a - 4, b - 4) : SAME + 4 * a + b - 4;
}
constexpr auto PLACES = [] {
    std::array<std::array<int, 8>, 8> at{};
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) at[i][j] = place(i, j);
    return at;
}();

inline std::array<double, UPPER> products_of(const Level& level) {
    std::array<double, UPPER> products;
    for (int i = 0; i < 8; ++i)
        for (int j = i; j < 8; ++j) products[PLACES[i][j]] = level.w[i] * level.w[j];
    return products;
}

class FarLevels {
    double edge, unit;                      // meV; (NEAR·W)²
    double coefficient[FAR_TERMS][UPPER]{};  // of t/unit to the power of the first index

    struct Rule {
        double node[FAR_TERMS], inverse[FAR_TERMS][FAR_TERMS];
        Rule() {
            for (int k = 0; k < FAR_TERMS; ++k) node[k] = 0.5 + 0.5 * std::cos(std::numbers::pi * (k + 0.5) / FAR_TERMS);
            invert_vandermonde(node, inverse);
        }
    };

    template <class Z>
    void powers(Z z, Z (&power)[FAR_TERMS]) const {
        using R = typename Z::Real;
        Z over = z * R(1.0 / unit), t = over * z;
        power[0] = Z(R(1.0));
        for (int k = 1; k < FAR_TERMS; ++k) power[k] = power[k - 1] * t;
    }

public:
    FarLevels(const LevelList& levels, double window) : edge(FAR * NEAR * window), unit(NEAR * window * NEAR * window) {
        static const Rule rule;
        double value[FAR_TERMS][UPPER]{};
        for (const Level& level : levels) {
            if (!takes(level)) continue;
            auto product = products_of(level);
            for (int e = SAME; e < UPPER; ++e) product[e] *= level.E;
            for (int k = 0; k < FAR_TERMS; ++k) {
                double share = 1.0 / (rule.node[k] * unit - level.E * level.E);
                for (int e = 0; e < UPPER; ++e) value[k][e] += share * product[e];
            }
        }
        for (int power = 0; power < FAR_TERMS; ++power)
            for (int k = 0; k < FAR_TERMS; ++k)
                for (int e = 0; e < UPPER; ++e) coefficient[power][e] += rule.inverse[power][k] * value[k][e];
    }
    bool takes(const Level& level) const { return level.E >= edge; }

    // G_far at z.
    template <class Z>
    void fill(Z z, Z (&G)[UPPER]) const {
        using R = typename Z::Real;
        Z power[FAR_TERMS];
        powers(z, power);
        for (int e = 0; e < UPPER; ++e) {
            Z total{R(coefficient[0][e])};
            for (int k = 1; k < FAR_TERMS; ++k) total = total + power[k] * R(coefficient[k][e]);
            G[e] = e < SAME ? Z(total * z) : total;
        }
    }

    // xᵀ G_far' y at z.
    template <class Z>
    Z slope_between(const std::array<Z, 8>& x, const std::array<Z, 8>& y, Z z) const {
        using R = typename Z::Real;
        Z power[FAR_TERMS], same[FAR_TERMS], mixed[FAR_TERMS];
        powers(z, power);
        for (int k = 0; k < FAR_TERMS; ++k) same[k] = mixed[k] = Z(R(0.0));
        for (int i = 0; i < 8; ++i)
            for (int j = i; j < 8; ++j) {
                Z pair = x[i] * y[j];
                if (i != j) pair = pair + x[j] * y[i];
                int e = PLACES[i][j];
                auto& sum = e < SAME ? same : mixed;
                for (int k = 0; k < FAR_TERMS; ++k) sum[k] = sum[k] + pair * R(coefficient[k][e]);
            }
        Z total = same[0], rest(R(0.0));
        for (int k = 1; k < FAR_TERMS; ++k) {
            total = total + power[k] * Z(same[k] * R(2 * k + 1));
            rest = rest + power[k - 1] * Z(mixed[k] * R(k));
        }
        return total + rest * Z(z * R(2.0 / unit));
    }
};

}  // namespace core
