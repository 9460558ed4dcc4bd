// The wire with its leads solved by banded elimination with partial pivoting, one (μ, ω) at a time.
//
// Backward stable at every energy, hundreds of times slower than elimination.hpp: it takes what lost
// too many digits there, because the wire, or a piece of it, has a level at ω.
#pragma once

#include <vector>

#include "../leads/self_energy.hpp"
#include "wire.hpp"

namespace core {

struct ComplexTerms {
    double kinetic;
    Amplitude normal, anomalous;
};

struct EndMatrix {
    Amplitude entry[8][8];
    Amplitude& operator()(int i, int j) { return entry[i][j]; }
    const Amplitude& operator()(int i, int j) const { return entry[i][j]; }
};

// Σ of the channel sets of both leads on the ends' 8 entries.
inline EndMatrix on_the_ends(const LeadSelfEnergy& sigma) {
    EndMatrix M{};
    for (int c = 0; c < CHANNELS; ++c)
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) M(2 * c + i, 2 * c + j) = sigma.of[c](i, j);
    return M;
}

// target −= factor · row, in products that no test for NaN slows down.
inline void subtract_row(Amplitude* target, const Amplitude* row, int count, Amplitude factor) {
    double re = factor.real(), im = factor.imag();
    for (int j = 0; j < count; ++j) {
        double x = row[j].real(), y = row[j].imag();
        target[j] = {target[j].real() - (re * x - im * y), target[j].imag() - (re * y + im * x)};
    }
}

// Solve M X = unit vectors of the two end sites, and return X at all sites, (4·site, 8).
inline std::vector<Amplitude> pivoted_columns(const RotatedWire& wire, const ComplexTerms& of, const EndMatrix& sigma) {
    constexpr int BELOW = 7, WIDTH = 3 * BELOW + 1, RHS = 8;  // sub- and superdiagonals; pivoting doubles the latter
    int n = 4 * wire.sites();
    std::vector<Amplitude> band(size_t(n) * WIDTH), X(size_t(n) * RHS);
    auto at = [&](int i, int j) -> Amplitude& { return band[size_t(i) * WIDTH + (j - i + BELOW)]; };
    for (int site = 0; site < wire.sites(); ++site) {
        double q = of.kinetic + wire.V[site];
        Amplitude flip(wire.zeeman_x[site], -wire.zeeman_y);  // ⟨↑|xσx + yσy|↓⟩
        for (int i = 0; i < 4; ++i) {
            int row = 4 * site + i;
            double charge = i < 2 ? 1.0 : -1.0, spin = i % 2 == 0 ? 1.0 : -1.0;
            at(row, row) += of.normal - charge * q - spin * wire.zeeman_z[site];
            at(row, row + (i % 2 == 0 ? 1 : -1)) -= i % 2 == 0 ? flip : std::conj(flip);
            at(row, row + (i < 2 ? 2 : -2)) += of.anomalous;
            if (site > 0) at(row, row - 4) = charge;
            if (site < wire.sites() - 1) at(row, row + 4) = charge;
        }
    }
    auto row_of = [&](int i) { return i < 4 ? i : n - 8 + i; };
    for (int i = 0; i < 8; ++i) {
        X[size_t(row_of(i)) * RHS + i] = 1.0;
        for (int j = 0; j < 8; ++j)
            if (i / 4 == j / 4) at(row_of(i), row_of(j)) -= sigma(i, j);
    }
    constexpr double ROUNDING = 2.2e-16;  // of M; a pivot that vanishes is known no better
    for (int k = 0; k < n; ++k) {
        int last = std::min(n, k + BELOW + 1), end = std::min(n, k + 2 * BELOW + 1), pivot = k;
        for (int i = k + 1; i < last; ++i)
            if (std::norm(at(i, k)) > std::norm(at(pivot, k))) pivot = i;
        if (pivot != k) {
            for (int j = k; j < end; ++j) std::swap(at(k, j), at(pivot, j));
            for (int r = 0; r < RHS; ++r) std::swap(X[size_t(k) * RHS + r], X[size_t(pivot) * RHS + r]);
        }
        if (at(k, k) == 0.0) at(k, k) = ROUNDING;  // a level at ω of a wire whose leads are closed
        for (int i = k + 1; i < last; ++i) {
            Amplitude factor = at(i, k) / at(k, k);
            if (factor == 0.0) continue;
            subtract_row(&at(i, k) + 1, &at(k, k) + 1, end - k - 1, factor);
            subtract_row(&X[size_t(i) * RHS], &X[size_t(k) * RHS], RHS, factor);
        }
    }
    for (int i = n - 1; i >= 0; --i) {
        Amplitude* row = &X[size_t(i) * RHS];
        for (int j = i + 1; j < std::min(n, i + 2 * BELOW + 1); ++j) subtract_row(row, &X[size_t(j) * RHS], RHS, at(i, j));
        for (int r = 0; r < RHS; ++r) row[r] /= at(i, i);
    }
    return X;
}

// G of the two end sites, in units of 1/t'.
inline EndMatrix pivoted_ends(const RotatedWire& wire, const ComplexTerms& of, const EndMatrix& sigma) {
    std::vector<Amplitude> X = pivoted_columns(wire, of, sigma);
    EndMatrix G;
    int n = 4 * wire.sites();
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) G(i, j) = X[size_t(i < 4 ? i : n - 8 + i) * 8 + j];
    return G;
}

}  // namespace core
