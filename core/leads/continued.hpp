// The leads' self-energy as a cubic in the energy, around the thermal window.
//
// It changes on the scale of the leads' chemical potential, so that a cubic through four energies of the window
// continues it off the real axis: Σ(z), and Σ̄(z) = Σ(z*)*, with Γ = i(Σ − Σ̄).
#pragma once

#include "../values/vandermonde.hpp"
#include "self_energy.hpp"

namespace core {

constexpr int CUBIC = 4;  // nodes, and coefficients

// One self-energy, or one of its derivatives, in entries 00, 01, 11 of each channel set.
struct ContinuedLead {
    Amplitude coefficient[CUBIC][CHANNELS][3]{};

    ContinuedLead() = default;
    // at(k) is the LeadSelfEnergy at the k-th of the energies that `vandermonde` inverts.
    template <class At>
    ContinuedLead(const double (&vandermonde)[CUBIC][CUBIC], At at) {
        for (int k = 0; k < CUBIC; ++k) {
            const LeadSelfEnergy here = at(k);
            for (int p = 0; p < CUBIC; ++p)
                for (int c = 0; c < CHANNELS; ++c)
                    for (int e = 0; e < 3; ++e) coefficient[p][c][e] += vandermonde[p][k] * here.of[c](e / 2, (e + 1) / 2);
        }
    }
    // Its derivative by the energy.
    ContinuedLead slope() const {
        ContinuedLead found;
        for (int p = 1; p < CUBIC; ++p)
            for (int c = 0; c < CHANNELS; ++c)
                for (int e = 0; e < 3; ++e) found.coefficient[p - 1][c][e] = double(p) * coefficient[p][c][e];
        return found;
    }
    Amplitude sigma(Amplitude z, int c, int e) const {
        Amplitude total = 0.0;
        for (int p = CUBIC - 1; p >= 0; --p) total = total * z + coefficient[p][c][e];
        return total;
    }
    Amplitude gamma(Amplitude z, int c, int e) const {
        return Amplitude(0, 1) * (sigma(z, c, e) - std::conj(sigma(std::conj(z), c, e)));
    }
};

}  // namespace core
