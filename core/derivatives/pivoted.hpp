// The derivatives at one (μ, B, ω) by banded elimination with partial pivoting: for the points at which
// sweeps.hpp has lost digits.
//
// X at all sites is here that of the wire with its leads, complex, and the probability p_ab changes by
// Tr[s dA_n], s = −2 Re X_·b m X_·aᵀ, m of responses.hpp.
#pragma once

#include <array>

#include "../wire/pivoted.hpp"
#include "field.hpp"

namespace core {

using Probabilities = std::array<double, PROBABILITIES>;

struct PivotedDerivatives {
    std::vector<Probabilities> by_V;  // of each site
    Probabilities others[3];          // by μ, B and α
};

inline LaneLeads<double> one_lane(const LeadSelfEnergy& sigma) {
    LaneLeads<double> leads;
    for (int c = 0; c < CHANNELS; ++c)
        for (int k = 0; k < 3; ++k) {
            Amplitude value = sigma.of[c](k / 2, (k + 1) / 2);
            leads.of[c][k] = {value.real(), value.imag()};
        }
    return leads;
}

inline PivotedDerivatives pivoted_derivatives(const TurningField& field, const ComplexTerms& of, const LeadSelfEnergy& sigma,
                                              const LeadSelfEnergy* slopes) {
    using C = Complex<double>;
    std::vector<Amplitude> columns = pivoted_columns(field.wire, of, on_the_ends(sigma));
    int sites = field.wire.sites();
    auto X = [&](int n, int i, int column) {
        Amplitude x = columns[size_t(4 * n + i) * 8 + column];
        return C(x.real(), x.imag());
    };
    Ends<double> G;
    for (int i = 0; i < 8; ++i)
        for (int j = i; j < 8; ++j) G(i, j) = X(i < 4 ? 0 : sites - 1, i % 4, j);
    double normal = of.normal.real(), anomalous = of.anomalous.real();
    PivotedDerivatives found{std::vector<Probabilities>(sites), {}};
    for (int k = 0; k < PROBABILITIES; ++k) {
        int a = FROM[k], b = TO[k];
        Drive<double> drive(G, one_lane(sigma), {{one_lane(slopes[0]), one_lane(slopes[1])}}, a, b);
        double by_field = 0, by_alpha = 0, by_mu = 0;
        for (int n = 0; n < sites; ++n) {
            double s[4][4];
            for (int i = 0; i < 4; ++i) {
                C u[2];
                for (int p = 0; p < 2; ++p) u[p] = X(n, i, 2 * b) * drive.m[0][p] + X(n, i, 2 * b + 1) * drive.m[1][p];
                for (int j = 0; j < 4; ++j) {
                    C y = u[0] * X(n, j, 2 * a) + u[1] * X(n, j, 2 * a + 1);
                    s[i][j] = -2 * y.re;
                }
            }
            double cosine = std::cos(2 * field.angle * n), sine = std::sin(2 * field.angle * n);
            double tau_x = s[0][2] + s[2][0] + s[1][3] + s[3][1], tau_z = s[0][0] + s[1][1] - s[2][2] - s[3][3];
            double sigma_x = s[0][1] + s[1][0] + s[2][3] + s[3][2], sigma_z = s[0][0] - s[1][1] + s[2][2] - s[3][3];
            double along = cosine * sigma_x + sine * sigma_z, across = cosine * sigma_z - sine * sigma_x;
            double onsite = normal * (s[0][0] + s[1][1] + s[2][2] + s[3][3]) + anomalous * tau_x -
                            (of.kinetic + field.wire.V[n]) * tau_z - field.zeeman * along;
            found.by_V[n][k] = -tau_z / field.hop;
            by_mu += tau_z / field.hop;
            by_field += along;
            by_alpha -= field.hop_slope * onsite + field.turns[n].t * across;
        }
        found.others[0][k] = by_mu;
        found.others[1][k] = drive.through_leads[0] - field.zeeman_per_tesla * by_field;
        found.others[2][k] = drive.through_leads[1] + by_alpha;
    }
    return found;
}

}  // namespace core
