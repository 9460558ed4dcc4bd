// What points of the contour add to the derivatives of one set: of contour.hpp the sums, of answers.hpp the terms.
#pragma once

#include "../thermal/kernel.hpp"
#include "shifted_averages.hpp"
#include "thermal_field.hpp"

namespace core {

inline bool is_at_pole(const ContourPoint& of) { return of.kind == ContourPoint::POLE_OF_MODEL || of.kind == ContourPoint::POLE_OF_MATRIX; }

namespace detail {

// What is summed beside the derivatives by V: the changes up to BY_ENERGY, and the shift of the levels below the gap.
constexpr int OF_LEVELS = BY_ENERGY + 1, SUMS = OF_LEVELS + 1;

// Room for the points of one set.
struct GradientRoom {
    std::vector<SiteColumns<PointLanes::R>> sites;
    std::vector<PointLanes::R> by_V;  // (site, bias, conductance)
    std::vector<PointLanes::R> others;  // (SUMS, bias, conductance)
};

// Find Ḡ(z) = G(z*)* of the ends at up to REGISTER points.
inline void find_conjugates(const GradientField& field, double mu, ContourPoint* points, int count) {
    std::vector<ContourPoint> below(points, points + count);
    for (ContourPoint& point : below) point.z = std::conj(point.z);
    using C = PointLanes::C;
    const PointLanes at(field, mu, below.data(), count);
    const auto G = attach_leads(eliminate_inner_sites<C, Symmetric4<C>>(view(field.wire), at.terms), at.leads.sigma);
    for (int l = 0; l < count; ++l)
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8; ++j) points[l].conjugate(i, j) = std::conj(of_lane(G(i, j), l));
}

// Up to REGISTER points of one set: what they add to the derivatives of COUNT probabilities, by V or by ALL that changes them.
template <int COUNT, bool ALL>
class PointsOfSet {
    using R = PointLanes::R;
    using C = PointLanes::C;

    const GradientField& field;
    const ContourPoint* points;
    int count;
    GradientRoom& room;
    PointLanes at;
    struct Weights {
        C plus = C(0.0), minus = C(0.0);  // with K_V and K_−V
    };
    std::vector<Weights> kernel;  // (bias,), zero where there is no point
    C of_all = C(0.0), of_levels = C(0.0), energy = C(0.0);  // s(z) of the two shifts, and z
    DriveAt<R> drives[COUNT];
    SiteSums<R> sums[COUNT];

    // Re of the weights times the conductances that the probabilities make.
    static CORE_INLINE void add(const Conductances<C>& G, const Weights& w, double sign_of_minus, R* to) {
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) {
            const C &up = G.at[0][k], &down = G.at[1][k];
            R of_minus = w.minus.re * down.re - w.minus.im * down.im;
            to[k] = to[k] + w.plus.re * up.re - w.plus.im * up.im + of_minus * sign_of_minus;
        }
    }
    void add_to_others(int change, const C (&of)[COUNT], double sign_of_minus = 1.0) const {
        Conductances<C> G = conductances_of(of);
        for (size_t v = 0; v < kernel.size(); ++v)
            add(G, kernel[v], sign_of_minus, &room.others[(change * kernel.size() + v) * 4]);
    }

public:
    PointsOfSet(const GradientField& field, const ShiftedAverages& averages, double mu, const ContourPoint* points, int count,
                GradientRoom& room)
        : field(field), points(points), count(count), room(room), at(field, mu, points, count), kernel(averages.plan.biases) {
        const EnergyPlan& plan = averages.plan;
        for (int l = 0; l < count; ++l) {
            const ContourPoint& point = points[l];
            set_lane(of_all, l, averages.all.at(point.z)), set_lane(of_levels, l, averages.levels.at(point.z));
            set_lane(energy, l, point.z);
            Amplitude mirrored = point.mirrored ? point.weight : 0.0;
            for (int v = 0; v < plan.biases; ++v) {
                set_lane(kernel[v].plus, l, point.weight * thermal_kernel(point.z, plan.bias[v], plan.kT));
                set_lane(kernel[v].minus, l, mirrored * thermal_kernel(point.z, -plan.bias[v], plan.kT));
            }
        }
    }

