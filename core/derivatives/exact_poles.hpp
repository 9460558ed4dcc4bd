// Poles of the wire with its leads, from the matrix itself; those of the model are where the search begins.
//
// By inverse iteration, M(z)x_new = x over all sites, and Newton's step for xᵀM(z)x, from z to z − xᵀM(z)x/xᵀM'x.  Near
// the pole G ≈ vvᵀ/(ω − z_k) with v = x/√(xᵀM'x) at the ends.  The ends alone do not tell levels that they hardly see
// from their neighbours.
#pragma once

#include "points.hpp"

namespace core {

constexpr int STEPS_TO_POLE = 5;           // at most
constexpr int FIRST_ITERATIONS = 3, FURTHER_ITERATIONS = 2;  // with the same z: in the first step, in all others
constexpr double MOST_OF_WAY = 0.5;        // a pole that moves by more than this many steps of the line is lost
constexpr double LAST_STEP = 1e-2;   // of the width, and of the way to the next pole: a pole that moves by less is there
constexpr double SAME_POLE = 1e-2;   // of the same: two that are nearer are one

namespace detail {

// Vectors over all sites in some lanes, and M⁻¹ of such.
class Vectors {
    using R = PointLanes::R;
    using C = PointLanes::C;
    std::vector<SiteColumns<R>>& sites;  // of which the pieces are D_n⁻¹
    std::vector<std::array<C, 4>> x, old;

