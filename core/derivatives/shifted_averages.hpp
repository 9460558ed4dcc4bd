// The derivatives of closed-form averages by the bias and by kT, which enter through the kernel alone.
//
// A shift of all energies of a wire and its leads shifts p(ω), which has the derivative by the bias for its average.  At Δ₀ such a
// derivative grows beyond all bounds, so where the window reaches it the shift has a weight s(ω) that is zero there:
//
//     ∫ s p' K_V dω = ∂/∂V ∫ s p K_V dω − ∫ s' p K_V dω,    s = 1 − (ω/Δ₀)²,
//
// and the model of p, of poles and a rest, is one of s p and of s' p, too.  So it is where only the levels below the gap are shifted,
// by s = ω − ω³/Δ₀².
#pragma once

#include "../thermal/average.hpp"

namespace core {

// The derivatives that are not those by V: by μ, by V_Z of the wire alone, by α of wire and leads, by γ, Δ₀, by V_Z of
// the leads alone, by the broadening of the levels where there is any, by the bias as by all energies of wire and leads, and,
// through the kernel, by the bias and by kT.
enum Change { BY_MU, BY_ZEEMAN, BY_ALPHA, BY_GAMMA, BY_DELTA0, BY_LEAD_ZEEMAN, BY_DISSIPATION, BY_ENERGY, BY_BIAS, BY_KT };
constexpr int CHANGES = 10, THROUGH_KERNEL = 2;
constexpr double SHIFT = 2e-3;  // in kT: of bias and kT to either side, for the difference of closed forms

// s and s' of a shift of all energies; 1 and 0 where the window ends below the gap.
struct ShiftOfAll {
    static constexpr bool ODD = false;
    double over_square;  // 1/Δ₀² or 0
    Amplitude at(Amplitude omega) const { return 1.0 - omega * omega * over_square; }
    Amplitude slope(Amplitude omega) const { return -2.0 * omega * over_square; }
};

// The same of a shift of the levels below the gap.
struct ShiftOfLevels {
    static constexpr bool ODD = true;
    double over_square;
    Amplitude at(Amplitude omega) const { return beyond(omega) ? 0.0 : omega * (1.0 - omega * omega * over_square); }
    Amplitude slope(Amplitude omega) const { return beyond(omega) ? 0.0 : 1.0 - 3.0 * omega * omega * over_square; }

private:
    bool beyond(Amplitude omega) const { return omega.imag() == 0 && omega.real() * omega.real() * over_square > 1; }
};

namespace detail {

// A model times a function s(ω) that is real on the real axis, and even, or odd.
template <class Weight>
inline RationalConductances times(const EnergyPlan& plan, const RationalConductances& of, bool odd, Weight s) {
    RationalConductances to{PoleTerms(of.poles.count), {}};
    std::copy(of.poles.values.begin(), of.poles.values.end(), to.poles.values.begin());
    for (int n = 0; n < of.poles.count; ++n) {
        const Amplitude at = s(Amplitude(of.poles.x[n], of.poles.y[n]));
        for (int hole = 0; hole < 2; ++hole)
            for (int k = 0; k < 4; ++k) {
                Amplitude r = at * Amplitude(of.poles.re[hole][k][n], of.poles.im[hole][k][n]);
                if (odd && hole) r = -r;
                to.poles.re[hole][k][n] = r.real(), to.poles.im[hole][k][n] = r.imag();
            }
    }
    for (int k = 0; k < 4; ++k) to.rest[k].assign(of.rest[k].size(), 0.0);
    const std::vector<double> omega = plan.smooth_energies();
    for (size_t first = 0; first < omega.size(); first += COLUMNS) {
        Columns energies = 0.0, before[4], after[4];
        for (size_t l = 0; l < COLUMNS && first + l < omega.size(); ++l) energies.set(int(l), omega[first + l]);
        sum_poles(of.poles, energies, before), sum_poles(to.poles, energies, after);
        for (size_t l = 0; l < COLUMNS && first + l < omega.size(); ++l)
            for (int k = 0; k < 4; ++k) {
                double whole = of.rest[k][first + l] + before[k][int(l)];
                to.rest[k][first + l] = s(Amplitude(omega[first + l])).real() * whole - after[k][int(l)];
            }
    }
    return to;
}

}  // namespace detail

// What the closed form of sets of one plan takes for the derivatives by the bias and by kT, and for a shift.
struct ShiftedAverages {
    EnergyPlan plan;
    ShiftOfAll all;
    ShiftOfLevels levels;
    struct Shifted {
        std::vector<double> bias;
        double kT;
        std::vector<std::vector<double>> weights;
    };
    Shifted to[THROUGH_KERNEL][2];

    ShiftedAverages(const EnergyPlan& of) : plan(of), all{of.reaches_gap() ? 1 / (of.gap * of.gap) : 0.0}, levels{all.over_square} {
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
    // Return the derivatives of one set by the bias or by kT, shape (bias, conductance).
    std::vector<double> derivatives(const RationalConductances& of, Change change) const {
        const auto& sides = to[change - BY_BIAS];
        std::vector<double> below(4 * size_t(plan.biases)), above = below;
        of.average(sides[0].weights, sides[0].bias, sides[0].kT, below.data());
        of.average(sides[1].weights, sides[1].bias, sides[1].kT, above.data());
        for (size_t v = 0; v < above.size(); ++v) above[v] = (above[v] - below[v]) / (2 * SHIFT * plan.kT);
        return above;
    }
    // Return what a shift does.
    template <class Shift>
    std::vector<double> of_shift(const RationalConductances& of, const Shift& s) const {
        auto slope = detail::times(plan, of, !Shift::ODD, [&](Amplitude omega) { return s.slope(omega); });
        auto found = derivatives(detail::times(plan, of, Shift::ODD, [&](Amplitude omega) { return s.at(omega); }), BY_BIAS);
        std::vector<double> by_slope(found.size());
        slope.average(plan.weights, plan.bias, plan.kT, by_slope.data());
        for (size_t v = 0; v < found.size(); ++v) found[v] -= by_slope[v];
        return found;
    }
};

}  // namespace core
