// What a change at each site does to up to six quantities, for V, μ, B and α at once.
//
// The rows of X_n of sweeps.hpp are turned to spin along (+) and against (−) the field at site n:
// e = e+, f = e−, g = h+, h = h−.  V then is the form ee' + ff' − gg' − hh' of each two columns, and B
// twice u = ee' − hh' less that of V.  α changes t', in whose units all of A_n is measured, and turns
// the field: but for multiples of the forms of V and B it is λ + aτx + tσx, λ and a constant, t of the
// site.  A form of rank two does most of that,
//
//     aτx + tσx + tτz + aσz = ½(ρη' + ηρ'),   ρ = e + f + g − h,   η = t(e+f−g+h) + a(e−f+g+h),
//
// and λ is that of B plus twice n = ff' + hh'.  V alone is needed for every site: its forms are
// contracted with S at once, what is summed over sites only at the end.
#pragma once

#include "responses.hpp"
#include "sweeps.hpp"

namespace core {

// Sites of a block, for all of which sums and S are loaded once.
constexpr int BLOCK = 4;

// What a site has of its own, for all lanes.
struct SiteTurn {
    double tangent, sine;  // tan ½ψ and sin ψ of the turn ψ of its spin
    double t;              // twice the field times d(φn)/dα
    double weight;         // of its V in what α does
};

// One column of X_n.
template <class R>
struct Turned {
    R e, f, g, h, rho, eta;

    // By three shears.
    CORE_INLINE Turned(const Block4<R>& wave, int c, const SiteTurn& by, R a) : e(wave(0, c)), f(wave(1, c)), g(wave(2, c)), h(wave(3, c)) {
        e = e + by.tangent * f, g = g + by.tangent * h;
        f = f - by.sine * e, h = h - by.sine * g;
        e = e + by.tangent * f, g = g + by.tangent * h;
        R k = e + f, m = g - h;
        rho = k + m;
        eta = by.t * (k - m) + a * ((e + g) + (h - f));
    }
    Turned() = default;
};

// Sums over sites of u, of n and of ρη' + ηρ'.
template <class R>
struct Sums {
    R u[36] = {}, n[36] = {}, turned[36] = {};
};

// Add the tile of the columns i, i + 1 with j, j + 1, of a pair with itself (OWN) the upper triangle.
template <bool OWN, int SITES, class R>
CORE_INLINE void add_tile(const Turned<R> (&X)[SITES][8], int i, int j, Sums<R>& sums, R (&V)[36][SITES]) {
    constexpr auto place = Symmetric8<R>::place;
    R u[4], n[4], turned[4];
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
        int at = place(i + k / 2, j + k % 2);
        u[k] = sums.u[at], n[k] = sums.n[at], turned[k] = sums.turned[at];
    }
#pragma GCC unroll 4
    for (int m = 0; m < SITES; ++m) {
        auto add = [&](const Turned<R>* x, const Turned<R>* y) __attribute__((always_inline)) {
#pragma GCC unroll 4
            for (int k = 0; k < 4; ++k) {
                if (OWN && k == 2) continue;
                const Turned<R>&l = x[k / 2], &r = y[k % 2];
                R own = l.e * r.e - l.h * r.h;
                V[place(i + k / 2, j + k % 2)][m] = own + l.f * r.f - l.g * r.g;
                u[k] = u[k] + own;
                n[k] = n[k] + l.f * r.f + l.h * r.h;
                turned[k] = turned[k] + l.rho * r.eta + l.eta * r.rho;
            }
        };
        if constexpr (REGISTER < 8) {
            add(X[m] + i, X[m] + j);
        } else {  // there are registers to hold them in
            const Turned<R> left[2] = {X[m][i], X[m][i + 1]}, right[2] = {X[m][j], X[m][j + 1]};
            add(left, right);
        }
    }
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
        if (OWN && k == 2) continue;
        int at = place(i + k / 2, j + k % 2);
        sums.u[at] = u[k], sums.n[at] = n[k], sums.turned[at] = turned[k];
    }
}

// Tr[S F] of all sites of a block and GROUP quantities from `first` on.
template <int GROUP, int COUNT, int SITES, class R>
CORE_INLINE void trace(const Responses<COUNT, R>& of, const R (&V)[36][SITES], int first, R (&found)[SITES][COUNT]) {
    R sum[GROUP][SITES] = {};
    for (int at = 0; at < 36; ++at)
#pragma GCC unroll 6
        for (int k = 0; k < GROUP; ++k)
#pragma GCC unroll 4
            for (int m = 0; m < SITES; ++m) sum[k][m] = sum[k][m] + of.S[at][first + k] * V[at][m];
    for (int k = 0; k < GROUP; ++k)
        for (int m = 0; m < SITES; ++m) found[m][first + k] = sum[k][m];
}

// The derivatives of COUNT quantities.
template <int COUNT, class R>
struct Contraction {
    static constexpr int GROUP = REGISTER < 8 ? 2 : COUNT;  // as many as there are registers for
    const Site<R>* sites;
    const SiteTurn* turns;
    int last;
    const Responses<COUNT, R>& of;
    R a;
    R (*traces)[COUNT];  // of each site
    Block4<R> Q;
    Sums<R> sums;
    R total[COUNT] = {}, weighted[COUNT] = {};

    // The sites top, top − 1, ...
    template <int SITES>
    void add(int top) {
        Turned<R> X[SITES][8];
        R V[36][SITES], found[SITES][COUNT];
        for (int m = 0; m < SITES; ++m) {
            int n = top - m;
            Q = n == last ? unit<R>(1.0) : n == 0 ? unit<R>(0.0) : carried(sites[n].left, Q);
            for (int c = 0; c < 4; ++c) {
                X[m][c] = Turned<R>(sites[n].P, c, turns[n], a);
                X[m][4 + c] = Turned<R>(Q, c, turns[n], a);
            }
        }
#pragma GCC unroll 4
        for (int j = 0; j < 8; j += 2) {
#pragma GCC unroll 4
            for (int i = 0; i < j; i += 2) add_tile<false>(X, i, j, sums, V);
            add_tile<true>(X, j, j, sums, V);
        }
        for (int first = 0; first < COUNT; first += GROUP) trace<GROUP>(of, V, first, found);
        for (int m = 0; m < SITES; ++m)
            for (int k = 0; k < COUNT; ++k) {
                traces[top - m][k] = found[m][k];
                total[k] = total[k] + found[m][k];
                weighted[k] = weighted[k] + turns[top - m].weight * found[m][k];
            }
    }

    void add_all() {
        int top = last;
        for (; top >= BLOCK - 1; top -= BLOCK) add<BLOCK>(top);
        for (; top >= 0; --top) add<1>(top);
    }

    // Of one quantity, what all sites do: through the field, n, and the form of ρ and η.
    CORE_INLINE void summed(int k, R& field, R& n, R& turned) const {
        R u = 0.0;
        n = turned = 0.0;
        for (int at = 0; at < 36; ++at) {
            R S = of.S[at][k];
            u = u + S * sums.u[at], n = n + S * sums.n[at], turned = turned + S * sums.turned[at];
        }
        field = 2.0 * u - total[k], turned = 0.5 * turned;
    }
};

}  // namespace core
