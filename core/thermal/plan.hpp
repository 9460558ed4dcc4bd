// At which energies a set is solved, and what follows from them for all sets alike.
//
// What is left of a conductance beside its poles is smooth: the polynomial through its values at ±ω_k =
// ±W sin(π(k + ½)/2M), Chebyshev's nodes, is averaged exactly.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "../poles/rows.hpp"
#include "../leads/continued.hpp"

namespace core {

constexpr int CHECKS = 4;   // energies, the same for all sets, at which the model is compared with the solver
constexpr int SOUGHT = 2;   // further ones, each set's own: where its levels are densest (dense.hpp)
constexpr int COMPARED = CHECKS + SOUGHT;
// The lowest of them, where the nodes are at k + ½ and zero is 0: below all nodes, where levels lie that the
// nodes hardly see.  (Without it 13 of 96,000 sets were off by more than 1e-4 e²/h.)
constexpr double LOWEST = 0.2;
// The nodes span this many kT beyond the largest |V|, where 2e-5 of the kernel is cut.
constexpr double REACH = 11.0;

namespace detail {

// Gauss–Legendre nodes and weights on [−1, 1], by Newton's iteration on P_n.
inline void gauss_legendre(int n, std::vector<double>& x, std::vector<double>& weight) {
    x.resize(n), weight.resize(n);
    for (int i = 0; i < n; ++i) {
        double z = -std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1.0;
        for (int step = 0; step < 100; ++step) {
            double before = 1.0, now = z;
            for (int k = 2; k <= n; ++k) {
                double next = ((2 * k - 1) * z * now - (k - 1) * before) / k;
                before = now, now = next;
            }
            slope = n * (z * now - before) / (z * z - 1);
            double change = now / slope;
            z -= change;
            if (std::abs(change) < 1e-15) break;
        }
        x[i] = z;
        weight[i] = 2 / ((1 - z * z) * slope * slope);
    }
}

// −df/dx in units of kT as weights at points x of |x| < 32.
struct ThermalKernel {
    std::vector<double> x, share;
    ThermalKernel() {
        gauss_legendre(240, x, share);
        double all = 0.0;
        for (size_t i = 0; i < x.size(); ++i) {
            double half = 1 / std::cosh(16 * x[i]);
            x[i] *= 32, share[i] *= half * half;
            all += share[i];
        }
        for (double& part : share) part /= all;
    }
};

// The weights of the values at ω_k, then −ω_k, that give Σ_x share_x f(W u_x) of the polynomial f through them.
inline std::vector<double> interpolated(const std::vector<double>& u, const std::vector<double>& share, int nodes) {
    int terms = 2 * nodes;
    std::vector<double> moments(terms, 0.0), weights(padded(terms), 0.0);
    for (size_t i = 0; i < u.size(); ++i) {
        double before = 1.0, now = u[i];
        moments[0] += share[i];
        for (int n = 1; n < terms; ++n) {
            moments[n] += share[i] * now;
            double next = 2 * u[i] * now - before;
            before = now, now = next;
        }
    }
    for (int k = 0; k < nodes; ++k)
        for (int sign = 0; sign < 2; ++sign) {
            double at = std::sin(std::numbers::pi * (k + 0.5) / terms) * (sign == 0 ? 1 : -1);
            double before = 1.0, now = at, total = 0.5 * moments[0];
            for (int n = 1; n < terms; ++n) {
                total += moments[n] * now;
                double next = 2 * at * now - before;
                before = now, now = next;
            }
            weights[sign * nodes + k] = total / nodes;
        }
    return weights;
}

}  // namespace detail

// W in meV, up to which energies count.
inline double window_of(const double* bias, int count, double kT) {
    double largest = 0.0;
    for (int v = 0; v < count; ++v) largest = std::max(largest, std::abs(bias[v]));
    return largest + REACH * kT;
}

struct EnergyPlan {
    int nodes, biases;
    double window, kT;                 // W in meV
    std::vector<double> omega;         // nodes, then checks
    std::vector<double> bias;
    int picks[CUBIC];                  // nodes through which Σ is interpolated
    double cubic[CUBIC][CUBIC];        // inverse of their Vandermonde matrix
    std::vector<std::vector<double>> weights;    // (bias, 2·node), of the smooth part's values at ω_k, then −ω_k
    std::vector<std::vector<double>> at_checks;  // (2·CHECKS, 2·node), of the same for its values at ± the checks

    EnergyPlan(const double* V, int count, double kT, int nodes) : nodes(nodes), biases(count), kT(kT), bias(V, V + count) {
        window = window_of(V, count, kT);
        for (int k = 0; k < nodes; ++k) omega.push_back(window * std::sin(std::numbers::pi * (k + 0.5) / (2 * nodes)));
        for (int k = 0; k < CHECKS; ++k) {
            double between = k == 0 ? LOWEST : double(k * (nodes - 1) / CHECKS);
            omega.push_back(window * std::sin(std::numbers::pi * between / (2 * nodes)));
        }
        double picked[CUBIC];
        for (int k = 0; k < CUBIC; ++k) picks[k] = int((k + 0.5) * nodes / CUBIC), picked[k] = omega[picks[k]];
        invert_vandermonde(picked, cubic);
        for (double v : bias) weights.push_back(averaging_weights(v, kT));
        for (int sign : {1, -1})
            for (int k = 0; k < CHECKS; ++k) at_checks.push_back(detail::interpolated({sign * omega[nodes + k] / window}, {1.0}, nodes));
    }

    // The weights of the smooth part's values at ω_k, then −ω_k, in its average at a bias and a temperature.
    std::vector<double> averaging_weights(double v, double at_kT) const {
        static const detail::ThermalKernel kernel;
        std::vector<double> u;
        for (double x : kernel.x) u.push_back(std::clamp((v + at_kT * x) / window, -1.0, 1.0));
        return detail::interpolated(u, kernel.share, nodes);
    }

    // The weights of the smooth part's values at the nodes for that at any ω but a node: the barycentric
    // formula, in which Chebyshev's node u has ±√(1 − u²).
    std::vector<double> weights_at(double at) const {
        std::vector<double> weights(padded(2 * nodes), 0.0);
        double total = 0.0;
        for (int n = 0; n < 2 * nodes; ++n) {
            double u = omega[n % nodes] / window * (n < nodes ? 1 : -1);
            weights[n] = std::sqrt(1 - u * u) / (at / window - u) * ((n % nodes + n / nodes) % 2 == 1 ? -1 : 1);
            total += weights[n];
        }
        for (double& weight : weights) weight /= total;
        return weights;
    }
};

}  // namespace core
