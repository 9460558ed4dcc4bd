// One set's thermal average from its levels: poles, residues, closed form, and how sure it is.
//
// What is left of the conductance beside its poles is smooth; the polynomial through its values at the nodes
// is averaged exactly.  Two comparisons with the solver at further energies give the error.
#pragma once

#include "dense.hpp"
#include "field.hpp"
#include "trigamma.hpp"

namespace core {

constexpr double ROUGHNESS = 10.0;  // estimated error over the smooth part's largest mismatch at the checks
constexpr double ROUGHNESS_ABOVE = 3.0;  // the same above the gap, times the share that a node has of the average
constexpr double LIKE_THESE = 1.0;  // Poles of so many units of τ before the samples tell how narrow those between them are.
constexpr double SAFETY = 300.0;    // estimated error over the model's largest mismatch, times t', at the checks

// What all conductances at real energies are made of: poles, and what is left of their values at the nodes, at ω, then
// at −ω.
struct RationalConductances {
    PoleTerms poles{0};
    std::vector<double> rest[4];

    // Write the averages at one temperature, shape (bias, 4); weights are those of the plan, (bias, 2·node).
    void average(const std::vector<std::vector<double>>& weights, const std::vector<double>& bias, double kT, double* out) const {
        for (size_t v = 0; v < bias.size(); ++v)
            for (int c = 0; c < 4; ++c) out[4 * v + c] = dot(weights[v].data(), rest[c].data(), int(rest[c].size()));
        average_poles(poles, bias, kT, out);
    }
};

// What is known of a set once it is averaged, if it is asked for.
struct SetModel {
    int nodes = 0;  // 0: none
    LevelList levels;
    Resonances poles{{}, {0, 0}, {}};  // without their vectors
    RationalConductances conductances;
};

// The solver's data of one set.
struct SetData {
    std::vector<NodeData> isolated;           // (node,)
    Symmetric8<Complex<double>> green[COMPARED];  // leads attached, at the checks, chiral basis, 1/meV
    std::vector<Conductances<double>> bare;   // (node + COMPARED,), then above the gap
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

namespace detail {

inline double largest(double a, double b) { return b <= a || std::isnan(a) ? a : b; }  // NaN of either stays

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
inline double mismatch(const double (&checks)[COMPARED], const double (&shares)[COMPARED], const Leads& leads,
                       double width, const SetData& data, Batch& b) {
    double worst = 0.0;
    for (int first = 0; first < COMPARED; first += POLES) {
        b.z = PoleComplex(PoleReal(0.0), PoleReal(width));
        for (int l = 0; l < POLES; ++l) b.z.re.set(l, checks[std::min(first + l, COMPARED - 1)]);
        const auto G = dressed_green(leads.inverse, b);
        for (int i = 0; i < 8; ++i)
            for (int j = i; j < 8; ++j) {
                for (int l = 0; l < POLES && first + l < COMPARED; ++l) {
                    Complex<double> exact = data.green[first + l](i, j);
                    double re = G(i, j).re[l] - exact.re, im = G(i, j).im[l] - exact.im, share = shares[first + l];
                    worst = largest(worst, (re * re + im * im) * (share * share));
                }
            }
    }
    return std::sqrt(worst);
}

// The conductances that a model has at the nodes, where levels are broadened.
inline std::vector<Conductances<double>> conductances_at_nodes(const EnergyPlan& plan, const ThermalField& field, const Leads& leads, Batch& b) {
    std::vector<Conductances<double>> found(plan.nodes);
    for (int first = 0; first < plan.nodes; first += POLES) {
        LaneLeads<PoleReal> lanes{};
        b.z = PoleComplex(PoleReal(0.0), PoleReal(field.of.dissipation));
        for (int l = 0; l < POLES; ++l) {
            int k = std::min(first + l, plan.nodes - 1);
            b.z.re.set(l, plan.omega[k]), lanes.set(l, field.leads[k]);
        }
        auto G = dressed_green(leads.inverse, b);
        to_sites(G);
        for (auto& entry : G.entry) entry = entry * PoleReal(field.hop);
        const auto bare = lossy_conductances_of_ends<PoleReal>(G, lanes);
        for (int l = 0; l < POLES && first + l < plan.nodes; ++l) found[first + l] = lane_of(bare, l);
    }
    return found;
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
        if (!(x > plan.energy_before_samples(LIKE_THESE))) continue;
        none = false;
        for (int hole = 0; hole < 2; ++hole)
            for (int c = 0; c < 4; ++c)
                highest = std::max(highest, std::hypot(of.poles.re[hole][c][n], of.poles.im[hole][c][n]));
        worst = std::max(worst, -2 * highest / of.poles.y[n] * std::exp(-2 * std::numbers::pi * width / plan.sample));
    }
    if (none)
        for (const auto& rest : of.rest)
            for (int k = 0; k < 2 * plan.nodes_below(); ++k)
                if (k % plan.nodes_below() >= plan.nodes) worst = std::max(worst, std::abs(rest[k]));
    return worst * plan.share_of_samples;
}

}  // namespace detail

// Write the thermal conductances of one set, shape (bias, 4), and its model, if asked for; return the error estimate in
// e²/h.
inline double rational_average(const EnergyPlan& plan, const detail::ThermalField& field, const LevelList& list, const SetData& data,
                               const Leads& leads, double* out, SetModel* model = nullptr) {
    int m = plan.nodes, pick = plan.picks[1];
    const double hop = field.hop, width = field.of.dissipation;
    Levels levels(list, plan.window);
    Batch batch(levels);
    Starts starts = start_poles(plan.omega[pick], data.isolated[pick].G, plan.pole_limit(), hop, levels, leads);
    Resonances found = find_poles(starts, levels, leads, batch);
    if (!found.whole) return INFINITY;
    RationalConductances of{conductance_terms(found, leads, width, batch), {}};
    const PoleTerms& terms = of.poles;

    double checks[COMPARED];
    for (int k = 0; k < COMPARED; ++k) checks[k] = k < CHECKS ? plan.omega[m + k] : data.sought[k - CHECKS];
    // What the poles leave of each conductance at the nodes, and at the checks: at ω, then at −ω.
    int above = plan.nodes_above();
    for (auto& values : of.rest) values.resize(padded(plan.smooth_values()), 0.0);
    double at_checks[4][2 * COMPARED], at_check_above[4][2];
    auto rest = [&](int count, const double* omega, const Conductances<double>* bare, auto set) {
        for (int first = 0; first < 2 * count; first += COLUMNS) {
            Columns energies = 0.0, of_poles[4];
            int some = std::min(COLUMNS, 2 * count - first);
            for (int l = 0; l < some; ++l) {
                int k = first + l;
                energies.set(l, k < count ? omega[k] : -omega[k - count]);
            }
            sum_poles(terms, energies, of_poles);
            for (int l = 0; l < some; ++l) {
                int k = first + l, sign = k < count ? 0 : 1;
                for (int c = 0; c < 4; ++c) set(c, k - sign * count, sign, bare[k - sign * count].at[sign][c] - of_poles[c][l]);
            }
        }
    };
    int below = plan.nodes_below();
    std::vector<Conductances<double>> broadened;
    if (width > 0) broadened = detail::conductances_at_nodes(plan, field, leads, batch);
    rest(m, plan.omega.data(), width > 0 ? broadened.data() : &data.bare[0], [&](int c, int k, int sign, double value) { of.rest[c][k + sign * below] = value; });
    rest(below - m, &plan.omega[m + CHECKS], &data.bare[m + COMPARED],
         [&](int c, int k, int sign, double value) { of.rest[c][m + k + sign * below] = value; });
    rest(COMPARED, checks, &data.bare[m], [&](int c, int k, int sign, double value) { at_checks[c][k + sign * COMPARED] = value; });
    rest(int(plan.above.size()), plan.above.data(), &data.bare[below + COMPARED], [&](int c, int k, int sign, double value) {
        (k < above ? of.rest[c][2 * below + k + sign * above] : at_check_above[c][sign]) = value;
    });
    auto polynomial = [&](const std::vector<double>& weights, int c) {
        return dot(weights.data(), of.rest[c].data(), padded(plan.smooth_values()));
    };
    of.average(plan.weights, plan.bias, plan.kT, out);

    double shares[COMPARED], rough = 0.0, over_gap = 0.0;
    for (int k = 0; k < COMPARED; ++k) shares[k] = detail::share_that_counts(checks[k], plan.kT, terms) * plan.share(checks[k]);
    double of_model = SAFETY * hop * detail::mismatch(checks, shares, leads, width, data, batch);
    // Where levels are dense, the whole pattern of poles may be another, each with its v²/(ω − z) that counts as
    // v²/kT: of the conductance there the square root is taken.  A pole that was lost, or counted twice, leaves its
    // peak in what should be smooth.
    for (int k = 0; k < COMPARED; ++k)
        for (int sign = 0; sign < 2; ++sign) {
            std::vector<double> weights = plan.weights_at(sign == 0 ? checks[k] : -checks[k]);
            double share = plan.reaches_gap() ? plan.share(checks[k]) : k < CHECKS ? shares[k] : std::sqrt(shares[k]);
            for (int c = 0; c < 4; ++c)
                rough = detail::largest(rough, std::abs(polynomial(weights, c) - at_checks[c][sign * COMPARED + k]) * share);
        }
    for (int sign = 0; sign < 2 && above > 0; ++sign) {
        std::vector<double> weights = plan.weights_at_check_above(sign);
        for (int c = 0; c < 4; ++c)
            over_gap = detail::largest(over_gap, std::abs(polynomial(weights, c) - at_check_above[c][sign]) * plan.share_above / above);
    }
    if (model != nullptr) *model = {m, list, {std::move(found.poles), {0, 0}, std::move(found.order), found.paired, true}, std::move(of)};
    return std::max({of_model, detail::error_of_samples(plan, of), ROUGHNESS * rough, ROUGHNESS_ABOVE * over_gap});
}

}  // namespace core
