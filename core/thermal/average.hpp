// One set's thermal average from its levels: poles, residues, closed form, and how sure it is.
//
// What is left of the conductance beside its poles is smooth, and interpolated (plan.hpp).  Comparisons with the solver at
// further energies give the error (estimate.hpp).
#pragma once

#include "estimate.hpp"

namespace core {

// What is known of a set once it is averaged, if it is asked for.
struct SetModel {
    int nodes = 0;  // 0: none
    LevelList levels;
    Resonances poles{{}, {0, 0}, {}};  // without their vectors
    RationalConductances conductances;
};

namespace detail {

// The conductances that a model has at the nodes, where levels are broadened.
inline std::vector<Conductances<double>> conductances_at_nodes(const EnergyPlan& plan, const ThermalField& field, const Leads& leads,
                                                               Batch& b) {
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

// Fill in what the poles leave of conductances at the nodes, at the samples and above the gap.
inline void fill_rest(const EnergyPlan& plan, RationalConductances& of, const Conductances<double>* at_nodes,
                      const Conductances<double>* at_samples, const Conductances<double>* at_above) {
    const Remainder remainder{of.poles};
    const int m = plan.nodes, below = plan.nodes_below();
    for (auto& values : of.rest) values.assign(padded(plan.smooth_values()), 0.0);
    auto keep = [&](int first, int count) {  // at ω, then at −ω
        return [&, first, count](int c, int k, int sign, double value) { of.rest[c][first + k + sign * count] = value; };
    };
    remainder(m, plan.omega.data(), at_nodes, keep(0, below));
    remainder(plan.samples, plan.omega.data() + m + CHECKS, at_samples, keep(m, below));
    remainder(plan.nodes_above(), plan.above.data(), at_above, keep(2 * below, plan.nodes_above()));
}

}  // namespace detail

// Write the thermal conductances of one set, shape (bias, 4), and its model, if asked for; return the error estimate in
// e²/h.
inline double rational_average(const EnergyPlan& plan, const detail::ThermalField& field, const LevelList& list, const SetData& data,
                               const Leads& leads, double* out, SetModel* model = nullptr) {
    const int pick = plan.picks[1];
    const double hop = field.hop, width = field.of.dissipation;
    Levels levels(list, plan.window);
    Batch batch(levels);
    Starts starts = start_poles(plan.omega[pick], data.isolated[pick].G, plan.pole_limit(), hop, levels, leads);
    Resonances found = find_poles(starts, levels, leads, batch);
    if (!found.whole) return INFINITY;
    RationalConductances of{conductance_terms(found, leads, width, batch), {}};
    of.poles.leave_out_beyond(plan.gap);

    const int m = plan.nodes, below = plan.nodes_below(), over = plan.nodes_above();
    std::vector<Conductances<double>> broadened;
    if (width > 0) broadened = detail::conductances_at_nodes(plan, field, leads, batch);
    const Conductances<double>* bare = data.bare.data();
    detail::fill_rest(plan, of, width > 0 ? broadened.data() : bare, bare + m + COMPARED, bare + below + COMPARED);
    of.average(plan.weights, plan.bias, plan.kT, out);

    detail::Comparison at(plan, data.sought);
    const detail::Remainder remainder{of.poles};
    remainder(COMPARED, at.checks, bare + m, [&](int c, int k, int sign, double value) { at.rest[c][sign][k] = value; });
    if (over > 0)
        remainder(1, plan.above.data() + over, bare + below + COMPARED + over, [&](int c, int, int sign, double value) { at.above[c][sign] = value; });
    for (int k = 0; k < COMPARED; ++k) at.shares[k] = detail::share_that_counts(at.checks[k], plan.kT, of.poles) * at.of_kernel[k];
    double of_model = SAFETY * hop * detail::mismatch(at, leads, width, data, batch);
    double of_rest = detail::error_of_rest(plan, of, at);
    double estimate = detail::largest(of_model, of_rest);
    if (model != nullptr) *model = {m, list, {std::move(found.poles), {0, 0}, std::move(found.order), found.paired, found.spare, true}, std::move(of)};
    return estimate;
}

}  // namespace core
