// Thermal averages of poles in closed form (S-I: convolution with −df/dω).
//
// For a pole below the real axis, closing the contour above gives
//
//     ∫ dω (−f'(ω − V))/(ω − z) = ψ₁(½ + i(z − V)/2πkT)/(2πi kT),   Im z < 0,
//
// with the trigamma function ψ₁.
#pragma once

#include "residues.hpp"

namespace core {

// ψ₁(z), Re z ≥ ½, to 1e-12, by recurrence and Stirling's series (DLMF 5.15.8).
template <class R>
inline Complex<R> trigamma(Complex<R> z) {
    constexpr double BERNOULLI[] = {-691.0 / 2730, 5.0 / 66, -1.0 / 30, 1.0 / 42, -1.0 / 30, 1.0 / 6};  // B₁₂ … B₂
    Complex<R> total(0.0);
    for (int k = 0; k < 8; ++k) {
        Complex<R> over = inverse(z);
        total = total + over * over;
        z.re = z.re + 1.0;
    }
    Complex<R> over = inverse(z), square = over * over, series(BERNOULLI[0]);
    for (int k = 1; k < 6; ++k) series = Complex<R>(BERNOULLI[k]) + series * square;
    series = Complex<R>(0.5) + over * series;
    return total + over + square * series;
}

// Add the averages of Σ 2 Re[r/(ω − z)] to out, shape (bias, 4).
inline void average_poles(const PoleTerms& terms, const std::vector<double>& bias, double kT, double* out) {
    double unit = 1.0 / (2 * std::numbers::pi * kT);
    for (size_t b = 0; b < bias.size(); ++b) {
        Columns total[4] = {0.0, 0.0, 0.0, 0.0};
        for (int first = 0; first < terms.count; first += COLUMNS)
            for (int hole = 0; hole < 2; ++hole) {
                double V = hole ? -bias[b] : bias[b];
                Columns x = Columns::load(&terms.x[first]), y = Columns::load(&terms.y[first]);
                Complex<Columns> psi = trigamma(Complex<Columns>(Columns(0.5) - y * unit, (x - V) * unit));
                for (int k = 0; k < 4; ++k) {
                    Columns re = Columns::load(&terms.re[hole][k][first]), im = Columns::load(&terms.im[hole][k][first]);
                    total[k] = total[k] + psi.im * re + psi.re * im;
                }
            }
        for (int k = 0; k < 4; ++k) out[4 * b + k] += 2 * unit * sum(total[k]);
    }
}

}  // namespace core
