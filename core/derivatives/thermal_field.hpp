// A wire in one field, its leads and its parent superconductor, with what changes them, at complex energies.
#pragma once

#include "../leads/continued.hpp"
#include "../thermal/conductance.hpp"
#include "answers.hpp"

namespace core {

// One wire and what its parameters do; the slopes are at `energies`, shape (B, CUBIC, 2).
struct ThermalGradientGrid {
    Grid grid;  // of one wire; omega holds the biases
    double kT;
    const double* energies;  // (CUBIC,)
    const LeadSelfEnergy* slopes;  // of Σ/t' in the rotated frame by the leads' V_Z and by α
    double s_slope;  // d(α/2a)/dα
    bool roughly = false;  // by V alone, and where the window ends below the gap within a few percent only
};

namespace detail {

// ω − Σ(ω) and its derivatives at a complex energy, in meV.
struct PairingChanges {
    Amplitude normal, anomalous;
    Amplitude by_gamma[2], by_energy[2];  // of both

    PairingChanges(const Wire& wire, Amplitude z) {
        Amplitude root = std::sqrt(wire.delta0 * wire.delta0 - z * z);
        if (z.imag() == 0) root.imag(-std::abs(root.imag()));  // above the gap; Re z ≥ 0
        Amplitude over = 1.0 / root, cube = over * over * over;
        normal = z + wire.gamma * z * over, anomalous = wire.gamma * wire.delta0 * over;
        by_gamma[0] = z * over, by_gamma[1] = wire.delta0 * over;
        by_energy[0] = 1.0 + wire.gamma * over + wire.gamma * z * z * cube, by_energy[1] = wire.gamma * wire.delta0 * z * cube;
    }
};

// One wire in one field with the slopes of its leads.
struct GradientField {
    const Wire& of;
    double hop, zeeman, hop_slope, angle_slope;  // t', V_Z/t', d ln t'/dα, dφ/dα
    RotatedWire wire;
    std::vector<SiteFrame> frames;
    ContinuedLead leads, slopes[LEAD_CHANGES];

    GradientField(const ThermalGradientGrid& at, int f)
        : of(*at.grid.wires), hop(of.rotated_hopping()), zeeman(of.zeeman_per_tesla * at.grid.B[f] / hop),
          hop_slope(of.spin_orbit_hopping * at.s_slope / (hop * hop)), angle_slope(of.hopping * at.s_slope / (hop * hop)),
          wire(of, at.grid.B[f]) {
        double phi = of.angle();
        for (int n = 0; n < of.sites; ++n)
            frames.push_back({std::cos(2 * phi * n), std::sin(2 * phi * n), n * std::cos(2 * phi * n), n * std::sin(2 * phi * n),
                              n % 2 == 0 ? 1.0 : -1.0});
        double vandermonde[CUBIC][CUBIC], energy[CUBIC];
        std::copy_n(at.energies, CUBIC, energy);
        invert_vandermonde(energy, vandermonde);
        const LeadSelfEnergy* own = at.slopes + size_t(f) * CUBIC * 2;
        leads = ContinuedLead(vandermonde, [&](int k) { return lead_self_energy(of, at.grid.B[f], energy[k]); });
        slopes[LEAD_ZEEMAN] = ContinuedLead(vandermonde, [&](int k) { return own[2 * k]; });
        slopes[LEAD_ALPHA] = ContinuedLead(vandermonde, [&](int k) { return own[2 * k + 1]; });
        slopes[LEAD_ENERGY] = leads.slope();
    }
};

// What some lanes are at their points.
struct PointLanes {
    using R = Lanes<REGISTER>;
    using C = Complex<R>;

    Terms<C> terms{};
    LeadsAt<R> leads{};
    C by_gamma[2], by_energy[2];  // the derivatives of normal and anomalous, in units of t'

    PointLanes(const GradientField& field, double mu, const ContourPoint* points, int count) {
        for (int l = 0; l < REGISTER; ++l) {
            const ContourPoint& at = points[std::min(l, count - 1)];
            PairingChanges pairing(field.of, at.z + Amplitude(0, field.of.dissipation));
            set_lane(terms.kinetic, l, (2 * field.of.hopping - mu) / field.hop);
            set_lane(terms.normal, l, pairing.normal / field.hop), set_lane(terms.anomalous, l, pairing.anomalous / field.hop);
            for (int k = 0; k < 2; ++k) {
                set_lane(by_gamma[k], l, pairing.by_gamma[k] / field.hop);
                set_lane(by_energy[k], l, pairing.by_energy[k] / field.hop);
            }
            leads.set(l, at, field.leads, field.slopes);
        }
    }
};

}  // namespace detail

}  // namespace core
