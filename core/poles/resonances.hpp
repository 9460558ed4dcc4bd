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
    int spare = 0;           // how many poles in both halves may be others of those, too faint to tell
    bool whole = false;      // whether none was lost, or met twice

    int both() const { return paired + int(order.size()); }  // poles in both halves
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
// none, the last, and which it equals, or −1.  Equal poles that are faint stay: they carry nothing.
//
// It is whole if there are as many as `both` halves have; what is too faint may stand twice.
inline std::pair<int, int> right_half(Resonances& found, int both, const Levels& levels, const Leads& leads) {
    int again = -1, twin = -1;
    found.order.clear(), found.spare = 0;
    for (bool central : {false, true}) {
        for (int k = 0; k < int(found.poles.size()); ++k) {
            Pole& pole = found.poles[k];
            if ((std::abs(pole.z.real()) <= CENTRAL) != central || std::isnan(pole.norm.real())) continue;
            if (pole.z.real() < -CENTRAL) reflect(found, k);
            double kept = 1.0, width = std::abs(pole.z.imag());
            for (int at : found.order) {
                double apart = std::abs(found.poles[at].z - pole.z);
                if (width < FAINT && apart < FAINT) {
                    found.spare += central ? 1 : 2;
                    break;
                }
                if (apart < EQUAL * width) {
                    double left = orthogonalise(found, k, at, levels, leads);
                    kept = std::min(kept, left);
                    if (!(kept > 0.1)) again = k, twin = at;
                }
            }
            if (kept > 0.1) found.order.push_back(k);
        }
        if (!central) found.paired = int(found.order.size());
    }
    found.whole = both <= found.both() && found.both() <= both + found.spare;
    return {again, twin};
}

// Where two starts have ended at one pole, `twin`, look for the other one once more: on the imaginary axis on either side of
// it, elsewhere from its start without the vector of the one found.
inline void look_again(Resonances& found, const Starts& starts, int again, int twin, const Levels& levels, const Leads& leads,
                       Batch& batch) {
    bool central = std::abs(found.poles[twin].z.real()) <= CENTRAL;
    if (starts.both - found.both() != (central ? 1 : 2)) return;
    const Amplitude there = found.poles[twin].z, here = starts.poles[again].z;
    for (Amplitude z : central ? std::array{there * (1.0 - BESIDE), there * (1.0 + BESIDE)} : std::array{here, 2.0 * here - there}) {
        Pole& pole = found.poles[again];
        pole.z = z;
        for (int n = 0; n < found.vectors.size(); ++n) found.vectors.set(again, n, starts.vectors.get(again, n));
        for (auto& entry : pole.t) entry = 0.0;
        orthogonalise(found, again, twin, levels, leads);
        iterate(found.poles, found.vectors, {again}, leads, batch);
        right_half(found, starts.both, levels, leads);
        if (found.whole) return;
    }
}

// Take the starts to where the poles are, all at once, and give each its vector; false if they do not settle.
inline bool start_again(Starts& starts, const Leads& leads, Batch& batch) {
    std::vector<Zero> zeros;
    for (const Pole& pole : starts.poles) zeros.push_back({pole.z, pole.z.real() > CENTRE});
    if (!settle(zeros, [&](PoleComplex z) { return batch.slope_of_determinant(leads, starts.near, z); })) return false;
    const std::vector<int> all = first_numbers(zeros.size());
    for (size_t first = 0; first < all.size(); first += POLES) {
        batch.z = load(zeros, all, first);
        batch.find_vectors(leads, starts.vectors, int(first), int(std::min<size_t>(POLES, all.size() - first)));
    }
    for (size_t k = 0; k < zeros.size(); ++k) starts.poles[k].z = zeros[k].z;
    return true;
}

}  // namespace detail

// Iterate the poles of `start_poles`; where one is lost, in other ways too.
inline Resonances find_poles(Starts& starts, const Levels& levels, const Leads& leads, Batch& batch) {
    Resonances found{starts.poles, starts.vectors, {}};
    auto iterate_all = [&] {
        iterate(found.poles, found.vectors, first_numbers(found.poles.size()), leads, batch);
        return detail::right_half(found, starts.both, levels, leads);
    };
    auto [again, twin] = iterate_all();
    if (!found.whole && again >= 0) detail::look_again(found, starts, again, twin, levels, leads, batch);
    if (!found.whole && detail::start_again(starts, leads, batch)) {
        found.poles = starts.poles, found.vectors = starts.vectors;
        iterate_all();
    }
    return found;
}

}  // namespace core
