// The arithmetics of conductance.hpp in a tilted field.
//
// M is Hermitian below the gap: pivots are real, and one coupling of the ends is the other one's
// adjoint, rounding included, so that no particle is lost to it.  Elsewhere M has no symmetry.
#pragma once

#include "../conductance.hpp"
#include "../leads/tilted.hpp"

namespace core {

// Above the gap or with broadening.
struct TiltedArithmetic : ComplexArithmetic {
    using Block = Block4<N>;
    using Leads = TiltedLaneLeads<R>;
    static LeadSelfEnergy leads(const Wire& w, double B, double omega, double theta) {
        return tilted_self_energy_of_leads(w, B, omega, theta);
    }
};

// At the other energies.
struct HermitianArithmetic : TiltedArithmetic {
    using Block = Hermitian4<N>;
    static bool takes(const Wire& w, double omega) { return RealArithmetic::takes(w, omega); }
    template <class Ends, class Leads>
    static Conductances<R> conductances(const Ends& G, const Leads& leads) { return lossless_conductances_of_ends<R>(G, leads); }
};

}  // namespace core
