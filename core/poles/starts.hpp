// Where the poles of the wire with its leads are looked for.
//
// The levels near the window with the self-energy that the leads and the far levels make of them,
// UᵀΣ(1 − G_bg Σ)⁻¹U = Uᵀ(S − G_bg)⁻¹U at one energy, its strongest mixings rotated away by Jacobi's
// rotations: the levels of a tunnel-coupled wire are shifted and mixed little by its leads, and what is
// small is left to the iteration that follows.  Only poles with Re z ≥ 0 are wanted, see resonances.hpp.
#pragma once

#include "dressing.hpp"

namespace core {

constexpr double INVISIBLE = 1e-10;  // levels of less coupling t'|u|² (meV) carry no conductance
constexpr double ON_AXIS = 1e-7;     // starting values with |Re z| below this (meV) would stay on the imaginary axis
constexpr double CENTRE = 1e-3;      // starting values this near the imaginary axis (meV) may end on it, from either side
constexpr double ASIDE = 0.1;        // starts on the axis are moved off it by this part of their width, to either side
constexpr double MIXING = 0.1;       // off-diagonal entries below this part of the levels' distance are not rotated away

// A pole z: G ≈ v vᵀ/(ω − z), v = S t/√norm.
struct Pole {
    Amplitude z, norm = 1.0, t[8] = {};
};

// The poles' vectors x over the levels +E, then −E, POLES next to each other.
class PoleVectors {
    int length = 0;
    std::vector<PoleComplex> entries;

public:
    PoleVectors(int poles, int levels)
        : length(2 * levels), entries(size_t((poles + POLES - 1) / POLES) * 2 * levels, PoleComplex(0.0)) {}
    int size() const { return length; }
    PoleComplex* block(int b) { return &entries[size_t(b) * length]; }
    Amplitude get(int pole, int k) const {
        const PoleComplex& of = entries[size_t(pole / POLES) * length + k];
        return of_lane(of, pole % POLES);
    }
    void set(int pole, int k, Amplitude value) {
        PoleComplex& of = entries[size_t(pole / POLES) * length + k];
        set_lane(of, pole % POLES, value);
    }
};

namespace detail {

// (S − G_bg)⁻¹ at ω, G_bg what levels other than the near ones leave of G.
inline Symmetric8<Complex<double>> dressed_leads(double omega, const double (&G)[8][8], const Levels& levels,
                                                 const std::vector<int>& near, const Leads& leads) {
    double rest[UPPER];
    for (int i = 0; i < 8; ++i)
        for (int j = i; j < 8; ++j) rest[PLACES[i][j]] = G[i][j];
    for (int n : near) {
        double E = levels.E[n], common = 1.0 / (omega * omega - E * E), same = omega * common, mixed = E * common;
        for (int e = 0; e < UPPER; ++e) rest[e] -= (e < SAME ? same : mixed) * levels.products[n][e];
    }
    EndMatrix S = leads.inverse.at(omega);
    Symmetric8<Complex<double>> M;
    for (int i = 0; i < 8; ++i)
        for (int j = i; j < 8; ++j) M(i, j) = {S(i, j).real() - rest[PLACES[i][j]], S(i, j).imag()};
    invert(M);
    return M;
}

// A complex symmetric matrix and rows that are rotated along, n×n each.
struct NearlyDiagonal {
    int n = 0, stride = 0;
    Row re, im, rows_re, rows_im, diagonal_re, diagonal_im;

    void resize(int size) {
        n = size, stride = padded(n);
        for (auto* matrix : {&re, &im, &rows_re, &rows_im}) matrix->resize(size_t(n) * stride);
        for (auto* diagonal : {&diagonal_re, &diagonal_im}) diagonal->resize(stride);
        for (auto* rows : {&rows_re, &rows_im}) std::fill(rows->begin(), rows->end(), 0.0);
        for (int k = 0; k < n; ++k) rows_re[place(k, k)] = 1.0;
    }
    size_t place(int i, int j) const { return size_t(i) * stride + j; }
    Amplitude at(int i, int j) const { return {re[place(i, j)], im[place(i, j)]}; }
    Amplitude row_entry(int i, int j) const { return {rows_re[place(i, j)], rows_im[place(i, j)]}; }
    void set(int i, int j, Amplitude value) { re[place(i, j)] = value.real(), im[place(i, j)] = value.imag(); }

