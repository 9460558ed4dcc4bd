// The conductance at finite temperature, exactly: rational in energy, averaged in closed form.
//
// For one set (wire, B, μ): the end Green's function and its slope at M energies (wire/), the levels of the
// isolated wire and the poles with the leads attached (poles/), their residues and closed-form averages
// (average.hpp).  A few further energies check the model; where it is off by more than the tolerance, M grows.
#pragma once

#include <compare>
#include <map>
#include <span>

#include "../conductance.hpp"
#include "../poles/isolated.hpp"
#include "average.hpp"

namespace core {

constexpr double TOLERANCE = 1e-4;                 // estimated error in e²/h above which nodes are added
// Two models that differ by less than their estimates are as wrong as the geometric mean of both: the estimates
// are cautious, but models may err together.
constexpr double AGREEMENT = 2.0;
// Error in e²/h that no check sees: of the kernel's cut and of the smooth part's interpolation; next to the gap, more.  Of
// 2,000 hot wires the error is above the estimate in eight with 5e-6 there, in one with this.
constexpr double FLOOR = 5e-6, FLOOR_TO_GAP = 2e-5;

struct SetIndex {
    int wire, field, mu;
    bool same_field(const SetIndex& other) const { return wire == other.wire && field == other.field; }
};

namespace detail {

constexpr int SLOPE_LANES = REGISTER;
using SlopeReal = Lanes<SLOPE_LANES>;

// Fill the data at the nodes of sets of one wire and field.
inline void solve_nodes(const ThermalField& field, const EnergyPlan& plan, const double* mu, const SetIndex* sets, int count,
                        SetData* data) {
    int nodes = plan.nodes, total = count * nodes;
    for (int piece = 0; piece < total; piece += SLOPE_LANES) {
        Terms<SlopeReal> terms{};
        LaneLeads<SlopeReal> leads{};
        SlopeReal normal_slope{}, anomalous_slope{};
        for (int l = 0; l < SLOPE_LANES; ++l) {
            int pair = std::min(piece + l, total - 1), e = pair % nodes;
            const Pairing& p = field.pairing[e];
            terms.kinetic.set(l, field.kinetic(mu[sets[pair / nodes].mu]));
            terms.normal.set(l, p.normal / field.hop), normal_slope.set(l, p.normal_slope / field.hop);
            terms.anomalous.set(l, p.anomalous / field.hop), anomalous_slope.set(l, p.anomalous_slope / field.hop);
            leads.set(l, field.leads[e]);
        }
        EndSlopes<SlopeReal> slopes;
        auto ends = eliminate_inner_sites_with_slopes(view(field.wire), terms, normal_slope, anomalous_slope, slopes);
        auto G = attach_leads(ends, leads);
        auto bare = lossless_conductances_of_ends<SlopeReal>(G, leads);
        Symmetric8<SlopeReal> isolated, slope;
        isolated_ends(ends, slopes, isolated, slope);
        double own[36][SLOPE_LANES], own_slope[36][SLOPE_LANES];
        for (int k = 0; k < 36; ++k) {
            SlopeReal G = isolated.entry[k] * (1 / field.hop), dG = slope.entry[k] * (1 / field.hop);
            G.store(own[k]), dG.store(own_slope[k]);
        }
        for (int l = 0; l < SLOPE_LANES && piece + l < total; ++l) {
            SetData& of = data[(piece + l) / nodes];
            int e = (piece + l) % nodes;
            of.growth = largest(of.growth, ends.growth[l]);
            of.bare[e] = lane_of(bare, l);
            for (int i = 0; i < 8; ++i)
                for (int j = 0; j < 8; ++j) {
                    int k = Symmetric8<SlopeReal>::place(i, j);
                    of.isolated[e].G[i][j] = own[k][l], of.isolated[e].slope[i][j] = own_slope[k][l];
                }
        }
    }
}

// Solve each set of one wire and field at `each` energies: at(set, k) are the energy and its leads, and use(set, k, bare, G)
// takes what is found.
template <class A, class At, class Use>
inline void solve_each(const ThermalField& field, const double* mu, const SetIndex* sets, int count, int each, double growth_limit,
                       At at, Use use) {
    int total = count * each;
    for (int piece = 0; piece < total; piece += A::LANES) {
        Terms<typename A::N> terms{};
        typename A::Leads lanes{};
        for (int l = 0; l < A::LANES; ++l) {
            int pair = std::min(piece + l, total - 1);
            auto [omega, leads] = at(pair / each, pair % each);
            A::set_kinetic(terms, l, field.kinetic(mu[sets[pair / each].mu]));
            A::set(terms, l, typename A::Pairing(field.of, omega), field.hop);
            lanes.set(l, leads);
        }
        auto ends = eliminate_inner_sites<typename A::N, typename A::Block>(view(field.wire), terms);
        auto G = attach_leads(ends, lanes);
        solve_lost_lanes<A>(field.wire, ends, G, std::min(A::LANES, total - piece), growth_limit, [&](int l) {
            auto [omega, leads] = at((piece + l) / each, (piece + l) % each);
            double kinetic = field.kinetic(mu[sets[(piece + l) / each].mu]);
            return std::pair(A::one(kinetic, typename A::Pairing(field.of, omega), field.hop), leads);
        });
        auto bare = A::conductances(G, lanes);
        for (int l = 0; l < A::LANES && piece + l < total; ++l)
            use((piece + l) / each, (piece + l) % each, lane_of(bare, l), [&](int k) {
                return Complex<double>(G.entry[k].re[l], G.entry[k].im[l]);
            });
    }
}

// Add the data at the checks and samples, once the sets' own are known.
template <class A>
inline void solve_checks(const ThermalField& field, const EnergyPlan& plan, const double* mu, const SetIndex* sets, int count,
                         double growth_limit, SetData* data) {
    auto at = [&](int set, int k) {
        if (CHECKS <= k && k < COMPARED) {
            double omega = data[set].sought[k - CHECKS];
            return std::pair(omega, lead_self_energy(field.of, field.B, omega));
        }
        int shared = plan.nodes + (k < CHECKS ? k : k - SOUGHT);
        return std::pair(plan.omega[shared], field.leads[shared]);
    };
    const int each = COMPARED + plan.samples;
    solve_each<A>(field, mu, sets, count, each, growth_limit, at, [&](int set, int k, const auto& bare, auto entry) {
        SetData& of = data[set];
        of.bare[plan.nodes + k] = bare;
        if (k >= COMPARED) return;
        for (int e = 0; e < 36; ++e) of.green[k].entry[e] = entry(e) * (1 / field.hop);
        to_chiral(of.green[k]);
    });
}

// Add the conductances above the gap.
inline void solve_above(const ThermalField& field, const EnergyPlan& plan, const double* mu, const SetIndex* sets, int count,
                        double growth_limit, SetData* data) {
    std::vector<LeadSelfEnergy> leads;
    for (double omega : plan.above) leads.push_back(lead_self_energy(field.of, field.B, omega));
    auto at = [&](int, int k) { return std::pair(plan.above[k], leads[k]); };
    const int each = int(plan.above.size());
    solve_each<ComplexArithmetic>(field, mu, sets, count, each, growth_limit, at, [&](int set, int k, const auto& bare, auto) {
        data[set].bare[plan.nodes_below() + COMPARED + k] = bare;
    });
}

// Average up to SETS sets into out (wire, mu, B, bias, 4), estimate (wire, mu, B) and, unless null, models, of the same
// shape.
inline void average_sets(const Grid& grid, const EnergyPlan& plan, const SetIndex* sets, int count, double growth_limit,
                         double* out, double* estimate, SetModel* models) {
    static thread_local std::vector<SetData> room(SETS);
    std::span<SetData> data(room.data(), count);
    for (SetData& of : data) {
        of.isolated.resize(plan.nodes), of.growth = 0.0;
        of.bare.resize(plan.nodes_below() + COMPARED + plan.above.size());
    }
    std::vector<ThermalField> fields;
    std::vector<int> starts;
    for (int first = 0; first < count; ++first)
        if (first == 0 || !sets[first].same_field(sets[first - 1])) {
            starts.push_back(first);
            fields.emplace_back(grid.wires[sets[first].wire], grid.B[sets[first].field], plan.omega);
        }
    starts.push_back(count);
    for (size_t k = 0; k < fields.size(); ++k)
        solve_nodes(fields[k], plan, grid.mu, sets + starts[k], starts[k + 1] - starts[k], &data[starts[k]]);
    std::vector<const NodeData*> nodes;
    for (const SetData& of : data) nodes.push_back(of.isolated.data());
    std::vector<LevelList> levels(count);
    wire_levels(plan.omega.data(), plan.nodes, nodes, levels.data());
    for (size_t k = 0; k < fields.size(); ++k) {
        const ThermalField& field = fields[k];
        for (int i = starts[k]; i < starts[k + 1]; ++i) dense_energies(levels[i], field.hop, plan, data[i].sought);
        auto solve = [&](auto solve_some) {
            solve_some(field, plan, grid.mu, sets + starts[k], starts[k + 1] - starts[k], growth_limit, &data[starts[k]]);
        };
        solve(field.of.dissipation > 0 ? solve_checks<ComplexArithmetic> : solve_checks<RealArithmetic>);
        solve(solve_above);
        const Leads leads = field.around_the_window(plan).broadened(field.of.dissipation);
        for (int i = starts[k]; i < starts[k + 1]; ++i) {
            size_t at = (size_t(sets[i].wire) * grid.mu_count + sets[i].mu) * grid.B_count + sets[i].field;
            estimate[at] = INFINITY;
            if (!levels[i].empty() && data[i].growth < growth_limit)
                estimate[at] = rational_average(plan, field, levels[i], data[i], leads, out + at * plan.biases * 4,
                                                models == nullptr ? nullptr : models + at);
        }
    }
}

}  // namespace detail

// What tells the plans of the wires of a grid apart.
struct PlanKey {
    int nodes;
    Reach reach;
    double delta0, resolved;  // delta0 is infinite where the window ends below the gap
    auto operator<=>(const PlanKey&) const = default;

