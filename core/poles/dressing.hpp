// The isolated wire's ends and their leads at several complex energies at once.
//
// With the levels ±E of the isolated wire and what the ends see of them, U (levels.hpp),
//
//     G_iso(z) = U (z − E)⁻¹ Uᵀ,   S(z) = Σ(z)⁻¹,   M = S − G_iso,
//
// G_iso and S complex symmetric 8×8 in the chiral basis, S a cubic in the energy.  M carries all that the
// leads do: (z − H)⁻¹ = R + R Uᵀ M⁻¹ U R with R = (z − E)⁻¹, and G = S M⁻¹ S − S.  It is factored without
// pivots: its entries stay of order 1/Σ, also at the poles, because a level couples to the leads by the
// same U by which it stands in G_iso.
#pragma once

#include "../leads/self_energy.hpp"
#include "../wire/pivoted.hpp"
#include "chiral.hpp"
#include "levels.hpp"

namespace core {

constexpr int POLES = REGISTER;  // energies, or poles, that are worked on together
using PoleReal = Lanes<POLES>;
using PoleComplex = Complex<PoleReal>;
using Ends8 = std::array<PoleComplex, 8>;

constexpr int UPPER = 36;
// Where entry (i, j) of a symmetric matrix stands: C = ++ (10), −− (10), then +− (16).
constexpr int place(int i, int j) {
    int a = i < j ? i : j, b = i < j ? j : i;
    auto triangle = [](int p, int q) { return 4 * p - p * (p - 1) / 2 + q - p; };
    return b < 4 ? triangle(a, b) : a >= 4 ? 10 + triangle(a - 4, b - 4) : 20 + 4 * a + b - 4;
}
constexpr auto PLACES = [] {
    std::array<std::array<int, 8>, 8> at{};
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) at[i][j] = place(i, j);
    return at;
}();

// The levels as the sums here take them.
struct Levels {
    std::vector<double> E;
    std::vector<std::array<double, 8>> weight;        // of ±E: with C = +1, over √2, and C = −1
    std::vector<std::array<double, UPPER>> products;  // entries of w wᵀ, by PLACES

    explicit Levels(const LevelList& of) : E(of.size()), weight(of.size()), products(of.size()) {
        for (size_t n = 0; n < of.size(); ++n) {
            E[n] = of[n].E;
            for (int i = 0; i < 8; ++i) {
                weight[n][i] = std::sqrt(0.5) * of[n].w[i];
                for (int j = i; j < 8; ++j) products[n][PLACES[i][j]] = of[n].w[i] * of[n].w[j];
            }
        }
    }
    int size() const { return int(E.size()); }
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
};

// Invert an n×n matrix in place by Gauss–Jordan elimination with row pivoting.
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
};

// Values and slopes of a cubic at several energies: ten entries per end.
struct CubicValues {
    PoleComplex value[20], slope[20];

    void fill(const Cubic& cubic, PoleComplex z) {
        auto same = [](Amplitude x) { return PoleComplex(PoleReal(x.real()), PoleReal(x.imag())); };
        int at = 0;
        for (int end = 0; end < 2; ++end)
            for (int i = 0; i < 4; ++i)
                for (int j = i; j < 4; ++j, ++at) {
                    PoleComplex a = same(cubic.of[3][end][i][j]);
                    PoleComplex p = same(cubic.of[2][end][i][j]) + a * z;       // az + b
                    PoleComplex q = same(cubic.of[1][end][i][j]) + p * z;       // az² + bz + c
                    value[at] = same(cubic.of[0][end][i][j]) + q * z;
                    p = p + a * z;  // 2az + b
                    slope[at] = q + p * z;
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

// 1/(z ∓ E) of every level.
struct Resolvents {
    std::vector<PoleComplex> up, down;  // 1/(z − E), 1/(z + E)
    explicit Resolvents(int levels) : up(levels), down(levels) {}

    void fill(PoleComplex z, const std::vector<double>& E) {
        PoleReal square = z.im * z.im, minus = -z.im;
        for (size_t n = 0; n < E.size(); ++n) {
            PoleReal below = z.re - E[n], above = z.re + E[n];
            PoleReal near = inverse(square + below * below), far = inverse(square + above * above);
            up[n] = PoleComplex(below * near, minus * near);
            down[n] = PoleComplex(above * far, minus * far);
        }
    }
};

// M = S − G_iso = LΔLᵀ: L below the diagonal, at the places of the upper triangle, and 1/Δ.
struct DressedEnds {
    PoleComplex entry[UPPER], over[8];

    void fill(const Levels& levels, const Resolvents& R, const CubicValues& S) {
        for (int e = 0; e < UPPER; e += 4) {
            PoleComplex total[4] = {0.0, 0.0, 0.0, 0.0};
            for (int n = 0; n < levels.size(); ++n) {
                PoleComplex both = e < 20 ? R.up[n] + R.down[n] : R.up[n] - R.down[n];
                const double* product = &levels.products[n][e];
                for (int k = 0; k < 4; ++k) total[k] = total[k] + both * PoleReal(product[k]);
            }
            for (int k = 0; k < 4; ++k) entry[e + k] = -(total[k] * PoleReal(0.5));
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
        for (int i = 7; i >= 0; --i) {
            x[i] = x[i] * over[i];
            for (int k = i + 1; k < 8; ++k) x[i] = x[i] - entry[PLACES[i][k]] * x[k];
        }
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