    // Replace rows p and q by c·p − s·q and s·p + c·q.
    void rotate(Row& re, Row& im, int p, int q, Amplitude c, Amplitude s) const {
        Columns cr = c.real(), ci = c.imag(), sr = s.real(), si = s.imag();
        for (int j = 0; j < n; j += COLUMNS) {
            double *pr = &re[place(p, j)], *pi = &im[place(p, j)], *qr = &re[place(q, j)], *qi = &im[place(q, j)];
            Columns a = Columns::load(pr), b = Columns::load(pi), d = Columns::load(qr), e = Columns::load(qi);
            Columns new_pr = cr * a - ci * b - sr * d + si * e, new_pi = cr * b + ci * a - sr * e - si * d;
            Columns new_qr = sr * a - si * b + cr * d - ci * e, new_qi = sr * b + si * a + cr * e + ci * d;
            new_pr.store(pr), new_pi.store(pi), new_qr.store(qr), new_qi.store(qi);
        }
    }

    // Which of COLUMNS entries of row p from q on are to be rotated away.
    Columns strong(int p, int q) const {
        Columns off_re = Columns::load(&re[place(p, q)]), off_im = Columns::load(&im[place(p, q)]);
        Columns apart_re = Columns::load(&diagonal_re[q]) - diagonal_re[p], apart_im = Columns::load(&diagonal_im[q]) - diagonal_im[p];
        Columns size = off_re * off_re + off_im * off_im, apart = apart_re * apart_re + apart_im * apart_im;
        return where_greater(size, larger(Columns(MIXING * MIXING * apart), Columns(1e-40)), Columns(1.0), Columns(0.0));
    }

    void turn(int p, int q) {
        Amplitude off = at(p, q), hp = at(p, p), hq = at(q, q), zeta = (hq - hp) / (2.0 * off), root = std::sqrt(zeta * zeta + 1.0);
        Amplitude t = 1.0 / (std::norm(zeta + root) > std::norm(zeta - root) ? zeta + root : zeta - root);
        Amplitude c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
        rotate(re, im, p, q, c, s);
        rotate(rows_re, rows_im, p, q, c, s);
        set(p, p, hp - t * off), set(q, q, hq + t * off), set(p, q, 0.0), set(q, p, 0.0);
        for (int k : {p, q}) {
            diagonal_re[k] = re[place(k, k)], diagonal_im[k] = im[place(k, k)];
            for (int i = 0; i < n; ++i)
                if (i != p && i != q) re[place(i, k)] = re[place(k, i)], im[place(i, k)] = im[place(k, i)];
        }
    }

