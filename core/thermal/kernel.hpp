// The thermal kernel K_V(z) = −f'(z − V) = sech²((z − V)/2kT)/4kT, continued from the real axis.
#pragma once

#include <complex>

namespace core {

inline std::complex<double> thermal_kernel(std::complex<double> z, double V, double kT) {
    std::complex<double> x = (z - V) / kT, e = std::exp(x.real() > 0 ? -x : x), sum = 1.0 + e;
    return e / (sum * sum) / kT;
}

}  // namespace core
