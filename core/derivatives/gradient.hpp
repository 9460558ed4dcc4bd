// The derivatives of the bare conductances, T = 0, by every site's V, and by μ, B and α, at all points
// of one wire's grid of chemical potentials, fields and biases.
//
// As for the conductance, +ω and −ω share all but the sums of the same six probabilities: where both
// are asked for, these are differentiated, otherwise the four conductances themselves.
#pragma once

#include <memory>

#include "pivoted.hpp"

namespace core {

constexpr int GRADIENT_LANES = REGISTER;

// Where the derivatives go: (conductance, mu, B, bias, site) and (conductance, μ B α, mu, B, bias).
struct GradientArrays {
    double *by_V, *others;
    size_t points, sites;
    double* row(int k, size_t point) const { return by_V + (k * points + point) * sites; }
    double& other(int k, int by, size_t point) const { return others[(3 * k + by) * points + point]; }
};

// The derivatives of up to GRADIENT_LANES pairs (μ, ω) in one field.
template <int COUNT>
class LanesOfPairs {
    static constexpr int W = GRADIENT_LANES, SIGNS = COUNT == PROBABILITIES ? 2 : 1;
    using R = Lanes<W>;
    using Traces = R[COUNT];

    const GradientGrid& grid;
    const TurningField& field;
    const LeadSelfEnergy* slopes;
    GradientArrays out;
    int f, first, count;

    int pair(int l) const { return first + std::min(l, count - 1); }
    int energy(int l) const { return pair(l) % grid.omega_count; }
    double kinetic(int l) const { return field.kinetic_zero - grid.mu[pair(l) / grid.omega_count] / field.hop; }
    size_t point(int l, int bias) const {
        return (size_t(pair(l) / grid.omega_count) * grid.B_count + f) * grid.bias_count + bias;
    }
    int bias(int l, int sign) const {
        const std::int64_t* of = grid.biases + 2 * energy(l);
        return int(SIGNS == 2 ? of[sign] : std::max(of[0], of[1]));
    }

    // The conductances of a sum over probabilities, or, where one sign is asked for, what there is.
    static CORE_INLINE Conductances<R> at_signs(const Traces& of, R scale) {
        R scaled[COUNT];
        for (int k = 0; k < COUNT; ++k) scaled[k] = scale * of[k];
        if constexpr (SIGNS == 2) return conductances_of(scaled);
        Conductances<R> G;
        for (int k = 0; k < 4; ++k) G.at[0][k] = scaled[k];
        return G;
    }

    void write_sites(const Traces* traces) const {
        double* rows[SIGNS][4][W];
        for (int sign = 0; sign < SIGNS; ++sign)
            for (int k = 0; k < 4; ++k)
                for (int l = 0; l < W; ++l)
                    rows[sign][k][l] = l < count && bias(l, sign) >= 0 ? out.row(k, point(l, bias(l, sign))) : nullptr;
        int sites = int(out.sites);
        for (int start = 0; start < sites; start += W) {
            int some = std::min(W, sites - start);
            Conductances<R> G[W];
            for (int m = 0; m < some; ++m) G[m] = at_signs(traces[start + m], -1 / field.hop);
            for (int sign = 0; sign < SIGNS; ++sign)
                for (int k = 0; k < 4; ++k) {
                    Register of[W];
                    for (int m = 0; m < W; ++m) of[m] = G[std::min(m, some - 1)].at[sign][k].r[0];
                    transpose(of);
                    for (int l = 0; l < W; ++l)
                        if (double* to = rows[sign][k][l]) {
                            if (some == W) std::memcpy(to + start, &of[l], sizeof of[l]);
                            else std::memcpy(to + start, &of[l], some * sizeof(double));
                        }
                }
        }
    }

    void write_others(int by, const Traces& of) const {
        Conductances<R> G = at_signs(of, 1.0);
        for (int sign = 0; sign < SIGNS; ++sign)
            for (int l = 0; l < count; ++l)
                if (bias(l, sign) >= 0)
                    for (int k = 0; k < 4; ++k) out.other(k, by, point(l, bias(l, sign))) = G.at[sign][k][l];
    }

