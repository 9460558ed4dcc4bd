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

struct Resonances {
    std::vector<Pole> poles;
    PoleVectors vectors;
    std::vector<int> order;  // those with mirror images, then those without
    int paired = 0;          // how many have images
    bool whole = false;      // whether none was lost, or met twice
};

namespace detail {

// xᵀ(1 − H')y of poles k and m.
inline Amplitude product(const Resonances& of, int k, int m, const Levels& levels, const Leads& leads) {
    Amplitude total = 0.0;
    for (int n = 0; n < of.vectors.size(); ++n) total += of.vectors.get(k, n) * of.vectors.get(m, n);
    const Pole &x = of.poles[k], &y = of.poles[m];
    EndMatrix slope = leads.inverse.slope_at(x.z);
    for (const auto& end : ENDS)
        for (int i : end)
            for (int j : end) total += x.t[i] * slope(i, j) * y.t[j];
    using Z = Complex<double>;
    std::array<Z, 8> left, right;
    for (int i = 0; i < 8; ++i) left[i] = {x.t[i].real(), x.t[i].imag()}, right[i] = {y.t[i].real(), y.t[i].imag()};
    Z far = levels.far.slope_between(left, right, Z(x.z.real(), x.z.imag()));
    return total - Amplitude(far.re, far.im);
}

// Take the vector of pole m out of that of pole k; return how much of it is left, as a share of its square.
inline double orthogonalise(Resonances& of, int k, int m, const Levels& levels, const Leads& leads) {
    Pole& pole = of.poles[k];
    Amplitude overlap = product(of, k, m, levels, leads) / of.poles[m].norm;
    double before = 0.0, after = 0.0;
    for (int n = 0; n < of.vectors.size(); ++n) {
        Amplitude own = of.vectors.get(k, n);
        before += std::norm(own);
        own -= overlap * of.vectors.get(m, n);
        after += std::norm(own);
        of.vectors.set(k, n, own);
    }
    for (int i = 0; i < 8; ++i) pole.t[i] -= overlap * of.poles[m].t[i];
    pole.norm = product(of, k, k, levels, leads);
    return after / before;
}

// Replace pole k by its mirror image −z*, of C v*: ±E change places, and t turns to −C t*.
inline void reflect(Resonances& of, int k) {
    Pole& pole = of.poles[k];
    pole.z = -std::conj(pole.z);
    pole.norm = std::conj(pole.norm);
    for (int n = 0, half = of.vectors.size() / 2; n < half; ++n) {
        Amplitude up = of.vectors.get(k, n), down = of.vectors.get(k, half + n);
        of.vectors.set(k, n, std::conj(down)), of.vectors.set(k, half + n, std::conj(up));
    }
    for (int i = 0; i < 8; ++i) pole.t[i] = i < 4 ? -std::conj(pole.t[i]) : std::conj(pole.t[i]);
}

// Put the poles in order.  A pole in the left half stands for its mirror image; one that did not converge is
// left out: near the axis another's image may stand for it.  Vectors of equal poles (Kramers pairs at B = 0)
// are made orthogonal; one that is not new is left out: of these also return the last central one or, if there is
// none, the last, and which it equals, or −1.
inline std::pair<int, int> right_half(Resonances& found, const Levels& levels, const Leads& leads) {
    int again = -1, twin = -1;
    found.order.clear();
    for (bool central : {false, true}) {
        for (int k = 0; k < int(found.poles.size()); ++k) {
            Pole& pole = found.poles[k];
            if ((std::abs(pole.z.real()) <= CENTRAL) != central || std::isnan(pole.norm.real())) continue;
            if (pole.z.real() < -CENTRAL) reflect(found, k);
            double kept = 1.0, width = std::abs(pole.z.imag());
            for (int at : found.order) {
                bool faint = width < FAINT;  // it may stand twice: it carries nothing
                if (!faint && std::norm(found.poles[at].z - pole.z) < EQUAL * width * EQUAL * width) {
                    double left = orthogonalise(found, k, at, levels, leads);
                    kept = std::min(kept, left);
                    if (!(kept > 0.1)) again = k, twin = at;
                }
            }
            if (kept > 0.1) found.order.push_back(k);
        }
        if (!central) found.paired = int(found.order.size());
    }
    return {again, twin};
}

}  // namespace detail

// Iterate the poles of `start_poles`.  Where two starts have ended at one pole, the other one is looked for again: on the
// imaginary axis on either side of it, elsewhere from its start without the vector of the one found.
inline Resonances find_poles(const Starts& starts, const Levels& levels, const Leads& leads, Batch& batch) {
    Resonances found{starts.poles, starts.vectors, {}};
    std::vector<int> all(found.poles.size());
    for (size_t k = 0; k < all.size(); ++k) all[k] = int(k);
    iterate(found.poles, found.vectors, all, leads, batch);
    auto [again, twin] = detail::right_half(found, levels, leads);
    auto lost = [&] { return starts.both - found.paired - int(found.order.size()); };
    found.whole = lost() == 0;
    if (found.whole || again < 0) return found;
    bool central = std::abs(found.poles[twin].z.real()) <= CENTRAL;
    if (lost() != (central ? 1 : 2)) return found;
    const Amplitude there = found.poles[twin].z, here = starts.poles[again].z;
    for (Amplitude z : central ? std::array{there * (1.0 - BESIDE), there * (1.0 + BESIDE)} : std::array{here, 2.0 * here - there}) {
        Pole& pole = found.poles[again];
        pole.z = z;
        for (int n = 0; n < found.vectors.size(); ++n) found.vectors.set(again, n, starts.vectors.get(again, n));
        for (auto& entry : pole.t) entry = 0.0;
        detail::orthogonalise(found, again, twin, levels, leads);
        iterate(found.poles, found.vectors, {again}, leads, batch);
        detail::right_half(found, levels, leads);
        found.whole = lost() == 0;
        if (found.whole) break;
    }
    return found;
}

}  // namespace core
