// The thermal kernel K_V(z) = −f'(z − V) = sech²((z − V)/2kT)/4kT, continued from the real axis.
#pragma once

#include <complex>

#include "interpolation.hpp"

namespace core {

inline std::complex<double> thermal_kernel(std::complex<double> z, double V, double kT) {
    std::complex<double> x = (z - V) / kT, e = std::exp(x.real() > 0 ? -x : x), sum = 1.0 + e;
    return e / (sum * sum) / kT;
}

// −df/dω at points V + kT·x, as weights.
struct KernelRule {
    static constexpr int POINTS = 240;
    static constexpr double WIDEST = 32.0;
    std::vector<double> x, share;

    KernelRule() {
        const GaussLegendre rule(POINTS);
        double all = 0.0;
        for (int i = 0; i < POINTS; ++i) {
            double half = 1 / std::cosh(WIDEST / 2 * rule.node[i]);
            x.push_back(WIDEST * rule.node[i]), share.push_back(rule.weight[i] * half * half);
            all += share[i];
        }
        for (double& part : share) part /= all;
    }
};

}  // namespace core
