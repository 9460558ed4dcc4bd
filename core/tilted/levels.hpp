// The levels of the isolated wire in a tilted field, from its ends' Green's function.
//
// Below the gap F(z) = Σ_n w_n w_n†/(z − E_n): rational but for the parent superconductor's continuum, which far
// levels stand for.  X(z) = (z − H)⁻¹e, the wire's answer to a source on the 8 entries of its ends, spans a space in which
// Rayleigh–Ritz gives H.  The matrix elements follow from F alone, at nodes z_k above the axis:
//
//     X_k†X_l = −(F_l − F_k†)/(z_l − z_k*),   X_k†H X_l = z_l X_k†X_l − F_k†,   e†X_l = F_l.
//
// (poles/levels.hpp does the same with slopes, at real energies, in a real frame that θ ≠ 0 takes away.)  In the basis of
// majorana.hpp H = iA with A real and antisymmetric, and X(−z*) = −X(z)*: the directions Re X_k and Im X_k have real matrix
// elements, for which X_kᵀ = −X(−z_k*)† gives
//
//     X_kᵀX_l = (F_l + F_kᵀ)/(z_l + z_k),   X_kᵀH X_l = z_l X_kᵀX_l − F_kᵀ.
//
// Tridiagonal, A couples even directions to odd ones alone, by a bidiagonal B: its singular values are the levels ±E, and
// w = (v ± iu)/√2, what the ends see of its right and left vectors.
#pragma once

#include "../poles/tridiagonal.hpp"
#include "bidiagonal.hpp"
#include "majorana.hpp"

namespace core {

using EndSquare = Complex<double>[8][8];

namespace detail {

// DROP in tilted fields.  Between the nodes F is then right to 1e-7 of its largest entry; with 1e-11 to 2e-6.
constexpr double DROP_TILTED = 1e-12;

// Eight complex numbers in a row.
struct ComplexColumns {
    Columns re, im;
};

class MajoranaDirections : public Reduction<ANTISYMMETRIC> {
    int nodes = 0;
    std::vector<Complex<double>> z, apart, together;  // 1/(z_l − z_k*) and 1/(z_l + z_k)
    Row scale, re, im, turned_re, turned_im;          // of F, and of its transpose

    // X_k†X_l and X_kᵀX_l, and −i times the same with H, between entry i of node k and all of node l.
    struct Products {
        ComplexColumns overlap, joined, energy, joined_energy;
    };
    Products products(int k, int i, int l) const {
        const Complex<double> with = apart[k * nodes + l], without = together[k * nodes + l], at = z[l];
        Columns re_l = Columns::load(&re[64 * l + 8 * i]), im_l = Columns::load(&im[64 * l + 8 * i]);
        Columns re_k = Columns::load(&turned_re[64 * k + 8 * i]), im_k = Columns::load(&turned_im[64 * k + 8 * i]);
        Columns re_less = re_k - re_l, im_less = -im_k - im_l, re_sum = re_l + re_k, im_sum = im_l + im_k;
        ComplexColumns overlap{re_less * with.re - im_less * with.im, re_less * with.im + im_less * with.re};
        ComplexColumns joined{re_sum * without.re - im_sum * without.im, re_sum * without.im + im_sum * without.re};
        auto energy = [&](const ComplexColumns& of, Columns im_rest) {  // −i(z_l · of − rest)
            Columns real = of.re * at.re - of.im * at.im - re_k, imaginary = of.re * at.im + of.im * at.re - im_rest;
            return ComplexColumns{imaginary, -real};
        };
        return {overlap, joined, energy(overlap, -im_k), energy(joined, im_k)};
    }

public:
    // Data at the nodes z, z.re and z.im > 0, in the basis of majorana.hpp.
    void make(const Complex<double>* at, const EndSquare* F, int count) {
        nodes = count;
        z.assign(at, at + nodes);
        apart.resize(size_t(nodes) * nodes), together.resize(size_t(nodes) * nodes);
        for (auto* part : {&re, &im, &turned_re, &turned_im}) part->resize(64 * size_t(nodes));
        for (int k = 0; k < nodes; ++k) {
            for (int l = 0; l < nodes; ++l) {
                apart[k * nodes + l] = inverse(Complex<double>(z[l].re - z[k].re, z[l].im + z[k].im));
                together[k * nodes + l] = inverse(Complex<double>(z[l].re + z[k].re, z[l].im + z[k].im));
            }
            for (int i = 0; i < 8; ++i)
                for (int j = 0; j < 8; ++j) {
                    size_t here = 64 * size_t(k) + 8 * i + j, there = 64 * size_t(k) + 8 * j + i;
                    re[here] = turned_re[there] = F[k][i][j].re, im[here] = turned_im[there] = F[k][i][j].im;
                }
        }
        scale.assign(16 * size_t(nodes), 1.0);
        for (int k = 0; k < nodes; ++k)
            for (int i = 0; i < 8; ++i) {
                auto [overlap, joined, energy, joined_energy] = products(k, i, k);
                scale[16 * k + i] = 1 / std::sqrt(0.5 * (joined.re[i] + overlap.re[i]));
                scale[16 * k + 8 + i] = 1 / std::sqrt(0.5 * (overlap.re[i] - joined.re[i]));
            }
        reduce(16 * nodes, *this, DROP_TILTED);
    }

