// Where the poles of the wire with its leads are looked for.
//
// The levels near the window with the self-energy that the leads and the far levels make of them,
// UᵀΣ(1 − G_bg Σ)⁻¹U = Uᵀ(S − G_bg)⁻¹U at one energy, its strongest mixings rotated away by Jacobi's
// rotations: the levels of a tunnel-coupled wire are shifted and mixed little by its leads, and what is
// small is left to the iteration that follows.  Only poles with Re z ≥ 0 are wanted, see resonances.hpp.
#pragma once

#include "dressing.hpp"

namespace core {

constexpr double NEAR = 1.15;        // levels up to so many windows are poles
constexpr double INVISIBLE = 1e-10;  // levels of less coupling t'|u|² (meV) carry no conductance
constexpr double ON_AXIS = 1e-7;     // starting values with |Re z| below this (meV) would stay on the imaginary axis
constexpr double CENTRE = 1e-3;      // starting values this near the imaginary axis (meV) may end on it, from either side
constexpr double ASIDE = 0.1;        // starts on the axis are moved off it by this part of their width, to either side
constexpr double MIXING = 0.1;       // off-diagonal entries below this part of the levels' distance are not rotated away

// A pole z with its vector: G ≈ v vᵀ/(ω − z), v = S t/√norm.
struct Pole {
    Amplitude z, norm = 1.0, t[8] = {};
    std::vector<double> x;  // (4, level), over +E and over −E: re, im, re, im
};

namespace detail {

inline double coupling(const Level& level) { return square(level.w, 8); }

// (S − G_bg)⁻¹ at ω, G_bg what levels other than the near ones leave of G.
inline EndMatrix dressed_leads(double omega, const double (&G)[8][8], const LevelList& levels,
                               const std::vector<int>& near, const Leads& leads) {
    EndMatrix out = leads.inverse.at(omega);
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) {
            double rest = G[i][j];
            for (int n : near) {
                double common = 1.0 / (omega * omega - levels[n].E * levels[n].E);
                double factor = ((i < 4) == (j < 4) ? omega : levels[n].E) * common;
                rest -= factor * levels[n].w[i] * levels[n].w[j];
            }
            out(i, j) -= rest;
        }
    invert(out.entry);
    return out;
}

// A complex symmetric matrix and rows that are rotated along, n×n each.
struct NearlyDiagonal {
    int n;
    std::vector<double> re, im, rows_re, rows_im;
    explicit NearlyDiagonal(int n) : n(n), re(size_t(n) * n), im(re), rows_re(re), rows_im(re) {
        for (int k = 0; k < n; ++k) rows_re[size_t(k) * n + k] = 1.0;
    }
    Amplitude at(int i, int j) const { return {re[size_t(i) * n + j], im[size_t(i) * n + j]}; }
    void set(int i, int j, Amplitude value) { re[size_t(i) * n + j] = value.real(), im[size_t(i) * n + j] = value.imag(); }

    // Replace rows p and q by c·p − s·q and s·p + c·q.
    static void rotate(double* re, double* im, int n, int p, int q, Amplitude c, Amplitude s) {
        double cr = c.real(), ci = c.imag(), sr = s.real(), si = s.imag();
        double *pr = re + size_t(p) * n, *pi = im + size_t(p) * n, *qr = re + size_t(q) * n, *qi = im + size_t(q) * n;
        for (int j = 0; j < n; ++j) {
            double a = pr[j], b = pi[j], d = qr[j], e = qi[j];
            pr[j] = cr * a - ci * b - sr * d + si * e, pi[j] = cr * b + ci * a - sr * e - si * d;
            qr[j] = sr * a - si * b + cr * d - ci * e, qi[j] = sr * b + si * a + cr * e + ci * d;
        }
    }

