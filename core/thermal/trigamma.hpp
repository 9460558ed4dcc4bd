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

// Add the averages of Σ 2 Re[r/(ω − z)] to out, shape (bias, 4), pole after pole.
inline void average_poles(const std::vector<Term>& terms, const std::vector<double>& bias, double kT, double* out) {
    double unit = 1.0 / (2 * std::numbers::pi * kT);
    for (size_t b = 0; b < bias.size(); ++b)
        for (int hole = 0; hole < 2; ++hole) {
            double V = hole ? -bias[b] : bias[b];
            for (size_t first = 0; first < terms.size(); first += POLES) {
                size_t some = std::min(size_t(POLES), terms.size() - first);
                PoleReal re{}, im{};
                for (size_t l = 0; l < POLES; ++l) {
                    const Term& term = terms[first + std::min(l, some - 1)];
                    re.set(int(l), term.z.real()), im.set(int(l), term.z.imag());
                }
                Complex<PoleReal> psi = trigamma(Complex<PoleReal>(PoleReal(0.5) - im * unit, (re - V) * unit));
                for (size_t l = 0; l < some; ++l) {
                    double kr = 2 * unit * psi.im[int(l)], ki = -2 * unit * psi.re[int(l)];
                    const Amplitude* r = terms[first + l].r[hole];
                    for (int k = 0; k < 4; ++k) out[4 * b + k] += kr * r[k].real() - ki * r[k].imag();
                }
            }
        }
}

}  // namespace core
