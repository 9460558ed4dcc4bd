// Conductances and det r at T = 0, in the arithmetic that each wire and energy allow.
#pragma once

#include "tilted/arithmetic.hpp"

namespace core {

// Fill out, shape (wire, mu, B, omega, 2, 4), with the conductances at ±ω, ω ≠ Δ₀.
inline void bare_conductance(const Grid& grid, double growth_limit, double* out, Stop& stop) {
    if (grid.theta == 0) {
        bare_conductance<RealArithmetic>(grid, growth_limit, out, stop);
        bare_conductance<ComplexArithmetic>(grid, growth_limit, out, stop);
    } else {
        bare_conductance<HermitianArithmetic>(grid, growth_limit, out, stop);
        bare_conductance<TiltedArithmetic>(grid, growth_limit, out, stop);
    }
}

// Fill out, shape (wire, lead, mu, B), with det r at the grid's one energy, ω = 0, of wires without dissipation.
inline void reflection_determinants(const Grid& grid, double growth_limit, double* out, Stop& stop) {
    if (grid.theta == 0)
        reflection_determinants<RealArithmetic>(grid, growth_limit, out, stop);
    else
        reflection_determinants<HermitianArithmetic>(grid, growth_limit, out, stop);
}

}  // namespace core