    // Rotate until every off-diagonal entry is below MIXING times the distance of its levels.
    void diagonalise() {
        constexpr int SWEEPS = 12;
        for (int k = 0; k < n; ++k) diagonal_re[k] = re[place(k, k)], diagonal_im[k] = im[place(k, k)];
        bool rotated = true;
        for (int sweep = 0; sweep < SWEEPS && rotated; ++sweep) {
            rotated = false;
            for (int p = 0; p < n - 1; ++p)
                for (int first = (p + 1) / COLUMNS * COLUMNS; first < n; first += COLUMNS) {
                    if (!(sum(strong(p, first)) > 0.0)) continue;
                    for (int q = std::max(p + 1, first); q < std::min(n, first + COLUMNS); ++q)
                        if (strong(p, first)[q - first] > 0.0) turn(p, q), rotated = true;
                }
        }
    }
};

// The Hamiltonian of the near levels +E, then −E, with the part of Σ̃ without slope.  Between the
// chiralities Σ̃(−ω) = Σ̃(ω)*, within them −Σ̃(ω)*: the real part of the one and the imaginary part of
// the other have no slope at ω = 0.
inline void mix_levels(const Levels& levels, const std::vector<int>& near, const Symmetric8<Complex<double>>& dressed,
                       NearlyDiagonal& H) {
    int count = int(near.size()), width = padded(count);
    H.resize(2 * count);
    Row u(8 * width), part(4 * width);  // (8, level); even, odd, sum, difference
    for (int m = 0; m < count; ++m)
        for (int i = 0; i < 8; ++i) u[i * width + m] = levels.weight[near[m]][i];
    for (int k = 0; k < count; ++k) {
        const auto& a = levels.weight[near[k]];
        double within[8]{}, across[8]{};  // Im Σ̃ a within a chirality, Re Σ̃ a from one to the other
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8; ++j)
                if ((i < 4) == (j < 4))
                    within[i] += dressed(i, j).im * a[j];
                else
                    across[i] += dressed(i, j).re * a[j];
        for (int m = 0; m < count; m += COLUMNS) {
            Columns same[2] = {0.0, 0.0}, other[2] = {0.0, 0.0};
            for (int i = 0; i < 8; ++i) {
                Columns b = Columns::load(&u[i * width + m]);
                same[i / 4] = same[i / 4] + within[i] * b;
                other[i / 4] = other[i / 4] + across[i] * b;
            }
            (same[0] + same[1]).store(&part[m]), (same[0] - same[1]).store(&part[width + m]);
            (other[1] + other[0]).store(&part[2 * width + m]), (other[0] - other[1]).store(&part[3 * width + m]);
        }
        const double *even = &part[0], *odd = even + width, *sum = odd + width, *difference = sum + width;
        for (int m = 0; m < count; ++m) {
            double E = k == m ? levels.E[near[k]] : 0.0;
            H.set(k, m, {sum[m] + E, even[m]}), H.set(count + k, count + m, {-sum[m] - E, even[m]});
            H.set(k, count + m, {difference[m], odd[m]}), H.set(count + k, m, {-difference[m], odd[m]});
        }
    }
}

}  // namespace detail

struct Starts {
    std::vector<Pole> poles;  // in the right half plane and close to the imaginary axis
    PoleVectors vectors;
    int both;               // how many there are in both halves
    std::vector<int> near;  // levels whose poles they are
};

// Approximate poles of the levels below a limit, from G of the isolated wire at one energy ω.
inline Starts start_poles(double omega, const double (&G)[8][8], double limit, double hop, const Levels& levels,
                          const Leads& leads) {
    std::vector<int> near;
    for (int n = 0; n < levels.size(); ++n)
        if (levels.E[n] < limit && hop * levels.coupling(n) > INVISIBLE) near.push_back(n);
    static thread_local detail::NearlyDiagonal H;
    detail::mix_levels(levels, near, detail::dressed_leads(omega, G, levels, near, leads), H);
    H.diagonalise();
    int count = int(near.size()), centred = 0;
    std::vector<int> right;
    for (int k = 0; k < H.n; ++k)
        if (H.at(k, k).real() > -CENTRE) right.push_back(k);
    Starts starts{{}, PoleVectors(int(right.size()), levels.size()), H.n, near};
    for (int k : right) {
        Pole pole;
        pole.z = H.at(k, k);
        pole.z.imag(std::min(pole.z.imag(), -1e-16));
        if (std::abs(H.at(k, k).real()) <= ON_AXIS) {  // on the axis the iteration would stay on it
            double side = centred % 2 == 0 ? 1.0 : -1.0;
            pole.z += side * ASIDE * std::abs(H.at(k, k).imag());
            ++centred;
        }
        for (int m = 0; m < count; ++m)
            for (int half = 0; half < 2; ++half)
                starts.vectors.set(int(starts.poles.size()), half * levels.size() + near[m], H.row_entry(k, half * count + m));
        starts.poles.push_back(pole);
    }
    return starts;
}

}  // namespace core
