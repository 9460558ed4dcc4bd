// Self-energies of the normal leads in closed form.
//
// A lead's electron block is H(k) = ε(k) + V_Zσx + 2s sin k σy with ε = 2t − μ_lead − 2t cos k and
// s = α/2a.  At energy E its modes λ = e^{ik} follow from a quadratic equation in c = cos k,
//
//     m² = V_Z² + 4s²(1 − c²),   m = E' + 2tc,   E' = E − 2t + μ_lead,
//
// with spinor (m, V_Z + w) or, the same, (V_Z − w, m), w = 2is sin k.  Without V_Z the spin turns with
// the site and Σ is −√(t²+s²) λ for either spin, with the λ of a lead of hopping √(t²+s²).
//
// Near a band edge, or where spins are all but degenerate, differences such as 1 − c and E' + 2tc lose
// all digits.  So with x = 1 − c, y = 1 + c, E₁ = E + μ_lead, E₂ = E₁ − 4t, t'² = t² + s² and
// r² = s²(4s² − E₁E₂) + t'²V_Z²
//
//     x± = (tE₁ + 2s² ± r)/2t'²,    x₊x₋ = (E₁² − V_Z²)/4t'²,
//     y∓ = (2s² − tE₂ ∓ r)/2t'²,    y₊y₋ = (E₂² − V_Z²)/4t'²,
//     m± = (s²E' ∓ tr)/t'²,         m₊m₋ = (s²E₁E₂ − t²V_Z²)/t'²,
//
// where of two numbers that r sets apart the larger follows from the sum and the other one from the
// product, and sin²k = xy.  Of each pair λ, 1/λ the outgoing one is taken: the decaying one, or the one
// whose group velocity sin k (2t + 4s²c/m) = ∓2 sin k r/m points outwards.  With F = Σ λ |u⟩⟨ũ| the
// right lead's self-energy is (hopping)·F.  The rest is symmetry:
//
// - mirror: the left lead's self-energy is σx Σ σx;
// - particle–hole: the hole block at E is −σy Σ(−E)* σy, where Σ is the electron block.
//
// Each block is complex symmetric, as the lead's Hamiltonian is real.
#pragma once

#include <complex>
#include <vector>

#include "../wire/wire.hpp"

