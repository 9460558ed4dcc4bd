// What α does to a wire's frame: it stretches t' = √(t² + s²), s = α/2a, and turns the spin of site n
// by φn, tan φ = s/t, so that d ln t'/dα = s s'/t'² and dφ/dα = t s'/t'², s' = ds/dα.
#pragma once

#include "../conductance.hpp"
#include "contraction.hpp"

namespace core {

// The points at which one wire's derivatives are wanted.
struct GradientGrid {
    const Wire& wire;
    const double *mu, *B, *omega;  // 0 ≤ ω < Δ₀
    int mu_count, B_count, omega_count, bias_count;
    const std::int64_t* biases;    // (omega, 2), which bias +ω and −ω are, −1 if none
    const LeadSelfEnergy* slopes;  // (B, omega, 2), of Σ/t' in the rotated frame by B and α
    double s_slope;                // s'

    bool both_signs() const {
        for (int e = 0; e < omega_count; ++e)
            if (biases[2 * e] >= 0 && biases[2 * e + 1] >= 0) return true;
        return false;
    }
    Grid energies() const { return {&wire, 1, mu, this->B, omega, mu_count, B_count, omega_count}; }
};

// One wire and field with its frame's slopes.
struct TurningField : FieldOf<RealArithmetic> {
    double zeeman, zeeman_per_tesla;     // in units of t'
    double angle, hop_slope;             // φ and d ln t'/dα
    std::vector<SiteTurn> turns;

    TurningField(const GradientGrid& grid, double B) : FieldOf(grid.wire, B, grid.energies()) {
        const Wire& w = grid.wire;
        zeeman_per_tesla = w.zeeman_per_tesla / hop, zeeman = zeeman_per_tesla * B, angle = w.angle();
        hop_slope = w.spin_orbit_hopping * grid.s_slope / (hop * hop);
        double angle_slope = w.hopping * grid.s_slope / (hop * hop);
        for (int n = 0; n < w.sites; ++n) {
            double turn = std::remainder(PI / 4 - angle * n, PI), t = 2 * zeeman * angle_slope * n;
            turns.push_back({std::tan(turn / 2), std::sin(turn), t, hop_slope * wire.V[n] - t});
        }
    }

private:
    static constexpr double PI = 3.14159265358979323846;
};

}  // namespace core
