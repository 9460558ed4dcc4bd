// At which energies a set is solved, and what follows from them for all sets alike.
//
// What is left of a conductance beside its poles is smooth, and interpolated.  Where the window ends below the gap, the
// polynomial through its values at ±ω_k = ±W sin(π(k + ½)/2M), Chebyshev's nodes, is averaged exactly.  Where it does not,
// nodes go up to the gap (gap.hpp), and above it, where the parent superconductor broadens all levels, the conductance itself, less
// what the poles have there, is smooth in τ, ω = Δ₀ cosh τ.
#pragma once

#include <algorithm>

#include "../leads/continued.hpp"
#include "../poles/far.hpp"
#include "gap.hpp"

namespace core {

constexpr int CHECKS = 4;   // energies, the same for all sets, at which the model is compared with the solver
constexpr int SOUGHT = 2;   // further ones, each set's own: where its levels are densest (dense.hpp)
constexpr int COMPARED = CHECKS + SOUGHT;
// The lowest of them, where the nodes are at k + ½ and zero is 0: below all nodes, where levels lie that the
// nodes hardly see.  (Without it 13 of 96,000 sets were off by more than 1e-4 e²/h.)
constexpr double LOWEST = 0.2;
// Pairs of energies above the gap beside NODES_TO_HOT_GAP below it, in proportion: so many, and so many for each unit of τ.
constexpr double PAIRS_ABOVE[] = {4.5, 1.7};
constexpr double LEAST_ABOVE = 1.1;    // the energies above the gap go up to so many gaps at least
constexpr double CHECK_ABOVE = 0.5;    // where between them the smooth part is checked: half way between two
constexpr int POINTS_TO_GAP = 400;     // of the rules that average the kernel there

struct EnergyPlan {
    int nodes, biases, samples = 0;
    double window, kT, gap;            // W and Δ₀ in meV; Δ₀ is infinite where the window ends below it
    std::vector<double> omega;         // nodes, then checks, then those of nodes that only the smooth part has
    std::vector<double> above;         // energies above the gap: nodes, then a check
    std::vector<double> bias;
    int picks[CUBIC];                  // nodes through which Σ is interpolated
    double cubic[CUBIC][CUBIC];        // inverse of their Vandermonde matrix
    std::vector<std::vector<double>> weights;  // (bias, smooth value)
    std::vector<std::vector<double>> at_checks;       // of its values at the checks, (2·CHECKS, smooth value), first at ω
    std::vector<std::vector<double>> at_check_above;  // and at ± the one above the gap, if there is one
    std::vector<double> shares_at_checks;             // (CHECKS,), see `share`
    double sample = 0.0, share_of_samples = 0.0;  // the least distance of samples, and their mean share of an average
    double share_above = 0.0;          // of the kernel, at the bias at which it is most

    // delta0 matters if the nodes go up to the gap, and `resolved` if much of the kernel is there.
    EnergyPlan(const double* V, int count, double kT, int nodes, Reach reach, double delta0 = INFINITY, double resolved = LAST)
        : nodes(nodes), biases(count), kT(kT), gap(INFINITY), bias(V, V + count) {
        double needed = window = window_of(V, count, kT);
        if (reach != Reach::WINDOW) window = gap = delta0;
        bool hot = reach == Reach::HOT_GAP;
        spread = hot ? Spread{HOT_GATHERED, std::min(resolved + FURTHER_ON, LAST)} : COOL;
        for (int k = 0; k < nodes; ++k) omega.push_back(energy((k + 0.5) / nodes));
        int last = hot ? int(spread.place(resolved - BEFORE) * nodes) : nodes - 1;
        for (int k = 0; k < CHECKS; ++k) {
            int between = hot && k > 1 ? last + k - CHECKS + 1 : k * last / CHECKS;
            omega.push_back(energy((k == 0 ? LOWEST : between) / nodes));
        }
        if (reaches_gap()) {
            std::vector<double> at_nodes, at_samples;
            for (int k = 0; k < nodes; ++k) at_nodes.push_back(spread.tau((k + 0.5) / nodes));
            first_sample = resolved - BEFORE;
            double tau = first_sample, step = sample = SAMPLE * NODES_TO_HOT_GAP / nodes;
            for (double end : {tau + SAMPLED, tau + 2 * SAMPLED, LAST}) {
                for (; hot && tau < std::min(end, LAST); tau += step)
                    at_samples.push_back(tau), omega.push_back(gap * std::tanh(tau));
                step *= 2;
            }
            samples = int(at_samples.size());
            to_gap = LocalInterpolation(at_nodes, at_samples);
            counted = hot ? gap * std::tanh(resolved) : gap;
        } else {
            in_window = chebyshev_nodes(nodes);
        }
        if (reaches_gap()) {
            farthest = std::acosh(std::max(needed / gap, LEAST_ABOVE));
            over = legendre_nodes(int(PAIRS_ABOVE[0] + PAIRS_ABOVE[1] * farthest) * nodes / NODES_TO_HOT_GAP * 2);
            for (double u : over.node) above.push_back(gap * std::cosh(farthest * u));
            above.push_back(gap * std::cosh(farthest * CHECK_ABOVE));
        }
        double picked[CUBIC];
        for (int k = 0; k < CUBIC; ++k) picks[k] = int((k + 0.5) * nodes / CUBIC), picked[k] = omega[picks[k]];
        invert_vandermonde(picked, cubic);
        for (double v : bias) {
            weights.push_back(averaging_weights(v, kT));
            double share = 0.0, squares = 0.0;
            for (int k = nodes; k < nodes_below(); ++k) squares += weights.back()[k] * weights.back()[k];
            share_of_samples = std::max(share_of_samples, std::sqrt(squares));
            for (int k = 2 * nodes_below(); k < smooth_values(); ++k) share += weights.back()[k];
            share_above = std::max(share_above, share);
        }
        for (int sign : {1, -1})
            for (int k = 0; k < CHECKS; ++k) at_checks.push_back(weights_at(sign * omega[nodes + k]));
        for (int k = 0; k < CHECKS; ++k) shares_at_checks.push_back(share(omega[nodes + k]));
        for (int sign = 0; sign < 2 && reaches_gap(); ++sign) {
            at_check_above.emplace_back(padded(smooth_values()), 0.0);
            over.add(CHECK_ABOVE, 1.0, at_check_above.back().data() + 2 * nodes_below() + sign * nodes_above());
        }
    }

