// Zeros of an analytic function f, all at once, by Aberth's iteration (Math. Comp. 27, 339, 1973): Newton's on f over
// what the other zeros make of it,
//
//     1/Δz = f'/f − Σ_j 1/(z − z_j),
//
// so that no two end at one zero.  Here f is the determinant of a wire's ends and leads times ∏(z² − E²) of its levels, which
// has a zero where the wire with its leads has a pole.
//
// Particle–hole symmetry pairs z with −z*.  Where a pair may meet on the imaginary axis and part along it, both are in the
// list, each for itself; elsewhere one stands for both.
#pragma once

#include <numeric>

#include "dressing.hpp"

namespace core {

constexpr double FAINT = 1e-9;        // widths below this (meV) carry no conductance and need no digits
constexpr double SETTLED = 1e-6;      // last step, as a part of width or distance, after which no other is needed
constexpr int ABERTH_STEPS = 40;      // most; three or four do

struct Zero {
    Amplitude z;
    bool mirrored;  // or it is for itself
    bool settled = false;
};

// 0, 1, … before `count`.
inline std::vector<int> first_numbers(size_t count) {
    std::vector<int> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 0);
    return numbers;
}

// POLES of some zeros, in lanes; the last one fills up.
inline PoleComplex load(const std::vector<Zero>& zeros, const std::vector<int>& which, size_t first) {
    PoleComplex z;
    for (int l = 0; l < POLES; ++l) {
        set_lane(z, l, zeros[which[std::min(first + l, which.size() - 1)]].z);
    }
    return z;
}

namespace detail {

// Find Σ 1/(z − z_j) of the other zeros, and the square of the distance to the nearest.
inline void add_others(const std::vector<Zero>& zeros, PoleComplex z, PoleComplex& sum, PoleReal& nearest) {
    auto add = [&](Amplitude other) {
        PoleComplex apart(z.re - other.real(), z.im - other.imag());
        PoleReal distance = square(apart), none = 0.0, over = where_greater(distance, none, inverse(distance), none);  // itself
        sum = sum + PoleComplex(apart.re * over, -apart.im * over);
        nearest = where_greater(distance, none, where_greater(nearest, distance, distance, nearest), nearest);
    };
    for (const Zero& zero : zeros) {
        add(zero.z);
        if (zero.mirrored) add(-std::conj(zero.z));
    }
}

}  // namespace detail

// Take approximate zeros of f to where they are, given f'/f at POLES energies; return whether all settle.  Zeros of f that
// are not in the list are to be left out of f'/f.
template <class Slope>
inline bool settle(std::vector<Zero>& zeros, Slope slope) {
    std::vector<int> left = first_numbers(zeros.size());
    for (int step = 0; step < ABERTH_STEPS && !left.empty(); ++step) {
        std::vector<Amplitude> next(zeros.size());
        for (size_t first = 0; first < left.size(); first += POLES) {
            const PoleComplex z = load(zeros, left, first);
            PoleComplex others(0.0);
            PoleReal nearest = 1e300;
            detail::add_others(zeros, z, others, nearest);
            const PoleComplex change = inverse(PoleComplex(slope(z) - others));
            for (int l = 0; l < POLES && first + l < left.size(); ++l) {
                Zero& zero = zeros[left[first + l]];
                Amplitude by(change.re[l], change.im[l]);
                next[left[first + l]] = zero.z - by;
                zero.settled = std::abs(by) <= SETTLED * (FAINT + std::min(std::abs(zero.z.imag()), std::sqrt(nearest[l])));
            }
        }
        for (int k : left) zeros[k].z = next[k];
        std::erase_if(left, [&](int k) { return zeros[k].settled; });
    }
    return left.empty();
}

}  // namespace core
