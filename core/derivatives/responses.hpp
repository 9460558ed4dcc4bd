// How the conductances answer to a change at the ends: of the wire's end blocks, and of the leads.
//
// With G = (M' − Σ)⁻¹ of the end sites, m = Γ_b G_ab† Γ_a and dG = −G (dM' − dΣ) G, the probability
// p_ab = Tr[G_ab m] of attach.hpp changes by
//
//     dp = −2 Re Tr[Y (dM' − dΣ)] + Tr[dΓ_a G_ab Γ_b G_ab†] + Tr[Γ_a G_ab dΓ_b G_ab†],
//
// Y = G_·b m G_a·.  For real dM' that is Tr[S dM'], S the symmetric part of −2 Re Y.  Where nothing is
// absorbed, the conductances at both signs of ω are sums of the probabilities between different
// channel sets, six by symmetry, and so are all derivatives: of these at one sign, or of all six.  Elsewhere there are ten.
#pragma once

#include "../leads/attach.hpp"

namespace core {

// The channel sets of the six probabilities, and of what goes back into the channels from which it comes: four more, which
// count where the wire or its parent absorbs.
constexpr int PROBABILITIES = 6, WITH_RETURNS = 10;
constexpr int FROM[WITH_RETURNS] = {0, 2, 0, 1, 0, 1, 0, 1, 2, 3}, TO[WITH_RETURNS] = {1, 3, 2, 3, 3, 2, 0, 1, 2, 3};

template <class R>
CORE_INLINE Conductances<R> conductances_of(const R (&p)[PROBABILITIES]) {
    R P[4][4];
    for (int a = 0; a < 4; ++a) P[a][a] = 0.0;
    for (int k = 0; k < PROBABILITIES; ++k) P[FROM[k]][TO[k]] = P[TO[k]][FROM[k]] = p[k];
    return lossless_conductances(P);
}

// The same, with P − N of each channel set after the six.
template <class R>
CORE_INLINE Conductances<R> conductances_of(const R (&p)[WITH_RETURNS]) {
    R P[4][4], net[4];
    for (int k = 0; k < PROBABILITIES; ++k) P[FROM[k]][TO[k]] = P[TO[k]][FROM[k]] = p[k];
    for (int a = 0; a < 4; ++a) net[a] = -p[PROBABILITIES + a];
    return conductances(P, net);
}

// The derivatives of both leads' Σ.
template <class R>
struct LeadSlopes {
    LaneLeads<R> by[2];  // B and α
};

// Of each quantity: S, off its diagonal twice, and the derivatives through the leads alone.
template <int COUNT, class R>
struct Responses {
    R S[36][COUNT];  // places of Symmetric8
    R through_leads[2][COUNT];
};

// What one probability drives: m, and from it what the leads contribute.
template <class R>
struct Drive {
    Complex<R> m[2][2], U[8][2];  // U = G_·b m
    R through_leads[2];
    int a;

    Drive(const Ends<R>& G, const LaneLeads<R>& leads, const LeadSlopes<R>& slopes, int a, int b) : a(a) {
        Complex<R> t[2][2];  // Γ_b G_ab†
        for (int q = 0; q < 2; ++q)
            for (int p = 0; p < 2; ++p)
                t[q][p] = conj(G(2 * a + p, 2 * b)) * leads.gamma(b, q, 0) + conj(G(2 * a + p, 2 * b + 1)) * leads.gamma(b, q, 1);
        for (int q = 0; q < 2; ++q)
            for (int p = 0; p < 2; ++p) m[q][p] = t[q][0] * leads.gamma(a, 0, p) + t[q][1] * leads.gamma(a, 1, p);
        for (int i = 0; i < 8; ++i)
            for (int p = 0; p < 2; ++p) U[i][p] = G(i, 2 * b) * m[0][p] + G(i, 2 * b + 1) * m[1][p];
        R after[2][2], before[2][2];  // Re G_ab Γ_b G_ab† and Re G_ab† Γ_a G_ab
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) {
                Complex<R> g = G(2 * a + i, 2 * b) * t[0][j] + G(2 * a + i, 2 * b + 1) * t[1][j];
                after[i][j] = g.re;
                before[i][j] = 0.0;
                for (int p = 0; p < 2; ++p)
                    for (int o = 0; o < 2; ++o) {
                        Complex<R> x = G(2 * a + p, 2 * b + i) * leads.gamma(a, p, o), y = G(2 * a + o, 2 * b + j);
                        before[i][j] = before[i][j] + x.re * y.re + x.im * y.im;
                    }
            }
        for (int by = 0; by < 2; ++by) {
            R answer = 0.0;
            for (int i = 0; i < 8; ++i)
                for (int j = i / 2 * 2; j < i / 2 * 2 + 2; ++j) {
                    Complex<R> y = Y(G, i, j), slope = slopes.by[by].of[i / 2][i % 2 + j % 2];
                    answer = answer + y.re * slope.re - y.im * slope.im;
                }
            answer = answer + answer;
            for (int i = 0; i < 2; ++i)
                for (int j = 0; j < 2; ++j)
                    answer = answer + slopes.by[by].gamma(a, i, j) * after[i][j] + slopes.by[by].gamma(b, i, j) * before[i][j];
            through_leads[by] = answer;
        }
    }

    CORE_INLINE Complex<R> Y(const Ends<R>& G, int i, int j) const { return U[i][0] * G(2 * a, j) + U[i][1] * G(2 * a + 1, j); }
};

// Those of the six probabilities.
template <class R>
inline Responses<PROBABILITIES, R> responses(const Ends<R>& G, const LaneLeads<R>& leads, const LeadSlopes<R>& slopes) {
    Responses<PROBABILITIES, R> found;
    for (int k = 0; k < PROBABILITIES; ++k) {
        Drive<R> drive(G, leads, slopes, FROM[k], TO[k]);
        for (int by = 0; by < 2; ++by) found.through_leads[by][k] = drive.through_leads[by];
        for (int i = 0; i < 8; ++i)
            for (int j = i; j < 8; ++j) {
                R y = drive.Y(G, i, j).re + drive.Y(G, j, i).re;
                found.S[Ends<R>::place(i, j)][k] = i == j ? -y : -(y + y);
            }
    }
    return found;
}

// Those of the four conductances at one sign of ω: −ω in lanes where `minus` is 1, not 0.
template <class R>
inline Responses<4, R> of_one_sign(const Responses<PROBABILITIES, R>& of, R minus) {
    Responses<4, R> found;
    auto pick = [&](const R (&p)[PROBABILITIES], R (&to)[4]) {
        Conductances<R> G = conductances_of(p);
        for (int k = 0; k < 4; ++k) to[k] = where_greater(minus, R(0.5), G.at[1][k], G.at[0][k]);
    };
    for (int place = 0; place < 36; ++place) pick(of.S[place], found.S[place]);
    for (int by = 0; by < 2; ++by) pick(of.through_leads[by], found.through_leads[by]);
    return found;
}

}  // namespace core
