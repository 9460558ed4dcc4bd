// A wire, and the frame in which it is solved.
//
// Units are meV, nm and T.  In the rotated frame (see elimination.hpp) everything is measured in
// t' = √(t² + (α/2a)²), and the spin of site n is turned by φn, tan φ = α/2at.
#pragma once

#include <cmath>
#include <vector>

namespace core {

// The numbers of one wire, as Python's Nanowire has them.
struct Wire {
    int sites;
    const double* V;  // (site,) with barriers, in meV
    double hopping;   // t
    double spin_orbit_hopping;  // α/2a
    double zeeman_per_tesla;    // ½gμ_B
    double gamma, delta0;
    double lead_mu, lead_spin_orbit_hopping, lead_zeeman_per_tesla;
    double dissipation, parent_dissipation;  // of the wire's own levels, and of the parent superconductor's

    double rotated_hopping() const { return std::hypot(hopping, spin_orbit_hopping); }
    double angle() const { return std::atan2(spin_orbit_hopping, hopping); }  // φ
};

constexpr int PARAMETERS = 10;  // numbers that follow a wire's V, in this order

// Wires of equal length: V, shape (wire, site), is not copied; parameters, shape (wire, PARAMETERS).
inline std::vector<Wire> wires_of(int count, int sites, const double* V, const double* parameters) {
    std::vector<Wire> wires;
    for (int w = 0; w < count; ++w, V += sites, parameters += PARAMETERS) {
        const double* p = parameters;
        wires.push_back({sites, V, p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9]});
    }
    return wires;
}

// One wire in one field, in units of t'.
struct RotatedWire {
    std::vector<double> V, zeeman_x, zeeman_z;
    double zeeman_y = 0;  // along the axis of the rotation, the same at every site

    // θ: angle of the field, from the wire (x) to the spin–orbit field (y).
    RotatedWire(const Wire& wire, double B, double theta = 0) {
        double hop = wire.rotated_hopping(), phi = wire.angle();
        double zeeman = wire.zeeman_per_tesla * B / hop;
        double along = zeeman * std::cos(theta);
        zeeman_y = theta == 0 ? 0.0 : zeeman * std::sin(theta);
        for (int n = 0; n < wire.sites; ++n) {
            V.push_back(wire.V[n] / hop);
            zeeman_x.push_back(along * std::cos(2 * phi * n));
            zeeman_z.push_back(along * std::sin(2 * phi * n));
        }
    }
    int sites() const { return int(V.size()); }
};

}  // namespace core
