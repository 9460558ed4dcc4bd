// The isolated wire's ends and their leads at several complex energies at once.
//
// With the levels ±E of the isolated wire and what the ends see of them, U (levels.hpp),
//
//     G_iso(z) = U (z − E)⁻¹ Uᵀ + G_far(z),   S(z) = Σ(z)⁻¹,   M = S − G_iso,
//
// all complex symmetric 8×8 in the chiral basis, S a cubic in the energy, and G_far, of the levels far outside
// the window, a polynomial (far.hpp).  M carries all that the leads do: (z − H)⁻¹ = R + R Uᵀ M⁻¹ U R with
// R = (z − E)⁻¹, and G = S M⁻¹ S − S.  It is factored without pivots: its entries stay of order 1/Σ, also at
// the poles, because a level couples to the leads by the same U by which it stands in G_iso.
#pragma once

#include "../leads/self_energy.hpp"
#include "../wire/pivoted.hpp"
#include "chiral.hpp"
#include "far.hpp"

namespace core {

constexpr int POLES = REGISTER;  // energies, or poles, that are worked on together
using PoleReal = Lanes<POLES>;
using PoleComplex = Complex<PoleReal>;
using Ends8 = std::array<PoleComplex, 8>;

// The levels as the sums here take them.
struct Levels {
    std::vector<double> E;
    std::vector<std::array<double, 8>> weight;        // of ±E: with C = +1, over √2, and C = −1
    std::vector<std::array<double, UPPER>> products;  // entries of w wᵀ, by PLACES
    FarLevels far;

    Levels(const LevelList& of, double window) : far(of, window) {
        E.reserve(of.size()), weight.reserve(of.size()), products.reserve(of.size());
        for (const Level& level : of)
            if (!far.takes(level)) {
                E.push_back(level.E);
                weight.emplace_back();
                for (int i = 0; i < 8; ++i) weight.back()[i] = std::sqrt(0.5) * level.w[i];
                products.push_back(products_of(level));
            }
    }
    int size() const { return int(E.size()); }
    double coupling(int n) const { return 2 * detail::square(weight[n].data(), 8); }
};

// A cubic in the energy of 4×4 blocks, one at each end: coefficients of 1, ω, ω², ω³.
struct Cubic {
    Amplitude of[4][2][4][4];

    EndMatrix at(Amplitude z) const {
        EndMatrix M{};
        for (int end = 0; end < 2; ++end)
            for (int i = 0; i < 4; ++i)
                for (int j = 0; j < 4; ++j) {
                    Amplitude value = of[3][end][i][j];
                    for (int power = 2; power >= 0; --power) value = value * z + of[power][end][i][j];
                    M(ENDS[end][i], ENDS[end][j]) = value;
                }
        return M;
    }
    EndMatrix slope_at(Amplitude z) const {
        EndMatrix M{};
        for (int end = 0; end < 2; ++end)
            for (int i = 0; i < 4; ++i)
                for (int j = 0; j < 4; ++j)
                    M(ENDS[end][i], ENDS[end][j]) =
                        of[1][end][i][j] + z * (2.0 * of[2][end][i][j] + 3.0 * z * of[3][end][i][j]);
        return M;
    }
    // The cubic of which the value at z is this one's at z + by.
    Cubic shifted(Amplitude by) const {
        Cubic found = *this;
        for (int round = 0; round < 3; ++round)
            for (int power = 2; power >= round; --power)
                for (int end = 0; end < 2; ++end)
                    for (int i = 0; i < 4; ++i)
                        for (int j = 0; j < 4; ++j) found.of[power][end][i][j] += by * found.of[power + 1][end][i][j];
        return found;
    }
};

// Invert an n×n matrix in place by Gauss–Jordan elimination with partial pivoting.
template <int n>
inline void invert(Amplitude (&M)[n][n]) {
    int order[n];
    for (int k = 0; k < n; ++k) {
        int pivot = k;
        for (int i = k + 1; i < n; ++i)
            if (std::abs(M[i][k]) > std::abs(M[pivot][k])) pivot = i;
        order[k] = pivot;
        if (pivot != k) std::swap(M[k], M[pivot]);
        Amplitude scale = 1.0 / M[k][k];
        M[k][k] = 1.0;
        for (int j = 0; j < n; ++j) M[k][j] *= scale;
        for (int i = 0; i < n; ++i) {
            if (i == k) continue;
            Amplitude factor = M[i][k];
            M[i][k] = 0.0;
            for (int j = 0; j < n; ++j) M[i][j] -= factor * M[k][j];
        }
    }
    for (int k = n - 1; k >= 0; --k)
        if (order[k] != k)
            for (int i = 0; i < n; ++i) std::swap(M[i][k], M[i][order[k]]);
}

// The leads around the window, chiral basis, in meV.
struct Leads {
    Cubic gamma, inverse, conjugate;  // Γ = −2 Im Σ, S = Σ⁻¹, S(z*)*

