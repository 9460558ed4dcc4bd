// The parent superconductor's self-energy, Σ(ω) = −γ(ω + Δ₀τx)/√(Δ₀²−ω²) (below Eq. S1).
#pragma once

#include <complex>

#include "../values/complex.hpp"
#include "wire.hpp"

namespace core {

// ω − Σ(ω) = normal + anomalous τx, and their derivatives by ω, all in meV; |ω| < Δ₀.
struct Pairing {
    double normal, anomalous, normal_slope, anomalous_slope;

    Pairing(const Wire& wire, double omega) {
        double root = std::sqrt((wire.delta0 - omega) * (wire.delta0 + omega)), cube = root * root * root;
        normal = omega + wire.gamma * omega / root;
        anomalous = wire.gamma * wire.delta0 / root;
        normal_slope = 1 + wire.gamma / root + wire.gamma * omega * omega / cube;
        anomalous_slope = wire.gamma * wire.delta0 * omega / cube;
    }
};

// The same where numbers are complex.
struct RetardedPairing {
    Complex<double> normal, anomalous;

    // At z of the wire and the one of its parent, Im > 0: where levels are broadened the two differ.
    RetardedPairing(const Wire& wire, std::complex<double> z, std::complex<double> of_parent) {
        std::complex<double> over = 1.0 / std::sqrt(wire.delta0 * wire.delta0 - of_parent * of_parent);
        std::complex<double> own = z + wire.gamma * of_parent * over, pair = wire.gamma * wire.delta0 * over;
        normal = {own.real(), own.imag()}, anomalous = {pair.real(), pair.imag()};
    }
    // At a real ω ≠ ±Δ₀, with the broadening of the wire's levels and of its parent's.  Above the gap √(Δ₀²−ω²) is
    // −i sgn(ω) √(ω²−Δ₀²), the retarded branch.
    RetardedPairing(const Wire& wire, double omega) {
        if (wire.parent_dissipation > 0) {
            *this = RetardedPairing(wire, {omega, wire.dissipation}, {omega, wire.parent_dissipation});
            return;
        }
        double size = std::sqrt(std::abs(wire.delta0 * wire.delta0 - omega * omega));
        Complex<double> root(size, 0.0);
        if (std::abs(omega) > wire.delta0) root = Complex<double>(0.0, omega > 0 ? -size : size);
        Complex<double> over = inverse(root);
        normal = Complex<double>(omega, wire.dissipation) + over * (wire.gamma * omega);
        anomalous = over * (wire.gamma * wire.delta0);
    }
};

}  // namespace core