    // Rotate until every off-diagonal entry is below MIXING times the distance of its levels.
    void diagonalise() {
        constexpr int SWEEPS = 12;
        bool rotated = true;
        for (int sweep = 0; sweep < SWEEPS && rotated; ++sweep) {
            rotated = false;
            for (int p = 0; p < n - 1; ++p)
                for (int q = p + 1; q < n; ++q) {
                    Amplitude off = at(p, q), apart = at(q, q) - at(p, p);
                    double size = std::norm(off);
                    if (size <= MIXING * MIXING * std::norm(apart) || size < 1e-40) continue;
                    rotated = true;
                    Amplitude zeta = apart / (2.0 * off), root = std::sqrt(zeta * zeta + 1.0);
                    Amplitude t = 1.0 / (std::abs(zeta + root) > std::abs(zeta - root) ? zeta + root : zeta - root);
                    Amplitude c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
                    Amplitude hp = at(p, p) - t * off, hq = at(q, q) + t * off;
                    rotate(re.data(), im.data(), n, p, q, c, s);
                    rotate(rows_re.data(), rows_im.data(), n, p, q, c, s);
                    set(p, p, hp), set(q, q, hq), set(p, q, 0.0), set(q, p, 0.0);
                    for (int i = 0; i < n; ++i)
                        if (i != p && i != q) set(i, p, at(p, i)), set(i, q, at(q, i));
                }
        }
    }
};

// The Hamiltonian of the near levels +E, then −E, with the part of Σ̃ without slope.  Between the
// chiralities Σ̃(−ω) = Σ̃(ω)*, within them −Σ̃(ω)*: the real part of the one and the imaginary part of
// the other have no slope at ω = 0.
inline NearlyDiagonal mixed_levels(const LevelList& levels, const std::vector<int>& near, const EndMatrix& dressed) {
    int count = int(near.size()), n = 2 * count;
    NearlyDiagonal H(n);
    std::vector<double> u(8 * count), within(8 * count), first(4 * count), second(4 * count);
    for (int k = 0; k < count; ++k)
        for (int i = 0; i < 8; ++i) u[8 * k + i] = std::sqrt(0.5) * levels[near[k]].w[i];
    for (int k = 0; k < count; ++k) {
        const double* a = &u[8 * k];
        for (int i = 0; i < 8; ++i) {
            double total = 0.0;
            for (int j = 0; j < 4; ++j) {
                int at = i < 4 ? j : 4 + j;
                total += dressed(i, at).imag() * a[at];
            }
            within[8 * k + i] = total;
        }
        for (int j = 0; j < 4; ++j) {
            double left = 0.0, right = 0.0;  // aᵀ_k Z and (Z b_k)ᵀ
            for (int i = 0; i < 4; ++i) {
                left += a[i] * dressed(i, 4 + j).real();
                right += dressed(j, 4 + i).real() * a[4 + i];
            }
            first[4 * k + j] = left, second[4 * k + j] = right;
        }
    }
    for (int k = 0; k < count; ++k)
        for (int m = 0; m < count; ++m) {
            const double* b = &u[8 * m];
            double same[2] = {0.0, 0.0}, other[2] = {0.0, 0.0};
            for (int i = 0; i < 4; ++i) {
                same[0] += within[8 * k + i] * b[i], same[1] += within[8 * k + 4 + i] * b[4 + i];
                other[0] += first[4 * k + i] * b[4 + i], other[1] += second[4 * k + i] * b[i];
            }
            double even = same[0] + same[1], odd = same[0] - same[1];
            double sum = other[0] + other[1], difference = other[1] - other[0], E = k == m ? levels[near[k]].E : 0.0;
            H.set(k, m, {sum + E, even}), H.set(count + k, count + m, {-sum - E, even});
            H.set(k, count + m, {difference, odd}), H.set(count + k, m, {-difference, odd});
        }
    return H;
}

}  // namespace detail

struct Starts {
    std::vector<Pole> poles;  // in the right half plane and close to the imaginary axis
    int both;                 // how many there are in both halves
};

// Approximate poles from G of the isolated wire at one energy ω.
inline Starts start_poles(double omega, const double (&G)[8][8], double window, double hop, const LevelList& levels,
                          const Leads& leads) {
    std::vector<int> near;
    for (int n = 0; n < int(levels.size()); ++n)
        if (levels[n].E < NEAR * window && hop * detail::coupling(levels[n]) > INVISIBLE) near.push_back(n);
    auto H = detail::mixed_levels(levels, near, detail::dressed_leads(omega, G, levels, near, leads));
    H.diagonalise();
    Starts starts{{}, H.n};
    int count = int(near.size()), size = int(levels.size()), centred = 0;
    for (int k = 0; k < H.n; ++k) {
        Amplitude z = H.at(k, k);
        if (!(z.real() > -CENTRE)) continue;
        z.imag(std::min(z.imag(), -1e-16));
        if (std::abs(H.at(k, k).real()) <= ON_AXIS) {  // on the axis the iteration would stay on it
            double side = centred % 2 == 0 ? 1.0 : -1.0;
            z += side * ASIDE * std::abs(H.at(k, k).imag());
            ++centred;
        }
        Pole pole;
        pole.z = z;
        pole.x.assign(4 * size_t(size), 0.0);
        for (int m = 0; m < count; ++m)
            for (int half = 0; half < 2; ++half) {
                size_t from = size_t(k) * H.n + half * count + m;
                pole.x[(2 * half) * size + near[m]] = H.rows_re[from];
                pole.x[(2 * half + 1) * size + near[m]] = H.rows_im[from];
            }
        starts.poles.push_back(pole);
    }
    return starts;
}

}  // namespace core
