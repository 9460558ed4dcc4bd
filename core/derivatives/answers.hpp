// How probabilities answer at one point of the contour (contour.hpp), up to the weight of the point.
//
// A change of the wire gives −2 Tr[∂M Q_ab], a change of the leads
//
//     2 Tr[∂Σ Q_ab] + Tr[∂Γ_a G_ab Γ_b Ḡ_ba] + Tr[Γ_a G_ab ∂Γ_b Ḡ_ba],
//
// and as Q_ab = G_·b m G_a· is of rank two, Tr[A Q_ab] is the sum over both q of yᵀ A u, y = G_aq· and u = G_·b m; at a
// pole Q_ab is of rank one.
//
// Where levels are broadened by Γ_d, what comes in and does not go back is N − P_aa = −2 Im Tr Γ_a G_aa − p_aa, in which the
// first term has no pole above the real axis.  P_aa − N changes as p_aa does with Γ_a Ḡ_aa Γ_a − iΓ_a for m, and −2i G_aa
// beside what ∂Γ_a is multiplied with.
#pragma once

#include "columns.hpp"
#include "contour.hpp"
#include "responses.hpp"

namespace core {

enum LeadChange { LEAD_ZEEMAN, LEAD_ALPHA, LEAD_ENERGY };
constexpr int LEAD_CHANGES = 3;

// What the leads and Ḡ are at the points of some lanes, continued to complex energies.
template <class R>
struct LeadsAt {
    using C = Complex<R>;
    LaneLeads<R> sigma;
    C gamma[CHANNELS][3];
    C slope[LEAD_CHANGES][CHANNELS][3], gamma_slope[LEAD_CHANGES][CHANNELS][3];
    C conjugate[8][8], v[8];  // v of poles alone

    void set(int lane, const ContourPoint& at, const ContinuedLead& leads, const ContinuedLead (&slopes)[LEAD_CHANGES]) {
        for (int c = 0; c < CHANNELS; ++c)
            for (int e = 0; e < 3; ++e) {
                set_lane(sigma.of[c][e], lane, leads.sigma(at.z, c, e)), set_lane(gamma[c][e], lane, leads.gamma(at.z, c, e));
                for (int by = 0; by < LEAD_CHANGES; ++by) {
                    set_lane(slope[by][c][e], lane, slopes[by].sigma(at.z, c, e));
                    set_lane(gamma_slope[by][c][e], lane, slopes[by].gamma(at.z, c, e));
                }
            }
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8; ++j) set_lane(conjugate[i][j], lane, at.conjugate(i, j));
        for (int i = 0; i < 8; ++i) set_lane(v[i], lane, at.v[i]);
    }
};

// What drives one probability, from a to b.
template <class R>
struct DriveAt {
    using C = Complex<R>;
    C m[2][2];
    C through_leads[LEAD_CHANGES];