    // Direction 16k + i is Re X_k of entry i, 16k + 8 + i is Im X_k.
    void row(int d, double* of_N, double* of_K) const {
        const int k = d / 16, i = d % 8;
        const bool imaginary = d % 16 >= 8;
        for (int l = 0; l < nodes; ++l) {
            const auto [overlap, joined, energy, joined_energy] = products(k, i, l);
            const double own = 0.5 * scale[d];
            Columns with_re = own * Columns::load(&scale[16 * l]), with_im = own * Columns::load(&scale[16 * l + 8]);
            auto write = [&](const ComplexColumns& plain, const ComplexColumns& turned, double* to) {
                Columns first = (imaginary ? turned.im - plain.im : turned.re + plain.re) * with_re;
                Columns second = (imaginary ? plain.re - turned.re : turned.im + plain.im) * with_im;
                first.store(to + 16 * l), second.store(to + 16 * l + 8);
            };
            write(overlap, joined, of_N);
            write(energy, joined_energy, of_K);
        }
    }

    void seen(int d, double* of_ends) const {
        const Row& part = d % 16 >= 8 ? turned_im : turned_re;
        for (int c = 0; c < 8; ++c) of_ends[c] = scale[d] * part[64 * size_t(d / 16) + 8 * (d % 8) + c];
    }
};

}  // namespace detail

// A level E ≥ 0 and what the ends see of it, w; of −E they see w*.
struct TiltedLevel {
    double E;
    Complex<double> w[8];
};

// The levels of a set, the lowest first, from F at nodes z above the axis; none if the data make no model.
inline std::vector<TiltedLevel> tilted_levels(const Complex<double>* z, const EndSquare* F, int nodes) {
    static thread_local detail::MajoranaDirections small;
    small.make(z, F, nodes);
    int half = small.rank / 2;
    Bidiagonal B(half);
    auto on_diagonal = [](int, double) {};  // where there is nothing
    tridiagonalise(small, on_diagonal, [&](int k, double value) {
        if (k % 2 == 0) B.diagonal[k / 2] = -value;
        else B.above[k / 2] = value;
    });
    for (int k = 0; k < half; ++k) {
        std::copy_n(&small.rows[16 * k], 8, &B.right[8 * k]);
        std::copy_n(&small.rows[16 * k + 8], 8, &B.left[8 * k]);
    }
    if (!diagonalise(B)) return {};
    std::vector<TiltedLevel> levels(half);
    for (int k = 0; k < half; ++k) {
        double sign = B.diagonal[k] < 0 ? -1.0 : 1.0;
        levels[k].E = sign * B.diagonal[k];
        for (int c = 0; c < 8; ++c)
            levels[k].w[c] = {std::sqrt(0.5) * B.right[8 * k + c], sign * std::sqrt(0.5) * B.left[8 * k + c]};
    }
    std::sort(levels.begin(), levels.end(), [](const TiltedLevel& a, const TiltedLevel& b) { return a.E < b.E; });
    return levels;
}

}  // namespace core
