// The conductances at a finite temperature and their derivatives by every site's V and by the parameters.
//
// The levels and poles of a set are those of thermal/conductance.hpp; the sums are explained in path.hpp, contour.hpp and
// answers.hpp.  At each point all probabilities are differentiated, and all biases share that: they enter by the kernel alone.
// What a shift of all energies does is found in two ways, through the kernel and through ∂M/∂ω of all sites, which have nothing in
// common: their difference is the error estimate.
//
// Next to the gap ∂p/∂Δ₀ grows beyond all bounds.  But p(ω) stays what it is if Δ₀ and all energies, Σ among them, are scaled by the
// same factor, but for what ω itself does in ω − H − Σ(ω) and in the leads.  With f for that, ∂M = ω + iΓ_d in the wire,
//
//     Δ₀ ∂/∂Δ₀ ∫ p K_V dω = ∫ f K_V dω − (V ∂/∂V + kT ∂/∂kT + Γ_d ∂/∂Γ_d) ∫ p K_V dω.
//
// Where the path goes on along the axis, next to the gap, levels are narrower than its points are apart.  There, with ω = Δ₀ tanh τ,
// those of kinetic energy ε have (Δ₀ ± V_Z)γ exp τ = ε², so a change of γ, Δ₀ or V_Z shifts τ of all levels of a spin alike, and ω by
// a multiple of ω − ω³/Δ₀².  What the path misses of such a shift, the closed form knows, and for each change the multiple is added.
#pragma once

#include <map>

#include "exact_poles.hpp"

namespace core {

// Where the derivatives go: (set, bias, conductance, site), and (set, bias, conductance, CHANGES); a set is (mu, B).  Roughly, only
// the first are found.
struct ThermalGradientArrays {
    double *by_V, *others;
};

// What all sets have in common of which the models have so many nodes.
struct GradientRules {
    ShiftedAverages averages;
    Path path;
    bool roughly;

    GradientRules(const ThermalGradientGrid& at, int nodes, const Wire& wire)
        : averages(PlanKey(at.grid, at.kT, nodes, wire).plan(at.grid, at.kT)),
          path(path_of(averages.plan, window_of(at.grid.omega, at.grid.omega_count, at.kT), wire, at.roughly)), roughly(at.roughly) {}

private:
    static Path path_of(const EnergyPlan& plan, double window, const Wire& wire, bool roughly) {
        if (!plan.reaches_gap()) return Path(window, plan.kT, wire.delta0, roughly ? ROUGH : EXACT);
        return Path(window, plan.kT, wire.delta0, std::max(resolved_up_to(wire, plan.nodes), LEAST_RESOLVED) - BEFORE);
    }
};

// By how much −τ of the levels next to the gap changes with γ, Δ₀ and V_Z, in the mean over the levels of both spins: there are
// √(Δ₀ ± V_Z) times as many for a unit of τ.
struct LevelsAtGap {
    double by_gamma, by_delta0, by_zeeman;
    double most_by_delta0;  // of the levels of one spin, with Δ₀ or V_Z; zero where there are those of one spin only