    // sigma: Σ at four energies, chiral; vandermonde: the inverse of these energies' Vandermonde matrix.
    Leads(const double (&vandermonde)[4][4], const EndMatrix (&sigma)[4]) : gamma{}, inverse{}, conjugate{} {
        for (int k = 0; k < 4; ++k)
            for (int end = 0; end < 2; ++end) {
                Amplitude block[4][4];
                for (int i = 0; i < 4; ++i)
                    for (int j = 0; j < 4; ++j) block[i][j] = sigma[k](ENDS[end][i], ENDS[end][j]);
                for (int power = 0; power < 4; ++power)
                    for (int i = 0; i < 4; ++i)
                        for (int j = 0; j < 4; ++j) gamma.of[power][end][i][j] -= 2 * vandermonde[power][k] * block[i][j].imag();
                invert(block);
                for (int power = 0; power < 4; ++power)
                    for (int i = 0; i < 4; ++i)
                        for (int j = 0; j < 4; ++j) inverse.of[power][end][i][j] += vandermonde[power][k] * block[i][j];
            }
        for (int power = 0; power < 4; ++power)
            for (int end = 0; end < 2; ++end)
                for (int i = 0; i < 4; ++i)
                    for (int j = 0; j < 4; ++j) conjugate.of[power][end][i][j] = std::conj(inverse.of[power][end][i][j]);
    }
    // The same as functions of the energy z + iΓ that a wire has whose levels are broadened; S(z*)* as one of z* + iΓ, conjugated.
    Leads broadened(double width) const {
        Leads found = *this;
        found.gamma = gamma.shifted({0, -width}), found.inverse = inverse.shifted({0, -width});
        found.conjugate = conjugate.shifted({0, width});
        return found;
    }
};

// Values of a cubic at several energies: ten entries per end.
struct CubicValues {
    PoleComplex value[20];

    void fill(const Cubic& cubic, PoleComplex z) {
        auto same = [](Amplitude x) { return PoleComplex(PoleReal(x.real()), PoleReal(x.imag())); };
        int at = 0;
        for (int end = 0; end < 2; ++end)
            for (int i = 0; i < 4; ++i)
                for (int j = i; j < 4; ++j, ++at) {
                    PoleComplex total = same(cubic.of[3][end][i][j]);
                    for (int power = 2; power >= 0; --power) total = same(cubic.of[power][end][i][j]) + total * z;
                    value[at] = total;
                }
    }
    // y = S x.
    void multiply(const Ends8& x, Ends8& y) const {
        for (int end = 0; end < 2; ++end)
            for (int i = 0; i < 4; ++i) {
                PoleComplex total(0.0);
                for (int j = 0; j < 4; ++j) total = total + value[10 * end + PLACES[i][j]] * x[ENDS[end][j]];
                y[ENDS[end][i]] = total;
            }
    }
};

// tᵀ S' t at z.
inline PoleComplex slope_between(const Cubic& cubic, const Ends8& t, PoleComplex z) {
    PoleComplex of[4] = {0.0, 0.0, 0.0, 0.0};
    for (int end = 0; end < 2; ++end)
        for (int i = 0; i < 4; ++i)
            for (int j = i; j < 4; ++j) {
                PoleComplex pair = t[ENDS[end][i]] * t[ENDS[end][j]];
                if (i != j) pair = pair + pair;
                for (int power = 1; power < 4; ++power) {
                    Amplitude c = cubic.of[power][end][i][j];
                    of[power] = of[power] + pair * PoleComplex(PoleReal(c.real()), PoleReal(c.imag()));
                }
            }
    PoleComplex twice = of[2] + of[2], thrice = of[3] + of[3] + of[3], rest = twice + thrice * z;
    return of[1] + rest * z;
}

// 1/(z ∓ E) of every level, and their sum and difference.
struct Resolvents {
    struct OfLevel {
        PoleComplex up, down, even, odd;  // 1/(z − E), 1/(z + E)
    };
    std::vector<OfLevel> of;
    explicit Resolvents(int levels) : of(levels) {}

