// Which poles the wire with its leads has: none lost, none met twice.
//
// Particle–hole symmetry, G(−ω*) = −C G(ω)* C, pairs a pole z, v with −z*, C v*: only those with Re z ≥ 0
// are worked out.  Two poles meet on the imaginary axis and part along it; near there the iteration takes
// most care.
#pragma once

#include "iteration.hpp"

namespace core {

constexpr double EQUAL = 1e-4;   // poles nearer than this part of their width are one, of two vectors
constexpr double BESIDE = 0.1;   // the other pole on the axis is looked for off the one found, by this part of its width

namespace detail {

// x_kᵀ(1 − H')x_m.
inline Amplitude product(const Pole& k, const Pole& m, const Leads& leads) {
    size_t n = k.x.size() / 4;
    double re = 0.0, im = 0.0;
    const double *x = k.x.data(), *y = m.x.data();
    for (size_t j = 0; j < n; ++j) {
        re += x[j] * y[j] - x[n + j] * y[n + j] + x[2 * n + j] * y[2 * n + j] - x[3 * n + j] * y[3 * n + j];
        im += x[j] * y[n + j] + x[n + j] * y[j] + x[2 * n + j] * y[3 * n + j] + x[3 * n + j] * y[2 * n + j];
    }
    Amplitude total(re, im);
    EndMatrix slope = leads.inverse.slope_at(k.z);
    for (const auto& end : ENDS)
        for (int i : end)
            for (int j : end) total += k.t[i] * slope(i, j) * m.t[j];
    return total;
}

// Take the vector of `other` out of that of `pole`; return how much of it is left, as a share of its square.
inline double orthogonalise(Pole& pole, const Pole& other, const Leads& leads) {
    Amplitude overlap = product(pole, other, leads) / other.norm;
    size_t n = pole.x.size() / 4;
    double before = 0.0, after = 0.0;
    for (size_t part : {size_t(0), 2 * n})
        for (size_t m = part; m < part + n; ++m) {
            Amplitude own(pole.x[m], pole.x[n + m]), with(other.x[m], other.x[n + m]);
            before += std::norm(own);
            own -= overlap * with;
            after += std::norm(own);
            pole.x[m] = own.real(), pole.x[n + m] = own.imag();
        }
    for (int i = 0; i < 8; ++i) pole.t[i] -= overlap * other.t[i];
    pole.norm = product(pole, pole, leads);
    return after / before;
}

// Replace a pole by its mirror image −z*, of C v*: ±E change places, and t turns to −C t*.
inline void reflect(Pole& pole) {
    pole.z = -std::conj(pole.z);
    pole.norm = std::conj(pole.norm);
    size_t n = pole.x.size() / 4;
    for (size_t k = 0; k < n; ++k) {
        std::swap(pole.x[k], pole.x[2 * n + k]);
        double im = pole.x[n + k];
        pole.x[n + k] = -pole.x[3 * n + k], pole.x[3 * n + k] = -im;
    }
    for (int i = 0; i < 8; ++i) pole.t[i] = i < 4 ? -std::conj(pole.t[i]) : std::conj(pole.t[i]);
}

}  // namespace detail

struct Resonances {
    std::vector<Pole> poles;
    std::vector<int> order;  // those with mirror images, then those without
    int paired = 0;          // how many have images
    bool whole = false;      // whether none was lost, or met twice
};

namespace detail {

// Put the poles in order.  A pole in the left half stands for its mirror image; one that did not converge is
// left out: near the axis another's image may stand for it.  Vectors of equal poles (Kramers pairs at B = 0)
// are made orthogonal; one that is not new is left out: of these also return the last central one, and which
// it equals, or −1.
inline std::pair<int, int> right_half(Resonances& found, const Leads& leads) {
    int again = -1, twin = -1;
    found.order.clear();
    for (bool central : {false, true}) {
        for (int k = 0; k < int(found.poles.size()); ++k) {
            Pole& pole = found.poles[k];
            if ((std::abs(pole.z.real()) <= CENTRAL) != central || std::isnan(pole.norm.real())) continue;
            if (pole.z.real() < -CENTRAL) reflect(pole);
            double kept = 1.0, width = std::abs(pole.z.imag());
            for (int at : found.order) {
                bool faint = width < FAINT;  // it may stand twice: it carries nothing
                if (!faint && std::abs(found.poles[at].z - pole.z) < EQUAL * width) {
                    double left = orthogonalise(pole, found.poles[at], leads);
                    kept = std::min(kept, left);
                    if (central && !(kept > 0.1)) again = k, twin = at;
                }
            }
            if (kept > 0.1) found.order.push_back(k);
        }
        if (!central) found.paired = int(found.order.size());
    }
    return {again, twin};
}

}  // namespace detail

// Iterate the poles of `start_poles`.  Where two starts have ended at one pole of the imaginary axis, the
// other one is looked for on either side of it.
inline Resonances find_poles(const Starts& starts, const Leads& leads, Batch& batch) {
    Resonances found{starts.poles, {}};
    std::vector<int> all(found.poles.size());
    for (size_t k = 0; k < all.size(); ++k) all[k] = int(k);
    iterate(found.poles, all, leads, batch);
    auto [again, twin] = detail::right_half(found, leads);
    auto count = [&] { return found.paired + int(found.order.size()); };
    found.whole = count() == starts.both;
    if (found.whole || again < 0 || count() != starts.both - 1) return found;
    for (double side : {1.0 - BESIDE, 1.0 + BESIDE}) {
        Pole& pole = found.poles[again];
        pole.z = found.poles[twin].z * side;
        pole.x = starts.poles[again].x;
        for (auto& entry : pole.t) entry = 0.0;
        detail::orthogonalise(pole, found.poles[twin], leads);
        iterate(found.poles, {again}, leads, batch);
        detail::right_half(found, leads);
        found.whole = count() == starts.both;
        if (found.whole) break;
    }
    return found;
}

}  // namespace core
