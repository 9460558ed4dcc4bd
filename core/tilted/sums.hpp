// The isolated wire's ends in a tilted field, and their leads, at several complex energies at once, in the basis of
// majorana.hpp:
//
//     F(z) = Σ_n w w†/(z − E) + w* wᵀ/(z + E),   D = 1 − F Σ,   G = D⁻¹ F,   Σ(z) = iS + zS'.
//
// S and S' are real there, by particle–hole symmetry.  D is regular at the levels' energies but for rounding: what a
// level gives of F is divided by how far its pole is moved, which is what the leads see of it.
#pragma once

#include "../poles/dressing.hpp"
#include "../values/square8.hpp"
#include "levels.hpp"

namespace core {

using EndSquares = Square8<PoleComplex>;

// Σ, linear in the energy: iS + zS' of each end, in meV.
struct TiltedLeads {
    double fixed[2][4][4], slope[2][4][4];

    // Σ(0) and Σ', in the basis of majorana.hpp.
    TiltedLeads(const EndSquare& at_zero, const EndSquare& by_energy) {
        for (int end = 0; end < 2; ++end)
            for (int i = 0; i < 4; ++i)
                for (int j = 0; j < 4; ++j) {
                    fixed[end][i][j] = at_zero[4 * end + i][4 * end + j].im;
                    slope[end][i][j] = by_energy[4 * end + i][4 * end + j].re;
                }
    }
    PoleComplex at(PoleComplex z, int end, int i, int j) const {
        return {z.re * slope[end][i][j], PoleReal(fixed[end][i][j]) + z.im * slope[end][i][j]};
    }
    // −2 Im Σ as continued from the real axis, i(Σ(z) − Σ(z*)†).
    PoleComplex gamma_at(PoleComplex z, int end, int i, int j) const {
        double odd = slope[end][i][j] - slope[end][j][i], even = fixed[end][i][j] + fixed[end][j][i];
        return {PoleReal(-even) - z.im * odd, z.re * odd};
    }
};

namespace detail {

// The block of both ends where there is one.
template <class Block>
inline void fill_ends(EndSquares& M, Block block) {
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) M(i, j) = i / 4 == j / 4 ? block(i / 4, i % 4, j % 4) : PoleComplex(0.0);
}

// M S, with S the same at all energies or not, of both ends alone.
template <class Block>
inline EndSquares times_ends(const EndSquares& M, Block block) {
    EndSquares out;
    for (int end = 0; end < 2; ++end)
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 8; ++i) {
                PoleComplex total(0.0);
                for (int k = 0; k < 4; ++k) total = total + M(i, 4 * end + k) * block(end, k, j);
                out(i, 4 * end + j) = total;
            }
    return out;
}

inline EndSquares product(const EndSquares& A, const EndSquares& B) {
    EndSquares out;
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) {
            PoleComplex total(0.0);
            for (int k = 0; k < 8; ++k) total = total + A(i, k) * B(k, j);
            out(i, j) = total;
        }
    return out;
}

}  // namespace detail

// The levels as the sums here take them, and these sums at POLES energies.
class TiltedSums {
    std::vector<std::array<double, 64>> products;  // of w w†: real parts of the upper triangle, imaginary ones of the lower
    struct Shares {
        PoleComplex even, odd, even_slope, odd_slope;  // 1/(z − E) ± 1/(z + E), and minus their slopes
    };
    std::vector<Shares> shares;

public:
    std::vector<double> E;
    EndSquares F, slope;  // and dF/dz, of the levels that `fill` was called with

    explicit TiltedSums(const std::vector<TiltedLevel>& levels) : products(levels.size()), shares(levels.size()), E(levels.size()) {
        for (size_t n = 0; n < levels.size(); ++n) {
            E[n] = levels[n].E;
            const auto& w = levels[n].w;
            for (int i = 0; i < 8; ++i)
                for (int j = i; j < 8; ++j) {
                    products[n][8 * i + j] = w[i].re * w[j].re + w[i].im * w[j].im;
                    if (j > i) products[n][8 * j + i] = w[j].im * w[i].re - w[j].re * w[i].im;
                }
        }
    }

    // Of the levels from `first` on.
    void fill(PoleComplex z, int first = 0) {
        const int last = int(E.size());
        for (int n = first; n < last; ++n) {
            PoleComplex up = inverse(PoleComplex(z.re - E[n], z.im)), down = inverse(PoleComplex(z.re + E[n], z.im));
            PoleComplex up_slope = up * up, down_slope = down * down;
            shares[n] = {up + down, up - down, up_slope + down_slope, up_slope - down_slope};
        }
        for (int i = 0; i < 8; ++i)
            for (int j = i; j < 8; ++j) {
                PoleComplex real(0.0), imaginary(0.0), real_slope(0.0), imaginary_slope(0.0);
                for (int n = first; n < last; ++n) {
                    const PoleReal re = products[n][8 * i + j], im = j > i ? products[n][8 * j + i] : 0.0;
                    const Shares& of = shares[n];
                    real = real + of.even * re, real_slope = real_slope + of.even_slope * re;
                    imaginary = imaginary + of.odd * im, imaginary_slope = imaginary_slope + of.odd_slope * im;
                }
                // of the lower triangle the imaginary part is kept, minus that of the upper one
                imaginary = detail::times_i(imaginary), imaginary_slope = detail::times_i(imaginary_slope);
                F(i, j) = real - imaginary, F(j, i) = real + imaginary;
                slope(i, j) = imaginary_slope - real_slope, slope(j, i) = -real_slope - imaginary_slope;
            }
    }

    // Σ 1/(z − E) + 1/(z + E) of the first levels.
    PoleComplex resolvents(int count) const {
        PoleComplex total(0.0);
        for (int n = 0; n < count; ++n) total = total + shares[n].even;
        return total;
    }

    // D⁻¹ at z.
    EndSquares undressed(const TiltedLeads& leads, PoleComplex z) const {
        EndSquares D = detail::times_ends(F, [&](int end, int i, int j) { return leads.at(z, end, i, j); });
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8; ++j) D(i, j) = i == j ? PoleComplex(1.0) - D(i, j) : -D(i, j);
        return inverted(D);
    }
    // −dD/dz.
    EndSquares change(const TiltedLeads& leads, PoleComplex z) const {
        EndSquares found = detail::times_ends(slope, [&](int end, int i, int j) { return leads.at(z, end, i, j); });
        const EndSquares by_leads = detail::times_ends(F, [&](int end, int i, int j) { return PoleReal(leads.slope[end][i][j]); });
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8; ++j) found(i, j) = found(i, j) + by_leads(i, j);
        return found;
    }
};

// Tr AB.
inline PoleComplex trace(const EndSquares& A, const EndSquares& B) {
    PoleComplex total(0.0);
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) total = total + A(i, j) * B(j, i);
    return total;
}

}  // namespace core