    int energies() const { return int(omega.size() + above.size()) + SOUGHT; }  // that a set is solved at
    bool reaches_gap() const { return std::isfinite(gap); }
    int nodes_below() const { return nodes + samples; }  // of the smooth part
    int nodes_above() const { return over.size(); }
    int smooth_values() const { return 2 * (nodes_below() + over.size()); }  // at ω_k, −ω_k, then at those above the gap
    // Where they are.
    std::vector<double> smooth_energies() const {
        std::vector<double> found;
        for (int sign : {1, -1})
            for (int k = 0; k < nodes_below(); ++k) found.push_back(sign * omega[k < nodes ? k : k + CHECKS]);
        for (int sign : {1, -1})
            for (int k = 0; k < nodes_above(); ++k) found.push_back(sign * above[k]);
        return found;
    }
    double pole_limit() const { return reaches_gap() ? counted : NEAR * window; }  // Levels below it have poles.

    // Where on [−1, 1] an energy is, in the variable in which nodes are at equal distances, and back.
    double place(double energy) const {
        return reaches_gap() ? spread.place(std::atanh(energy / gap)) : std::asin(energy / window) * (2 / std::numbers::pi);
    }
    double energy(double place) const {
        return reaches_gap() ? gap * std::tanh(spread.tau(place)) : window * std::sin(std::numbers::pi / 2 * place);
    }

    // The energy that lies so far before the samples.
    double energy_before_samples(double tau) const { return gap * std::tanh(first_sample - tau); }

    // The largest part of an average that is at an energy: of the kernel, what lies as near to it as to the next nodes.
    double share(double at) const {
        if (!reaches_gap()) return 1.0;
        const double step = 1e-4, u = place(at);
        double most = 0.0, width = (energy(u + step) - energy(u)) / (step * nodes);
        for (double v : bias) most = std::max(most, thermal_kernel(at, std::abs(v), kT).real());
        return std::min(1.0, most * width);
    }

    // The weights of the smooth part's values in its average at a bias and a temperature.
    std::vector<double> averaging_weights(double v, double at_kT) const {
        std::vector<double> weights(padded(smooth_values()), 0.0);
        if (!reaches_gap()) {
            static const KernelRule kernel;
            for (size_t k = 0; k < kernel.x.size(); ++k)
                in_window.add(std::clamp((v + at_kT * kernel.x[k]) / window, -1.0, 1.0), kernel.share[k], weights.data());
            return weights;
        }
        static const GaussLegendre rule(POINTS_TO_GAP);
        auto kernel = [&](double energy) { return thermal_kernel(energy, v, at_kT).real(); };
        for (int k = 0; k < POINTS_TO_GAP; ++k) {  // in θ, ω = Δ₀ sin θ, and in τ, ω = ±Δ₀ cosh τ
            double angle = std::numbers::pi / 2 * rule.node[k], at = gap * std::sin(angle);
            double share = std::numbers::pi / 2 * rule.weight[k] * gap * std::cos(angle) * kernel(at);
            to_gap.add(std::atanh(at / gap), share, weights.data(), nodes_below());
        }
        double whole = std::acosh(std::max((std::abs(v) + KernelRule::WIDEST * at_kT) / gap, 1.0));
        for (int k = 0; k < POINTS_TO_GAP; ++k) {
            double at = whole * (1 + rule.node[k]) / 2, share = whole / 2 * rule.weight[k] * gap * std::sinh(at);
            for (int sign : {0, 1})
                over.add(std::min(at / farthest, 1.0), share * kernel(sign == 0 ? gap * std::cosh(at) : -gap * std::cosh(at)),
                         weights.data() + 2 * nodes_below() + sign * nodes_above());
        }
        return weights;
    }

    // The weights of the smooth part's values in that at any ω below the gap.
    std::vector<double> weights_at(double at) const {
        std::vector<double> weights(padded(smooth_values()), 0.0);
        if (reaches_gap()) to_gap.add(std::atanh(at / gap), 1.0, weights.data(), nodes_below());
        else in_window.add(at / window, 1.0, weights.data());
        return weights;
    }

private:
    Interpolation in_window, over;
    LocalInterpolation to_gap;
    Spread spread;
    double first_sample = 0.0, farthest = 0.0;  // τ of the first sample and of the highest energy, Δ₀ cosh τ
    double counted = 0.0;                       // levels up to it have poles
};

}  // namespace core