namespace core {

using Amplitude = std::complex<double>;

struct Spin2 {
    Amplitude entry[2][2];
    Amplitude& operator()(int i, int j) { return entry[i][j]; }
    const Amplitude& operator()(int i, int j) const { return entry[i][j]; }
};

enum Channel { LEFT_ELECTRON, LEFT_HOLE, RIGHT_ELECTRON, RIGHT_HOLE };
constexpr int CHANNELS = 4;

// Σ of the four channel sets: the electrons and the holes of each lead.
struct LeadSelfEnergy {
    Spin2 of[CHANNELS];
};

struct LeadParameters {
    double t, s, zeeman, mu;
    LeadParameters(const Wire& wire, double B)
        : t(wire.hopping), s(some(wire.lead_spin_orbit_hopping)), zeeman(some(wire.lead_zeeman_per_tesla * B)), mu(wire.lead_mu) {}

private:
    // x, or zero where its square would be.
    static double some(double x) { return std::abs(x) < 1e-100 ? 0.0 : x; }
};

namespace detail {

// middle + r and middle − r, whose product is given, r ≥ 0 or imaginary.
struct Apart {
    Amplitude plus, minus;
    Apart(double middle, Amplitude r, double product) : plus(middle + r), minus(middle - r) {
        if (r.imag() == 0 && r.real() > 0) {
            if (middle > 0) minus = product / plus.real();
            if (middle < 0) plus = product / minus.real();
        }
    }
};

struct Mode {
    Amplitude lambda, two_i_sin;
    bool propagates;
};

// Σ of a lead in which no mode propagates: it absorbs nothing, and is real.  What rounding says it does would show where a
// level of the wire is at the energy.
inline Spin2 closed(const Spin2& M) {
    double off = 0.5 * (M(0, 1) + M(1, 0)).real();
    return {{{M(0, 0).real(), off}, {off, M(1, 1).real()}}};
}

// The outgoing mode with cos k = 1 − x = y − 1; `forwards` tells whether of two propagating modes the
// one with sin k > 0 is outgoing.
inline Mode outgoing(Amplitude x, Amplitude y, bool forwards) {
    constexpr Amplitude I(0.0, 1.0);
    Amplitude c = std::abs(x) < std::abs(y) ? 1.0 - x : y - 1.0;
    if (x.imag() == 0 && x.real() >= 0 && y.real() >= 0) {
        Amplitude i_sin(0.0, std::copysign(std::sqrt(x.real() * y.real()), forwards ? 1.0 : -1.0));
        return {c + i_sin, 2.0 * i_sin, true};
    }
    Amplitude i_sin = I * std::sqrt(x * y);
    if (std::abs(c + i_sin) < std::abs(c - i_sin)) return {1.0 / (c - i_sin), 2.0 * i_sin, false};
    return {1.0 / (c + i_sin), -2.0 * i_sin, false};
}

// The right lead's electron block at energy E, in meV.
inline Spin2 electron_self_energy(double E, const LeadParameters& lead) {
    double t = lead.t, s = lead.s, t2 = t * t, s2 = s * s, hop2 = t2 + s2, zeeman = lead.zeeman;
    double low = E + lead.mu, high = low - 4 * t;  // E₁ and E₂
    if (zeeman == 0) {
        double hop = std::sqrt(hop2);
        Amplitude below = (low + 2 * (hop - t)) / (2 * hop), above = (-high + 2 * (hop - t)) / (2 * hop);
        Amplitude sigma = -hop * outgoing(below, above, true).lambda;
        return {{{sigma, 0.0}, {0.0, sigma}}};
    }
    Amplitude r = std::sqrt(Amplitude(s2 * (4 * s2 - low * high) + hop2 * zeeman * zeeman));
    Apart x(t * low + 2 * s2, r, hop2 * (low - zeeman) * (low + zeeman));
    Apart y(2 * s2 - t * high, r, hop2 * (high - zeeman) * (high + zeeman));
    Apart m(s2 * (low - 2 * t), t * r, hop2 * (s2 * low * high - t2 * zeeman * zeeman));
    Amplitude u[2], d[2], lambda[2];
    bool open = false;
    for (int k = 0; k < 2; ++k) {
        Amplitude mass = (k == 0 ? m.minus : m.plus) / hop2;
        Mode mode = outgoing((k == 0 ? x.plus : x.minus) / (2 * hop2), (k == 0 ? y.minus : y.plus) / (2 * hop2),
                             (mass.real() < 0) == (k == 0));
        open = open || mode.propagates;
        Amplitude w = s * mode.two_i_sin;
        bool up = std::abs(zeeman + w) > std::abs(zeeman - w);
        lambda[k] = mode.lambda;
        u[k] = up ? mass : zeeman - w;
        d[k] = up ? zeeman + w : mass;
    }
    Amplitude det = u[0] * d[1] - u[1] * d[0];
    Amplitude f00 = (lambda[0] * u[0] * d[1] - lambda[1] * u[1] * d[0]) / det;
    Amplitude f01 = (lambda[1] - lambda[0]) * u[0] * u[1] / det;
    Amplitude f10 = (lambda[0] - lambda[1]) * d[0] * d[1] / det;
    Amplitude f11 = (lambda[1] * u[0] * d[1] - lambda[0] * u[1] * d[0]) / det;
    // the hopping −t − is σy is the real matrix [[−t, −s], [s, −t]]
    Spin2 sigma{{{-t * f00 - s * f10, -t * f01 - s * f11}, {s * f00 - t * f10, s * f01 - t * f11}}};
    return open ? sigma : closed(sigma);
}

}  // namespace detail

// −σy M* σy: the hole block at E of the electron block M at −E.
inline Spin2 of_holes(const Spin2& M) {
    return {{{-std::conj(M(1, 1)), std::conj(M(1, 0))}, {std::conj(M(0, 1)), -std::conj(M(0, 0))}}};
}

// U†ΣU, U = exp(−iσy·angle).  In the wire's rotated frame the left lead is unchanged, the right one
// is turned by φ(N − 1).
inline Spin2 rotated(const Spin2& M, double angle) {
    double c = std::cos(angle), s = std::sin(angle);
    double U[2][2] = {{c, -s}, {s, c}};
    Spin2 out{};
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j)
            for (int k = 0; k < 2; ++k)
                for (int l = 0; l < 2; ++l) out(i, j) += U[k][i] * M(k, l) * U[l][j];
    return out;
}

// From the right lead's electron blocks at E and −E all four of both leads at E.  The mirror takes θ,
// at which a field may be tilted against the wire, to −θ, and that transposes.
inline LeadSelfEnergy of_both_leads(const Spin2& electron, const Spin2& electron_at_minus) {
    LeadSelfEnergy sigma;
    for (int charge = 0; charge < 2; ++charge) {
        Spin2 right = charge == 0 ? electron : of_holes(electron_at_minus);
        sigma.of[charge] = {{{right(1, 1), right(0, 1)}, {right(1, 0), right(0, 0)}}};
        sigma.of[2 + charge] = right;
    }
    return sigma;
}

// Both leads' Σ at one energy in their own frame, in meV.
inline LeadSelfEnergy self_energy_of_leads(const Wire& wire, double B, double omega) {
    LeadParameters lead(wire, B);
    return of_both_leads(detail::electron_self_energy(omega, lead), detail::electron_self_energy(-omega, lead));
}

// The same in the wire's rotated frame, in units of t'.
inline LeadSelfEnergy in_frame_of(const Wire& wire, LeadSelfEnergy sigma) {
    double hop = wire.rotated_hopping(), turn = wire.angle() * (wire.sites - 1);
    for (int c = 0; c < CHANNELS; ++c) {
        if (c == RIGHT_ELECTRON || c == RIGHT_HOLE) sigma.of[c] = rotated(sigma.of[c], turn);
        for (int k = 0; k < 4; ++k) sigma.of[c](k / 2, k % 2) /= hop;
    }
    return sigma;
}

inline LeadSelfEnergy lead_self_energy(const Wire& wire, double B, double omega) {
    return in_frame_of(wire, self_energy_of_leads(wire, B, omega));
}

}  // namespace core