    // `linear` is 1 where P_aa − N is meant for a = b, on the line; of a residue it is 0.
    void fill(const Ends<R>& G, const LeadsAt<R>& leads, int a, int b, double linear = 0.0) {
        C t[2][2], r[2][2], after[2][2], before[2][2];  // Γ_b Ḡ_ba, Ḡ_ba Γ_a, G_ab Γ_b Ḡ_ba and Ḡ_ba Γ_a G_ab
        auto H = [&](int p, int q) { return leads.conjugate[2 * b + p][2 * a + q]; };
        const auto &of_a = leads.gamma[a], &of_b = leads.gamma[b];
        for (int p = 0; p < 2; ++p)
            for (int q = 0; q < 2; ++q) t[p][q] = of_b[p] * H(0, q) + of_b[p + 1] * H(1, q), r[p][q] = H(p, 0) * of_a[q] + H(p, 1) * of_a[q + 1];
        for (int p = 0; p < 2; ++p)
            for (int q = 0; q < 2; ++q) {
                m[p][q] = t[p][0] * of_a[q] + t[p][1] * of_a[q + 1];
                after[p][q] = G(2 * a + p, 2 * b) * t[0][q] + G(2 * a + p, 2 * b + 1) * t[1][q];
                before[p][q] = r[p][0] * G(2 * a, 2 * b + q) + r[p][1] * G(2 * a + 1, 2 * b + q);
            }
        if (linear != 0.0 && a == b)
            for (int p = 0; p < 2; ++p)
                for (int q = 0; q < 2; ++q) {
                    const C gamma = of_a[p + q], own = G(2 * a + p, 2 * a + q) * R(2.0);
                    m[p][q] = m[p][q] + C(gamma.im, -gamma.re), after[p][q] = after[p][q] + C(own.im, -own.re);
                }
        C Y[CHANNELS][3];  // of Q_ab at the ends, twice, the two entries off the diagonal together
        for (int c = 0; c < CHANNELS; ++c) {
            C block[2][2];
            for (int i = 0; i < 2; ++i) {
                C u[2];
                for (int q = 0; q < 2; ++q) u[q] = G(2 * c + i, 2 * b) * m[0][q] + G(2 * c + i, 2 * b + 1) * m[1][q];
                for (int j = 0; j < 2; ++j) block[i][j] = u[0] * G(2 * a, 2 * c + j) + u[1] * G(2 * a + 1, 2 * c + j);
            }
            Y[c][0] = block[0][0] + block[0][0], Y[c][2] = block[1][1] + block[1][1];
            Y[c][1] = block[0][1] + block[1][0];
            Y[c][1] = Y[c][1] + Y[c][1];
        }
        for (int by = 0; by < LEAD_CHANGES; ++by) {
            C total(0.0);
            for (int c = 0; c < CHANNELS; ++c)
                for (int e = 0; e < 3; ++e) total = total + leads.slope[by][c][e] * Y[c][e];
            const auto &da = leads.gamma_slope[by][a], &db = leads.gamma_slope[by][b];
            for (int p = 0; p < 2; ++p)
                for (int q = 0; q < 2; ++q) total = total + da[p + q] * after[p][q] + db[p + q] * before[p][q];
            through_leads[by] = total;
        }
    }
};

// What of Tr[A Q_ab] is summed over the sites, for the forms A that a change of the wire is made of, but for τz, of which
// each site's is kept.
template <class R>
struct SiteSums {
    using C = Complex<R>;
    C one, tau_x, along, across;  // the last times n

    SiteSums() : one(0.0), tau_x(0.0), along(0.0), across(0.0) {}
};

// Where the field of site n points, and n times that; the sign that τx has in the frame.
struct SiteFrame {
    double cosine, sine, n_cosine, n_sine, parity;
};

// Return Tr[τz Q_ab] of a site, Q_ab the sum of u yᵀ over RANK vectors, and add its part to the sums, if ALL are asked for.
template <int RANK, bool ALL, class R>
CORE_INLINE Complex<R> add_site(const SiteFrame& at, const Complex<R> (&us)[RANK][4], const Complex<R> (&ys)[RANK][4], SiteSums<R>& sums) {
    using C = Complex<R>;
    C own[4], flip, pair;
#pragma GCC unroll 2
    for (int q = 0; q < RANK; ++q) {
        const C(&u)[4] = us[q], (&y)[4] = ys[q];
        if (q == 0) {
#pragma GCC unroll 4
            for (int i = 0; i < 4; ++i) own[i] = u[i] * y[i];
            flip = u[0] * y[1] + u[1] * y[0] + u[2] * y[3] + u[3] * y[2];
            pair = u[0] * y[2] + u[2] * y[0] + u[1] * y[3] + u[3] * y[1];
        } else {
#pragma GCC unroll 4
            for (int i = 0; i < 4; ++i) own[i] = own[i] + u[i] * y[i];
            flip = flip + u[0] * y[1] + u[1] * y[0] + u[2] * y[3] + u[3] * y[2];
            pair = pair + u[0] * y[2] + u[2] * y[0] + u[1] * y[3] + u[3] * y[1];
        }
    }
    C electrons = own[0] + own[1], holes = own[2] + own[3];
    if constexpr (!ALL) return electrons - holes;
    C along_z = (own[0] - own[1]) + (own[2] - own[3]);
    sums.one = sums.one + electrons + holes;
    sums.tau_x = sums.tau_x + pair * R(at.parity);
    sums.along = sums.along + flip * R(at.cosine) + along_z * R(at.sine);
    sums.across = sums.across + along_z * R(at.n_cosine) - flip * R(at.n_sine);
    return electrons - holes;
}

}  // namespace core