    void pivot(int l) const {
        const Pairing& pairing = field.pairing[energy(l)];
        PivotedDerivatives found = pivoted_derivatives(field, RealArithmetic::one(kinetic(l), pairing, field.hop),
                                                       field.leads[energy(l)], slopes + 2 * energy(l));
        for (int sign = 0; sign < 2; ++sign) {
            int which = int(grid.biases[2 * energy(l) + sign]);
            if (which < 0) continue;
            auto of = [&](const Probabilities& p, int k) {
                double copy[PROBABILITIES];
                std::copy(p.begin(), p.end(), copy);
                return conductances_of(copy).at[sign][k];
            };
            for (int k = 0; k < 4; ++k) {
                for (size_t n = 0; n < out.sites; ++n) out.row(k, point(l, which))[n] = of(found.by_V[n], k);
                for (int by = 0; by < 3; ++by) out.other(k, by, point(l, which)) = of(found.others[by], k);
            }
        }
    }

public:
    LanesOfPairs(const GradientGrid& grid, const TurningField& field, int f, int first, GradientArrays out)
        : grid(grid), field(field), slopes(grid.slopes + size_t(f) * grid.omega_count * 2), out(out), f(f), first(first),
          count(std::min(W, grid.mu_count * grid.omega_count - first)) {}

    void solve(double growth_limit) const {
        Terms<R> terms;
        LaneLeads<R> leads;
        LeadSlopes<R> lead_slopes;
        R minus;
        for (int l = 0; l < W; ++l) {
            const Pairing& pairing = field.pairing[energy(l)];
            terms.kinetic.set(l, kinetic(l));
            terms.normal.set(l, pairing.normal / field.hop);
            terms.anomalous.set(l, pairing.anomalous / field.hop);
            leads.set(l, field.leads[energy(l)]);
            for (int by = 0; by < 2; ++by) lead_slopes.by[by].set(l, slopes[2 * energy(l) + by]);
            minus.set(l, grid.biases[2 * energy(l)] < 0 ? 1.0 : 0.0);
        }
        auto sites = std::make_unique_for_overwrite<Site<R>[]>(out.sites);
        auto traces = std::make_unique_for_overwrite<Traces[]>(out.sites);
        auto ends = sweep(view(field.wire), terms, sites.get());
        auto of_ends = responses(attach_leads(ends, leads), leads, lead_slopes);
        if constexpr (SIGNS == 2)
            contract(terms, of_ends, sites.get(), traces.get());
        else
            contract(terms, of_one_sign(of_ends, minus), sites.get(), traces.get());
        for (int l = 0; l < count; ++l)
            if (!(ends.growth[l] < growth_limit)) pivot(l);  // NaN too
    }

private:
    void contract(const Terms<R>& terms, const Responses<COUNT, R>& of, const Site<R>* sites, Traces* traces) const {
        double slope = field.hop_slope;
        R normal = -slope * terms.normal, anomalous = -slope * terms.anomalous;
        Contraction<COUNT, R> sum{sites, field.turns.data(), int(out.sites) - 1, of, anomalous, traces, {}, {}};
        sum.add_all();
        Traces by[3];
        for (int k = 0; k < COUNT; ++k) {
            R through_field, n, turned;
            sum.summed(k, through_field, n, turned);
            by[0][k] = sum.total[k] * (1 / field.hop);
            by[1][k] = of.through_leads[0][k] - field.zeeman_per_tesla * through_field;
            R same = sum.total[k] * terms.kinetic + field.zeeman * through_field;  // what scales with 1/t'
            by[2][k] = of.through_leads[1][k] + normal * (through_field + 2.0 * n) - anomalous * through_field + turned +
                       sum.weighted[k] + slope * same;
        }
        write_sites(traces);
        for (int i = 0; i < 3; ++i) write_others(i, by[i]);
    }
};

inline void gradient(const GradientGrid& grid, double growth_limit, double* by_V, double* others, Stop& stop) {
    size_t points = size_t(grid.mu_count) * grid.B_count * grid.bias_count;
    GradientArrays out{by_V, others, points, size_t(grid.wire.sites)};
    std::vector<TurningField> fields;
    for (int f = 0; f < grid.B_count; ++f) fields.emplace_back(grid, grid.B[f]);
    int pieces = (grid.mu_count * grid.omega_count + GRADIENT_LANES - 1) / GRADIENT_LANES;
    bool both = grid.both_signs();
    in_parallel(grid.B_count * pieces, stop, [&](int task) {
        int f = task / pieces, first = task % pieces * GRADIENT_LANES;
        if (both)
            LanesOfPairs<PROBABILITIES>(grid, fields[f], f, first, out).solve(growth_limit);
        else
            LanesOfPairs<4>(grid, fields[f], f, first, out).solve(growth_limit);
    });
}

}  // namespace core
