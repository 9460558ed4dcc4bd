// One wire in one field at the energies of a plan.
#pragma once

#include "../conductance.hpp"
#include "../poles/dressing.hpp"
#include "plan.hpp"

namespace core {

namespace detail {

// The leads around the window, from Σ/t' at four energies of which `cubic` inverts the Vandermonde matrix.
template <class At>
inline Leads leads_through(const double (&cubic)[CUBIC][CUBIC], double hop, At sigma_at) {
    EndMatrix at[CUBIC];
    for (int k = 0; k < CUBIC; ++k) {
        EndMatrix sigma = on_the_ends(sigma_at(k));
        Symmetric8<Complex<double>> M;
        for (int i = 0; i < 8; ++i)
            for (int j = i; j < 8; ++j) M(i, j) = {sigma(i, j).real() * hop, sigma(i, j).imag() * hop};
        to_chiral(M);
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8; ++j) at[k](i, j) = {M(i, j).re, M(i, j).im};
    }
    return Leads(cubic, at);
}

// One wire and field at the plan's energies.
struct ThermalField {
    const Wire& of;
    double B, hop;
    RotatedWire wire;
    std::vector<Pairing> pairing;
    std::vector<LeadSelfEnergy> leads;

    ThermalField(const Wire& of, double B, const std::vector<double>& omega)
        : of(of), B(B), hop(of.rotated_hopping()), wire(of, B) {
        for (double w : omega) pairing.push_back(Pairing(of, w)), leads.push_back(lead_self_energy(of, B, w));
    }
    double kinetic(double mu) const { return (2 * of.hopping - mu) / hop; }

    Leads around_the_window(const EnergyPlan& plan) const {
        return leads_through(plan.cubic, hop, [&](int k) { return leads[plan.picks[k]]; });
    }
};

}  // namespace detail

}  // namespace core
