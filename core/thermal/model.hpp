// What the average of one set is made of.
#pragma once

#include "dense.hpp"
#include "field.hpp"
#include "trigamma.hpp"

namespace core {

// What all conductances at real energies are made of: poles, and what is left of their values where a plan
// has weights.
struct RationalConductances {
    PoleTerms poles{0};
    std::vector<double> rest[4];

    // Write the averages at one temperature, shape (bias, 4); weights are those of the plan, (bias, smooth value).
    void average(const std::vector<std::vector<double>>& weights, const std::vector<double>& bias, double kT, double* out) const {
        for (size_t v = 0; v < bias.size(); ++v)
            for (int c = 0; c < 4; ++c) out[4 * v + c] = dot(weights[v].data(), rest[c].data(), int(rest[c].size()));
        average_poles(poles, bias, kT, out);
    }
};

// The solver's data of one set.
struct SetData {
    std::vector<NodeData> isolated;           // (node,)
    Symmetric8<Complex<double>> green[COMPARED];  // leads attached, at the checks, chiral basis, 1/meV
    std::vector<Conductances<double>> bare;   // at the nodes, checks and samples, then above the gap
    double sought[SOUGHT];                    // the set's own checks in meV
    double growth;
};

// G of the ends at the energies of a batch, leads attached, chiral basis, in 1/meV; of the conjugate leads G(z*)*.
inline Symmetric8<PoleComplex> dressed_green(const Cubic& inverse, Batch& b) {
    b.factor_at_energies(inverse);
    Ends8 f[8], same_end[8];
    for (int j = 0; j < 8; ++j) {
        Ends8 unit;
        unit.fill(PoleComplex(0.0));
        unit[j] = PoleComplex(1.0);
        b.S.multiply(unit, f[j]);
        same_end[j] = f[j];
        b.M.solve_lower(f[j]);
    }
    Symmetric8<PoleComplex> G;
    for (int i = 0; i < 8; ++i)
        for (int j = i; j < 8; ++j) G(i, j) = b.M.add_product(f[i], f[j], -same_end[j][i]);
    return G;
}

}  // namespace core