    void fill(PoleComplex z, const std::vector<double>& E) {
        PoleReal square = z.im * z.im, minus = -z.im;
        for (size_t n = 0; n < E.size(); ++n) {
            PoleReal below = z.re - E[n], above = z.re + E[n];
            PoleReal near = square + below * below, far = square + above * above;
            PoleReal over = inverse(PoleReal(near * far)), over_near = far * over, over_far = near * over;
            PoleComplex up(below * over_near, minus * over_near), down(above * over_far, minus * over_far);
            of[n] = {up, down, up + down, up - down};
        }
    }
};

// M = S − G_iso = LΔLᵀ: L below the diagonal, at the places of the upper triangle, and 1/Δ.
struct DressedEnds {
    PoleComplex entry[UPPER], over[8];

    void fill(const Levels& levels, const Resolvents& R, const CubicValues& S, PoleComplex z) {
        levels.far.fill(z, entry);
        for (int e = 0; e < UPPER; e += 4) {
            PoleComplex total[4] = {0.0, 0.0, 0.0, 0.0};
            for (int n = 0; n < levels.size(); ++n) {
                const PoleComplex& both = e < SAME ? R.of[n].even : R.of[n].odd;
                const double* product = &levels.products[n][e];
                for (int k = 0; k < 4; ++k) total[k] = total[k] + both * PoleReal(product[k]);
            }
            for (int k = 0; k < 4; ++k) {
                PoleComplex all = entry[e + k] + total[k] * PoleReal(0.5);
                entry[e + k] = -all;
            }
        }
        int at = 0;
        for (int end = 0; end < 2; ++end)
            for (int i = 0; i < 4; ++i)
                for (int j = i; j < 4; ++j) entry[PLACES[ENDS[end][i]][ENDS[end][j]]] += S.value[at++];
        factor();
    }

    // x ← L⁻¹x.
    void solve_lower(Ends8& x) const {
        for (int i = 1; i < 8; ++i)
            for (int k = 0; k < i; ++k) x[i] = x[i] - entry[PLACES[k][i]] * x[k];
    }
    // x ← M⁻¹x.
    void solve(Ends8& x) const {
        solve_lower(x);
        for (int i = 0; i < 8; ++i) x[i] = x[i] * over[i];
        solve_upper(x);
    }
    // x ← L⁻ᵀx.
    void solve_upper(Ends8& x) const {
        for (int i = 7; i >= 0; --i)
            for (int k = i + 1; k < 8; ++k) x[i] = x[i] - entry[PLACES[i][k]] * x[k];
    }
    // start + xᵀM⁻¹y, given f = L⁻¹x and g = L⁻¹y.
    PoleComplex add_product(const Ends8& f, const Ends8& g, PoleComplex start) const {
        for (int i = 0; i < 8; ++i) start = start + PoleComplex(f[i] * g[i]) * over[i];
        return start;
    }

private:
    void factor() {
        for (int k = 0; k < 8; ++k) {
            over[k] = inverse(entry[PLACES[k][k]]);
            PoleComplex scaled[8];
            for (int i = k + 1; i < 8; ++i) scaled[i] = entry[PLACES[k][i]] * over[k];
            for (int i = k + 1; i < 8; ++i)
                for (int j = i; j < 8; ++j) entry[PLACES[i][j]] -= scaled[i] * entry[PLACES[k][j]];
            for (int i = k + 1; i < 8; ++i) entry[PLACES[k][i]] = scaled[i];
        }
    }
};

}  // namespace core