    void add() {
        if (std::all_of(points, points + count, is_at_pole)) {
            add_poles();
            return;
        }
        auto meet = [&](Ends<R> G) {
            C scale = model_at_poles(G);
            conjugate_on_axis(G);
            for (int k = 0; k < COUNT; ++k) {
                drives[k].fill(G, at.leads, FROM[k], TO[k], 1.0);
                for (auto& row : drives[k].m)
                    for (auto& entry : row) entry = entry * (scale * scale);
            }
        };
        auto use = [&](int n, const Block4<C>& P, const Block4<C>& Q) {
            C wave[CHANNELS][2][4], tau_z[COUNT];
            for (int c = 0; c < 2; ++c)
                for (int q = 0; q < 2; ++q)
                    for (int i = 0; i < 4; ++i) wave[c][q][i] = P(i, 2 * c + q), wave[2 + c][q][i] = Q(i, 2 * c + q);
#pragma GCC unroll 10
            for (int k = 0; k < COUNT; ++k) {
                C u[2][4];
                const auto& m = drives[k].m;
                const auto& to = wave[TO[k]];
                for (int q = 0; q < 2; ++q)
                    for (int i = 0; i < 4; ++i) u[q][i] = to[0][i] * m[0][q] + to[1][i] * m[1][q];
                tau_z[k] = add_site<2, ALL, R>(field.frames[n], u, wave[FROM[k]], sums[k]);
            }
            add_by_V(n, tau_z);
        };
        for_all_columns<R>(view(field.wire), at.terms, at.leads.sigma, room.sites, meet, use);
        if constexpr (ALL) add_changes();
    }

private:
    // The same where all points are at poles: Q_ab is x_b x_aᵀ, x_c = λ G_·c Γ_c v̄_c.
    void add_poles() {
        C f[CHANNELS][2];
        auto meet = [&](Ends<R> G) {
            C scale = model_at_poles(G);
            for (int c = 0; c < CHANNELS; ++c)
                for (int p = 0; p < 2; ++p) {
                    C driven = at.leads.gamma[c][p] * at.leads.v[2 * c] + at.leads.gamma[c][p + 1] * at.leads.v[2 * c + 1];
                    f[c][p] = driven * scale;
                }
            for (int k = 0; k < COUNT; ++k) drives[k].fill(G, at.leads, FROM[k], TO[k]);
        };
        auto use = [&](int n, const Block4<C>& P, const Block4<C>& Q) {
            C x[CHANNELS][1][4], tau_z[COUNT];
            for (int c = 0; c < 2; ++c)
                for (int i = 0; i < 4; ++i) {
                    x[c][0][i] = P(i, 2 * c) * f[c][0] + P(i, 2 * c + 1) * f[c][1];
                    x[2 + c][0][i] = Q(i, 2 * c) * f[2 + c][0] + Q(i, 2 * c + 1) * f[2 + c][1];
                }
#pragma GCC unroll 10
            for (int k = 0; k < COUNT; ++k) tau_z[k] = add_site<1, ALL, R>(field.frames[n], x[TO[k]], x[FROM[k]], sums[k]);
            add_by_V(n, tau_z);
        };
        for_all_columns<R>(view(field.wire), at.terms, at.leads.sigma, room.sites, meet, use);
        if constexpr (ALL) add_changes();
    }

    CORE_INLINE void add_by_V(int n, const C (&tau_z)[COUNT]) const {
        Conductances<C> G = conductances_of(tau_z);
        R* to = &room.by_V[size_t(n) * kernel.size() * 4];
        for (size_t v = 0; v < kernel.size(); ++v) add(G, kernel[v], 1.0, to + 4 * v);
    }

    // Take the model's G for that of the ends at its poles, and return λ.
    C model_at_poles(Ends<R>& G) const {
        C scale(1.0);
        for (int l = 0; l < count; ++l) {
            const ContourPoint& point = points[l];
            if (point.kind != ContourPoint::POLE_OF_MODEL) continue;
            Amplitude over = 1.0;
            for (int i = 0; i < 8; ++i)
                for (int j = 0; j < 8; ++j)
                    over += point.scale * point.y[i] * (of_lane(G(i, j), l) - point.own(i, j)) * point.y[j];
            set_lane(scale, l, 1.0 / over);
            set_ends(G, l, point.own);
        }
        return scale;
    }

    // On the real axis Ḡ is what G is.
    void conjugate_on_axis(const Ends<R>& G) {
        for (int l = 0; l < count; ++l)
            for (int k = 0; k < 64 && points[l].kind == ContourPoint::ON_AXIS; ++k)
                set_lane(at.leads.conjugate[k / 8][k % 8], l, std::conj(of_lane(G(k / 8, k % 8), l)));
    }

    // All but what the derivatives by V say.
    void add_changes() const {
        C by[SUMS][COUNT];
        double per_meV = 1 / field.hop;
        auto minus_twice = [](C x) { return -(x + x); };
        for (int k = 0; k < COUNT; ++k) {
            const SiteSums<R>& s = sums[k];
            const auto& leads_do = drives[k].through_leads;
            auto pairing = [&](const C(&by)[2]) { return minus_twice(by[0] * s.one + by[1] * s.tau_x); };
            C onsite = at.terms.normal * s.one + at.terms.anomalous * s.tau_x - s.along * R(field.zeeman);
            C turned = s.across * R(2 * field.zeeman * field.angle_slope) + onsite * R(field.hop_slope);
            by[BY_ZEEMAN][k] = -minus_twice(s.along * R(per_meV));
            by[BY_ALPHA][k] = leads_do[LEAD_ALPHA] - minus_twice(turned);
            by[BY_GAMMA][k] = pairing(at.by_gamma);
            const C broadened(energy.re, energy.im + field.of.dissipation);  // of a common scale of Δ₀ and all energies:
            by[BY_DELTA0][k] = leads_do[LEAD_ENERGY] * energy + minus_twice(broadened * s.one) * R(per_meV);
            by[BY_LEAD_ZEEMAN][k] = leads_do[LEAD_ZEEMAN];
            C of_wire = pairing(at.by_energy);
            by[BY_DISSIPATION][k] = C(-of_wire.im, of_wire.re);
            C by_energy = leads_do[LEAD_ENERGY] + of_wire;
            by[BY_ENERGY][k] = by_energy * of_all, by[OF_LEVELS][k] = by_energy * of_levels;
        }
        for (int change = BY_ZEEMAN; change < BY_ENERGY; ++change)
            if (change != BY_DISSIPATION || COUNT == WITH_RETURNS) add_to_others(change, by[change]);
        add_to_others(BY_ENERGY, by[BY_ENERGY], -1.0);  // p(−ω) has the slope of the other sign, and
        add_to_others(OF_LEVELS, by[OF_LEVELS]);        // is shifted in the other sense
    }
};

}  // namespace detail

}  // namespace core