    static std::array<C, 4> times_site(const Symmetric4<C>& D, const std::array<C, 4>& v) {
        std::array<C, 4> to;
        for (int i = 0; i < 4; ++i) to[i] = D(i, 0) * v[0] + D(i, 1) * v[1] + D(i, 2) * v[2] + D(i, 3) * v[3];
        return to;
    }

public:
    // y at the ends, and nothing elsewhere.
    Vectors(std::vector<SiteColumns<R>>& sites, const C (&y)[8]) : sites(sites), x(sites.size()), old(sites.size()) {
        for (auto& site : x) site.fill(C(0.0));
        for (int i = 0; i < 4; ++i)
            x.front()[i] = y[i], x.back()[i] = y[4 + i] * R(sign_at_the_end(int(sites.size()), i));
    }
    // x ← M⁻¹x in units of 1.
    void solve() {
        int last = int(x.size()) - 1;
        R norm = 0.0;
        std::swap(x, old);
        x[0] = old[0];
        for (int n = 1; n <= last; ++n) {
            x[n] = times_site(sites[n - 1].piece, x[n - 1]);
            for (int i = 0; i < 4; ++i) x[n][i] = x[n][i] + old[n][i];
        }
        for (int n = last; n >= 0; --n) {
            if (n < last)
                for (int i = 0; i < 4; ++i) x[n][i] = x[n][i] + x[n + 1][i];
            x[n] = times_site(sites[n].piece, x[n]);
            for (const C& entry : x[n]) norm = norm + square(entry);
        }
        R scale = inverse(root(norm));
        for (int n = 0; n <= last; ++n)
            for (int i = 0; i < 4; ++i) x[n][i] = x[n][i] * scale, old[n][i] = old[n][i] * scale;
    }
    // xᵀMx after a solution.
    C top() const {
        C sum(0.0);
        for (size_t n = 0; n < x.size(); ++n)
            for (int i = 0; i < 4; ++i) sum = sum + x[n][i] * old[n][i];
        return sum;
    }
    void ends(C (&to)[8]) const {
        for (int i = 0; i < 4; ++i) to[i] = x.front()[i], to[4 + i] = x.back()[i] * R(sign_at_the_end(int(x.size()), i));
    }
    // xᵀM'x.
    C slope(const GradientField& field, const PointLanes& at) const {
        C one(0.0), tau_x(0.0), of_ends[8];
        for (size_t n = 0; n < x.size(); ++n) {
            for (const C& entry : x[n]) one = one + entry * entry;
            C pair = x[n][0] * x[n][2] + x[n][1] * x[n][3];
            tau_x = tau_x + pair * R(2 * field.frames[n].parity);
        }
        C sum = at.by_energy[0] * one + at.by_energy[1] * tau_x;
        ends(of_ends);
        for (int c = 0; c < CHANNELS; ++c)
            for (int e = 0; e < 3; ++e) {
                C both = of_ends[2 * c + e / 2] * of_ends[2 * c + (e + 1) / 2];
                sum = sum - at.leads.slope[LEAD_ENERGY][c][e] * (e == 1 ? both + both : both);
            }
        return sum;
    }
};

// Bring up to REGISTER poles to those of the matrix; one that has an equal stays the model's, one that is lost is left out.
// Levels that the ends hardly see the model may have at a wrong place, and what they carry is as little.
inline void find_exact_poles(const GradientField& field, const Path& path, double mu, ContourPoint* points, int count, GradientRoom& room) {
    using C = PointLanes::C;
    std::vector<ContourPoint> now(points, points + count);
    std::vector<bool> done;
    for (const ContourPoint& point : now) done.push_back(point.isolation == 0.0);
    for (int l = 0; l < count; ++l)
        if (!done[l]) points[l].weight = 0.0;  // unless it is found
    C y[8];
    for (int l = 0; l < REGISTER; ++l)
        for (int i = 0; i < 8; ++i) set_lane(y[i], l, points[std::min(l, count - 1)].y[i]);
    Vectors vectors(room.sites, y);
    for (int step = 0; step < STEPS_TO_POLE && std::count(done.begin(), done.end(), false) > 0; ++step) {
        for (ContourPoint& point : now) point.z = point.pole;
        PointLanes at(field, mu, now.data(), count);
        const WireView wire = view(field.wire);
        eliminate_from_the_left(Sites<PointLanes::R>(wire, at.terms, at.leads.sigma), room.sites, [](int) {});
        for (int k = 0; k < (step == 0 ? FIRST_ITERATIONS : FURTHER_ITERATIONS); ++k) vectors.solve();
        C top = vectors.top(), slope = vectors.slope(field, at), ends[8];
        vectors.ends(ends);
        for (int l = 0; l < count; ++l) {
            if (done[l]) continue;
            ContourPoint& point = now[l];
            Amplitude shift = of_lane(top, l) / of_lane(slope, l), root = std::sqrt(of_lane(slope, l)), to = point.z - shift;
            done[l] = !(std::abs(to - points[l].pole) < MOST_OF_WAY * path.step) || !(to.imag() < 0);  // lost
            if (done[l]) continue;
            point.pole = to;
            for (int i = 0; i < 8; ++i) point.v[i] = std::conj(of_lane(ends[i], l) / root);
            point.set_residue();
            done[l] = std::abs(shift) < LAST_STEP * std::min(-to.imag(), point.isolation);
            if (done[l]) {
                point.moved = std::abs(to - points[l].pole);
                points[l] = point;
                points[l].kind = ContourPoint::POLE_OF_MATRIX;
                points[l].z = std::conj(to), points[l].weight = path.weight_of_pole(points[l].z);
                points[l].leave_out_if_narrow(field.of.dissipation);
            }
        }
    }
}

// Leave out poles that have come to where another one is.
inline void leave_out_twins(std::vector<ContourPoint>& points) {
    for (ContourPoint& one : points)
        for (ContourPoint& other : points) {
            bool both = one.kind == ContourPoint::POLE_OF_MATRIX && other.kind == ContourPoint::POLE_OF_MATRIX;
            if (!both || &one == &other || !(std::abs(one.z - other.z) < SAME_POLE * std::min(one.z.imag(), one.isolation))) continue;
            if (other.weight != 0.0 && one.moved > other.moved) one.weight = 0.0;
        }
}

}  // namespace detail

}  // namespace core