    PlanKey(const Grid& grid, double kT, int nodes, const Wire& wire)
        : nodes(nodes), reach(reach_of(grid.omega, grid.omega_count, kT, wire.delta0)),
          delta0(reach == Reach::WINDOW ? INFINITY : wire.delta0),
          resolved(reach == Reach::HOT_GAP ? resolved_up_to(wire, nodes) : LAST) {}
    EnergyPlan plan(const Grid& grid, double kT) const {
        return EnergyPlan(grid.omega, grid.omega_count, kT, nodes, reach, delta0, resolved);
    }
};

// The plans of some wires in one round: one for all whose window ends below the gap, others for those who differ.
class EnergyPlans {
    std::map<PlanKey, EnergyPlan> plans;
    std::vector<const EnergyPlan*> of_wire;

public:
    // asked(w): whether a wire has sets left.
    template <class Asked>
    EnergyPlans(const Grid& grid, double kT, int round, bool with_slopes, Asked asked) {
        for (int w = 0; w < grid.wire_count; ++w) {
            const Wire& wire = grid.wires[w];
            int nodes = nodes_in_round(round, reach_of(grid.omega, grid.omega_count, kT, wire.delta0), wire, with_slopes);
            of_wire.push_back(nullptr);
            if (nodes == 0 || !asked(w)) continue;
            const PlanKey key(grid, kT, nodes, wire);
            auto known = plans.find(key);
            if (known == plans.end()) known = plans.emplace(key, key.plan(grid, kT)).first;
            of_wire.back() = &known->second;
        }
    }
    const EnergyPlan* of(int wire) const { return of_wire[wire]; }
};

// Fill G, shape (wire, mu, B, bias, 4), its estimated error and how many energies each set took, (wire, mu, B).
// grid.omega holds the biases.  Where `models` is given, it is filled with the models that G is from, which are good enough for
// derivatives.
inline void thermal_conductance(const Grid& grid, double kT, double tolerance, double growth_limit, double* G, double* error,
                                double* energies, Stop& stop, std::vector<SetModel>* models = nullptr) {
    size_t total = size_t(grid.wire_count) * grid.mu_count * grid.B_count, values = size_t(grid.omega_count) * 4;
    std::fill(G, G + total * values, 0.0), std::fill(error, error + total, INFINITY), std::fill(energies, energies + total, 0.0);
    std::vector<std::vector<double>> earlier;
    if (models != nullptr) models->clear(), models->resize(total);
    auto place = [&](const SetIndex& s) { return (size_t(s.wire) * grid.mu_count + s.mu) * grid.B_count + s.field; };
    for (int round = 0; round < ROUNDS_OF_NODES; ++round) {
        size_t each = total / grid.wire_count;
        auto done = [&](double of) { return of <= tolerance; };
        const EnergyPlans plans(grid, kT, round, models != nullptr,
                                [&](int w) { return !std::all_of(error + w * each, error + (w + 1) * each, done); });
        std::vector<SetIndex> sets;
        for (int w = 0; w < grid.wire_count; ++w)
            for (int f = 0; f < grid.B_count; ++f)
                for (int m = 0; m < grid.mu_count; ++m)
                    if (plans.of(w) != nullptr && !done(error[place({w, f, m})])) sets.push_back({w, f, m});
        if (sets.empty()) continue;
        std::vector<double> found(total * values, NAN), estimate(total, INFINITY);
        std::vector<SetModel> tried(models == nullptr ? 0 : total);
        std::vector<int> starts;  // of tasks, of up to SETS sets of one plan
        for (int k = 0; k < int(sets.size()); ++k)
            if (k == 0 || k - starts.back() == SETS || plans.of(sets[k].wire) != plans.of(sets[k - 1].wire)) starts.push_back(k);
        starts.push_back(int(sets.size()));
        in_parallel(int(starts.size()) - 1, stop, [&](int task) {
            detail::average_sets(grid, *plans.of(sets[starts[task]].wire), &sets[starts[task]], starts[task + 1] - starts[task],
                                 growth_limit, found.data(), estimate.data(), models == nullptr ? nullptr : tried.data());
        });
        if (stop.asked()) return;
        for (const SetIndex& set : sets) {
            size_t at = place(set);
            double* now = &found[at * values];
            energies[at] += plans.of(set.wire)->energies();
            bool numbers = std::all_of(now, now + values, [](double value) { return std::isfinite(value); });
            if (!numbers || !std::isfinite(estimate[at])) {
                estimate[at] = INFINITY;
                std::fill(now, now + values, NAN);
            }
            for (const auto& other : earlier) {
                double apart = 0.0;
                for (size_t k = 0; k < values; ++k) apart = detail::largest(apart, std::abs(now[k] - other[at * values + k]));
                apart *= AGREEMENT;
                if (apart < estimate[at]) estimate[at] = std::sqrt(apart * estimate[at]);  // NaN agrees with nothing
            }
            estimate[at] += plans.of(set.wire)->reaches_gap() ? FLOOR_TO_GAP : FLOOR;
            if (estimate[at] < error[at]) {
                error[at] = estimate[at];
                std::copy(now, now + values, G + at * values);
                if (models != nullptr) (*models)[at] = std::move(tried[at]);
            }
        }
        earlier.push_back(std::move(found));
    }
}

}  // namespace core
