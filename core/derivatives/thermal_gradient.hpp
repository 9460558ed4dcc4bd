// The conductances at a finite temperature and their derivatives by every site's V and by the parameters.
//
// The levels and poles of a set are those of thermal/conductance.hpp; the sums are explained in contour.hpp and
// answers.hpp.  At each point all probabilities are differentiated, and all biases share that: they enter by the kernel alone.  The derivative by the bias is found in two ways, through the kernel and through ∂M/∂ω of all sites,
// which have nothing in common: their difference is the error estimate.
#pragma once

#include <map>

#include "exact_poles.hpp"

namespace core {

// Where the derivatives go: (set, bias, conductance, site), and (set, bias, conductance, CHANGES); a set is (mu, B).
struct ThermalGradientArrays {
    double *by_V, *others;
};

// Fill out the derivatives of one set but for those through the kernel, which are there, and return how far the two
// derivatives by the bias are apart, in e²/h per kT.
inline double gradient_of_set(const detail::GradientField& field, const EnergyPlan& plan, double mu, std::vector<ContourPoint> points,
                              double* by_V, double* others) {
    using namespace detail;
    static thread_local GradientRoom room;
    size_t sites = field.of.sites, values = size_t(plan.biases) * 4;
    room.sites.resize(sites);
    room.by_V.assign(sites * values, PointLanes::R(0.0)), room.others.assign((BY_ENERGY + 1) * values, PointLanes::R(0.0));
    auto in_lanes = [](size_t from, size_t to, auto use) {
        for (size_t first = from; first < to; first += REGISTER) use(first, int(std::min(to - first, size_t(REGISTER))));
    };
    auto add = [&](size_t first, int count) {
        if (field.of.dissipation > 0) PointsOfSet<WITH_RETURNS>(field, plan, mu, &points[first], count, room).add();
        else PointsOfSet<PROBABILITIES>(field, plan, mu, &points[first], count, room).add();
    };
    size_t poles = std::count_if(points.begin(), points.end(), [](const ContourPoint& of) { return of.kind != ContourPoint::ON_LINE; });
    in_lanes(0, poles, [&](size_t first, int count) { find_exact_poles(field, Line(plan.kT), mu, &points[first], count, room); });
    leave_out_twins(points);
    in_lanes(0, poles, add);
    in_lanes(poles, points.size(), add);
    auto total = [](const PointLanes::R& x) {
        double sum = 0.0;
        for (int l = 0; l < REGISTER; ++l) sum += x[l];
        return sum;
    };
    for (size_t v = 0; v < values; ++v)
        for (size_t n = 0; n < sites; ++n) by_V[v * sites + n] = 2 / field.hop * total(room.by_V[n * values + v]);
    double error = 0.0;
    for (size_t v = 0; v < values; ++v) {
        double* to = others + v * CHANGES;
        for (int change = 0; change <= BY_ENERGY; ++change) to[change] = total(room.others[change * values + v]);
        double kinetic = 2 * field.of.hopping - mu;
        for (size_t n = 0; n < sites; ++n) {
            to[BY_MU] -= by_V[v * sites + n];
            to[BY_ALPHA] -= field.hop_slope * (kinetic + field.of.V[n]) * by_V[v * sites + n];  // stretched with 1/t'
        }
        error = largest(error, plan.kT * std::abs(to[BY_ENERGY] - to[BY_BIAS]));
    }
    return error;
}

// Fill G and error as thermal_conductance does, the derivatives, and their errors, shape (mu, B): infinite, and the
// derivatives NaN, where a set has no model.
inline void thermal_gradient(const ThermalGradientGrid& at, double tolerance, double growth_limit, double* G, double* error,
                             double* energies, ThermalGradientArrays out, double* gradient_error, Stop& stop) {
    const Grid& grid = at.grid;
    const Wire& wire = *grid.wires;
    std::vector<SetModel> models;
    thermal_conductance(grid, at.kT, tolerance, growth_limit, G, error, energies, stop, &models);
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
    const EnergyPlan plan(grid.omega, grid.omega_count, at.kT, NODES[0], Reach::WINDOW);  // of which the nodes are not looked at
    std::map<int, ShiftedAverages> shifted;  // of each number of nodes
    for (const SetModel& model : models)
        if (model.nodes > 0 && !shifted.contains(model.nodes))
            shifted.try_emplace(model.nodes, PlanKey(grid, at.kT, model.nodes, wire).plan(grid, at.kT));
    size_t values = size_t(grid.omega_count) * 4;
    in_parallel(grid.mu_count * grid.B_count, stop, [&](int set) {
        double *by_V = out.by_V + set * values * wire.sites, *others = out.others + set * values * CHANGES;
        if (models[set].nodes == 0) {
            std::fill_n(by_V, values * wire.sites, NAN), std::fill_n(others, values * CHANGES, NAN);
            gradient_error[set] = INFINITY;
            return;
        }
        int f = set % grid.B_count;
        Levels levels(models[set].levels, plan.window);
        Batch batch(levels);
        auto points = contour(plan, wire.rotated_hopping(), models[set].poles, leads[f], wire.dissipation, batch);
        shifted.at(models[set].nodes).write(models[set].conductances, at.kT, others);
        gradient_error[set] = gradient_of_set(fields[f], plan, grid.mu[set / grid.B_count], points, by_V, others);
    });
}

}  // namespace core
