// The derivatives of closed-form averages by the bias and by kT, which enter through the kernel alone.
#pragma once

#include "../thermal/average.hpp"

namespace core {

// The derivatives that are not those by V: by μ, by V_Z of the wire alone, by α of wire and leads, by γ, Δ₀, by V_Z of
// the leads alone, by the broadening of the levels where there is any, by the bias as by all energies of wire and leads, and,
// through the kernel, by the bias and by kT.
enum Change { BY_MU, BY_ZEEMAN, BY_ALPHA, BY_GAMMA, BY_DELTA0, BY_LEAD_ZEEMAN, BY_DISSIPATION, BY_ENERGY, BY_BIAS, BY_KT };
constexpr int CHANGES = 10, THROUGH_KERNEL = 2;
constexpr double SHIFT = 2e-3;  // in kT: of bias and kT to either side, for the difference of closed forms

// What the closed form of sets of so many nodes takes for the derivatives by the bias and by kT.
struct ShiftedAverages {
    struct Shifted {
        std::vector<double> bias;
        double kT;
        std::vector<std::vector<double>> weights;
    };
    Shifted to[THROUGH_KERNEL][2];

    ShiftedAverages(const EnergyPlan& plan) {
        for (int by = 0; by < THROUGH_KERNEL; ++by)
            for (int side = 0; side < 2; ++side) {
                double shift = plan.kT * (side == 0 ? -SHIFT : SHIFT);
                Shifted& now = to[by][side] = {plan.bias, by == 0 ? plan.kT : plan.kT + shift, {}};
                for (double& v : now.bias) {
                    if (by == 0) v += shift;
                    now.weights.push_back(plan.averaging_weights(v, now.kT));
                }
            }
    }
    // Write the derivatives of one set, of each of the plan's biases and the conductances, to others.
    void write(const RationalConductances& of, double kT, double* others) const {
        size_t values = to[0][0].bias.size() * 4;
        std::vector<double> below(values), above(values);
        for (int by = 0; by < THROUGH_KERNEL; ++by) {
            of.average(to[by][0].weights, to[by][0].bias, to[by][0].kT, below.data());
            of.average(to[by][1].weights, to[by][1].bias, to[by][1].kT, above.data());
            for (size_t v = 0; v < values; ++v) others[v * CHANGES + BY_BIAS + by] = (above[v] - below[v]) / (2 * SHIFT * kT);
        }
    }
};

}  // namespace core
