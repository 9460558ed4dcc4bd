// How far off an average may be: comparisons with the solver at further energies.
#pragma once

#include "model.hpp"

namespace core {

constexpr double ROUGHNESS = 10.0;  // estimated error over the smooth part's largest mismatch at the checks
constexpr double ROUGHNESS_ABOVE = 3.0;  // the same above the gap, times the share that a node has of the average
constexpr double PART_OF_SHARE = 0.5;  // estimated error of the samples over that of one of them (`error_of_samples`)
constexpr double LAST_POLES = 1.0;  // poles in so many units of τ before the samples tell how narrow those between them are
constexpr double SAFETY = 300.0;    // estimated error over the model's largest mismatch, times t', at the checks

namespace detail {

inline double largest(double a, double b) { return b <= a || std::isnan(a) ? a : b; }  // NaN of either stays

// What a model and the solver are compared by.
struct Comparison {
    double checks[COMPARED], of_kernel[COMPARED];  // energies, and EnergyPlan::share of each
    double shares[COMPARED];                       // how much of a difference there counts
    double rest[4][2][COMPARED], above[4][2];   // what the poles leave of the conductances, at ω and −ω; also above the gap

    Comparison(const EnergyPlan& plan, const double (&sought)[SOUGHT]) {
        for (int k = 0; k < COMPARED; ++k) {
            checks[k] = k < CHECKS ? plan.omega[plan.nodes + k] : sought[k - CHECKS];
            of_kernel[k] = k < CHECKS ? plan.shares_at_checks[k] : plan.share(checks[k]);
        }
    }
};

// What poles leave of conductances.
struct Remainder {
    const PoleTerms& poles;

    // Call set(conductance, k, sign, value) of the k-th of some energies, and of minus that.
    template <class Set>
    void operator()(int count, const double* omega, const Conductances<double>* bare, Set set) const {
        for (int first = 0; first < 2 * count; first += COLUMNS) {
            Columns energies = 0.0, of_poles[4];
            int some = std::min(COLUMNS, 2 * count - first);
            for (int l = 0; l < some; ++l) {
                int k = first + l;
                energies.set(l, k < count ? omega[k] : -omega[k - count]);
            }
            sum_poles(poles, energies, of_poles);
            for (int l = 0; l < some; ++l) {
                int sign = first + l < count ? 0 : 1, k = first + l - sign * count;
                for (int c = 0; c < 4; ++c) set(c, k, sign, bare[k].at[sign][c] - of_poles[c][l]);
            }
        }
    }
};

// What part of a difference at a check the average can have: a pole misplaced by δ shows as v²δ/(ω − z)² and
// counts as v²δ/(kT)² in the average, so a difference is scaled down where a pole is nearer than kT.
inline double share_that_counts(double omega, double kT, const PoleTerms& terms) {
    double nearest = kT * kT;
    for (int n = 0; n < terms.count; ++n) {
        double along = omega - terms.x[n];
        nearest = std::min(nearest, along * along + terms.y[n] * terms.y[n]);
    }
    return nearest / (kT * kT);
}

// The largest difference of the model's G and the solver's at the checks, in 1/meV.
inline double mismatch(const Comparison& at, const Leads& leads, double width, const SetData& data, Batch& b) {
    double worst = 0.0;
    for (int first = 0; first < COMPARED; first += POLES) {
        b.z = PoleComplex(PoleReal(0.0), PoleReal(width));
        for (int l = 0; l < POLES; ++l) b.z.re.set(l, at.checks[std::min(first + l, COMPARED - 1)]);
        const auto G = dressed_green(leads.inverse, b);
        for (int i = 0; i < 8; ++i)
            for (int j = i; j < 8; ++j) {
                for (int l = 0; l < POLES && first + l < COMPARED; ++l) {
                    Complex<double> exact = data.green[first + l](i, j);
                    double re = G(i, j).re[l] - exact.re, im = G(i, j).im[l] - exact.im, share = at.shares[first + l];
                    worst = largest(worst, (re * re + im * im) * (share * share));
                }
            }
    }
    return std::sqrt(worst);
}

// The error that the samples next to the gap make.  Between them lie Lorentzians, of which they sum all but a part
// exp(−2π width/distance) rightly, by as much as a share of the average as samples have.  Their heights and widths are taken from
// the last poles before, or, if there are none, from the samples themselves.
inline double error_of_samples(const EnergyPlan& plan, const RationalConductances& of) {
    if (plan.samples == 0) return 0.0;
    double worst = 0.0;
    bool none = true;
    for (int n = 0; n < of.poles.count; ++n) {
        double x = of.poles.x[n], width = -of.poles.y[n] * plan.gap / ((plan.gap - x) * (plan.gap + x)), highest = 0.0;
        if (!(plan.energy_before_samples(LAST_POLES) < x && x < plan.gap)) continue;
        none = false;
        for (int hole = 0; hole < 2; ++hole)
            for (int c = 0; c < 4; ++c)
                highest = std::max(highest, std::hypot(of.poles.re[hole][c][n], of.poles.im[hole][c][n]));
        worst = largest(worst, -2 * highest / of.poles.y[n] * std::exp(-2 * std::numbers::pi * width / plan.sample));
    }
    if (none)
        for (const auto& rest : of.rest)
            for (int k = 0; k < 2 * plan.nodes_below(); ++k)
                if (k % plan.nodes_below() >= plan.nodes) worst = largest(worst, std::abs(rest[k]));
    return PART_OF_SHARE * worst * plan.share_of_samples;
}

// The error that what is left beside the poles makes, by how rough it is at the checks.
//
// Where levels are dense, the whole pattern of poles may be another, each with its v²/(ω − z) that counts as v²/kT: of the
// conductance there the square root of a share is taken.  A pole that was lost, or counted twice, leaves its peak in what
// should be smooth.
inline double error_of_rest(const EnergyPlan& plan, const RationalConductances& of, const Comparison& at) {
    auto off = [&](const std::vector<double>& weights, int c, double value) {
        return std::abs(dot(weights.data(), of.rest[c].data(), padded(plan.smooth_values())) - value);
    };
    double rough = 0.0, above = 0.0;
    for (int sign = 0; sign < 2; ++sign) {
        for (int k = 0; k < COMPARED; ++k) {
            const std::vector<double> own = k < CHECKS ? std::vector<double>() : plan.weights_at(sign == 0 ? at.checks[k] : -at.checks[k]);
            const std::vector<double>& weights = k < CHECKS ? plan.at_checks[sign * CHECKS + k] : own;
            double share = plan.reaches_gap() ? at.of_kernel[k] : k < CHECKS ? at.shares[k] : std::sqrt(at.shares[k]);
            for (int c = 0; c < 4; ++c) rough = largest(rough, off(weights, c, at.rest[c][sign][k]) * share);
        }
        if (!plan.reaches_gap()) continue;
        for (int c = 0; c < 4; ++c) above = largest(above, off(plan.at_check_above[sign], c, at.above[c][sign]) * plan.share_above / plan.nodes_above());
    }
    return largest(largest(ROUGHNESS * rough, ROUGHNESS_ABOVE * above), error_of_samples(plan, of));
}

}  // namespace detail

}  // namespace core