    explicit LevelsAtGap(const detail::GradientField& field) : by_gamma(1 / std::max(field.of.gamma, LEAST_GAMMA * field.of.delta0)) {
        const double V_Z = field.hop * field.zeeman, most = std::sqrt(field.of.delta0 + std::abs(V_Z));
        const double least = std::sqrt(std::max(field.of.delta0 - std::abs(V_Z), 0.0));
        if (least > FEWEST * most) by_delta0 = 1 / (most * least), by_zeeman = (1 / most - 1 / least) / (most + least);
        else by_delta0 = by_zeeman = 1 / (most * most);
        if (V_Z < 0) by_zeeman = -by_zeeman;
        most_by_delta0 = least > 0 ? 1 / std::pow(std::max(least, FEWEST * most), 2) : 0.0;
    }

private:
    static constexpr double FEWEST = 0.1;       // levels of the other spin that count, as a share
    static constexpr double LEAST_GAMMA = 0.5;  // so much less than Δ₀ at most, or the closed form's own error is made too large
};

// How wrong the derivatives of one set may be, in e²/h per kT.
struct GradientErrors {
    double shift = 0.0;  // how far apart the two of a shift are
    double at_gap = 0.0;  // of those by Δ₀ and V_Z: by how much the levels of one spin next to the gap may differ from the mean
};

// Fill out the derivatives of one set; roughly, `others` is left as it is.
inline GradientErrors gradient_of_set(const detail::GradientField& field, const GradientRules& rules, const RationalConductances& model, double mu,
                              std::vector<ContourPoint> points, double* by_V, double* others) {
    using namespace detail;
    static thread_local GradientRoom room;
    const EnergyPlan& plan = rules.averages.plan;
    const Path& path = rules.path;
    size_t sites = field.of.sites, values = size_t(plan.biases) * 4;
    room.sites.resize(sites);
    room.by_V.assign(sites * values, PointLanes::R(0.0)), room.others.assign(SUMS * values, PointLanes::R(0.0));
    auto in_lanes = [](size_t from, size_t to, auto use) {
        for (size_t first = from; first < to; first += REGISTER) use(first, int(std::min(to - first, size_t(REGISTER))));
    };
    auto add = [&](size_t first, int count) {
        const ContourPoint* some = &points[first];
        bool absorbed = field.of.dissipation > 0 || some->z.real() > field.of.delta0;  // by levels or the parent
        if (absorbed) PointsOfSet<WITH_RETURNS, true>(field, rules.averages, mu, some, count, room).add();
        else if (rules.roughly) PointsOfSet<PROBABILITIES, false>(field, rules.averages, mu, some, count, room).add();
        else PointsOfSet<PROBABILITIES, true>(field, rules.averages, mu, some, count, room).add();
    };
    if (!rules.roughly || path.reaches_gap())
        in_lanes(0, std::count_if(points.begin(), points.end(), is_at_pole),
                 [&](size_t first, int count) { find_exact_poles(field, path, mu, &points[first], count, room); });
    leave_out_twins(points);
    std::erase_if(points, [](const ContourPoint& one) { return one.weight == 0.0; });
    const size_t poles = std::count_if(points.begin(), points.end(), is_at_pole);
    const size_t on_axis = poles + path.above_axis.size(), above_gap = on_axis + path.next_to_gap.size();
    if (path.reaches_gap())
        in_lanes(poles, on_axis, [&](size_t first, int count) { find_conjugates(field, mu, &points[first], count); });
    in_lanes(0, poles, add);
    in_lanes(poles, above_gap, add);
    in_lanes(above_gap, points.size(), add);
    auto total = [](const PointLanes::R& x) {
        double sum = 0.0;
        for (int l = 0; l < REGISTER; ++l) sum += x[l];
        return sum;
    };
    for (size_t v = 0; v < values; ++v)
        for (size_t n = 0; n < sites; ++n) by_V[v * sites + n] = 2 / field.hop * total(room.by_V[n * values + v]);
    if (rules.roughly) return {};
    const auto by_bias = rules.averages.derivatives(model, BY_BIAS), by_kT = rules.averages.derivatives(model, BY_KT);
    std::vector<double> of_all = by_bias, missed(values, 0.0);
    if (plan.reaches_gap()) {
        of_all = rules.averages.of_shift(model, rules.averages.all), missed = rules.averages.of_shift(model, rules.averages.levels);
        for (size_t v = 0; v < values; ++v) missed[v] -= total(room.others[OF_LEVELS * values + v]);
    }
    const LevelsAtGap levels(field);
    GradientErrors error;
    for (size_t v = 0; v < values; ++v) {
        double* to = others + v * CHANGES;
        to[BY_BIAS] = by_bias[v], to[BY_KT] = by_kT[v];
        for (int change = 0; change <= BY_ENERGY; ++change) to[change] = total(room.others[change * values + v]);
        double kinetic = 2 * field.of.hopping - mu;
        for (size_t n = 0; n < sites; ++n) {
            to[BY_MU] -= by_V[v * sites + n];
            to[BY_ALPHA] -= field.hop_slope * (kinetic + field.of.V[n]) * by_V[v * sites + n];  // stretched with 1/t'
        }
        double scaled = to[BY_DELTA0] - field.of.dissipation * to[BY_DISSIPATION];
        to[BY_DELTA0] = (scaled - plan.bias[v / 4] * to[BY_BIAS] - plan.kT * to[BY_KT]) / field.of.delta0;
        to[BY_GAMMA] += levels.by_gamma * missed[v], to[BY_DELTA0] += levels.by_delta0 * missed[v], to[BY_ZEEMAN] += levels.by_zeeman * missed[v];
        error.shift = largest(error.shift, plan.kT * std::abs(to[BY_ENERGY] - of_all[v]));
        error.at_gap = largest(error.at_gap, plan.kT * levels.most_by_delta0 * std::abs(missed[v]));
    }
    return error;
}

// Where nodes go up to the gap, derivatives need averages that are better by so much.
constexpr double TOLERANCE_TO_GAP = 0.4;

// Fill G and error as thermal_conductance does, the derivatives, and their errors, shape (mu, B, 2) as GradientErrors: infinite,
// and the derivatives NaN, where a set has no model.  Roughly, errors are not estimated, and zero.
inline void thermal_gradient(const ThermalGradientGrid& at, double tolerance, double growth_limit, double* G, double* error,
                             double* energies, ThermalGradientArrays out, double* gradient_error, Stop& stop) {
    const Grid& grid = at.grid;
    const Wire& wire = *grid.wires;
    std::vector<SetModel> models;
    const bool reaches_gap = reach_of(grid.omega, grid.omega_count, at.kT, wire.delta0) != Reach::WINDOW;
    thermal_conductance(grid, at.kT, reaches_gap ? TOLERANCE_TO_GAP * tolerance : tolerance, growth_limit, G, error, energies, stop, &models);
    std::vector<detail::GradientField> fields;
    std::vector<Leads> leads;
    double cubic[CUBIC][CUBIC], energy[CUBIC];
    std::copy_n(at.energies, CUBIC, energy);
    invert_vandermonde(energy, cubic);
    for (int f = 0; f < grid.B_count; ++f) {
        fields.emplace_back(at, f);
        leads.push_back(detail::leads_through(cubic, wire.rotated_hopping(),
                                              [&](int k) { return lead_self_energy(wire, grid.B[f], energy[k]); })
                            .broadened(wire.dissipation));
    }
    std::map<int, GradientRules> rules;
    for (const SetModel& model : models)
        if (model.nodes > 0 && !rules.contains(model.nodes)) rules.try_emplace(model.nodes, at, model.nodes, wire);
    size_t values = size_t(grid.omega_count) * 4;
    in_parallel(grid.mu_count * grid.B_count, stop, [&](int set) {
        const size_t changes = at.roughly ? 0 : CHANGES;
        double *by_V = out.by_V + set * values * wire.sites, *others = out.others + set * values * changes;
        if (models[set].nodes == 0) {
            std::fill_n(by_V, values * wire.sites, NAN), std::fill_n(others, values * changes, NAN);
            gradient_error[2 * set] = gradient_error[2 * set + 1] = INFINITY;
            return;
        }
        int f = set % grid.B_count;
        const SetModel& model = models[set];
        const GradientRules& of = rules.at(model.nodes);
        Levels levels(model.levels, of.averages.plan.window);
        Batch batch(levels);
        auto points = contour(of.path, wire.rotated_hopping(), model.poles, leads[f], wire.dissipation, batch);
        const auto error = gradient_of_set(fields[f], of, model.conductances, grid.mu[set / grid.B_count], points, by_V, others);
        gradient_error[2 * set] = error.shift, gradient_error[2 * set + 1] = error.at_gap;
    });
}

}  // namespace core
