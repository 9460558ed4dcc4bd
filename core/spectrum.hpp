// The levels of the wire without leads, by counting.
//
// M(ω) = ω − H − Σ(ω) is Hermitian below the gap, and each of its eigenvalues grows with ω, as −Σ does.  So as many of
// them are positive as levels lie below ω, and as many as the pivots of its elimination (Sylvester's law of inertia).
// Of 4·site levels half are negative (particle–hole symmetry), so that the k-th positive one lies where the count reaches
// 2·site + k.  None is missed, however near two of them are.
#pragma once

#include <algorithm>

#include "tilted/arithmetic.hpp"

namespace core {

// Energies at which a bracket is cut, the same number whatever the processor, so that all find the same bits.
constexpr int SECTIONS = 16;
// Width in meV to which levels are bracketed: some ten times the rounding of M.
constexpr double LEVEL_WIDTH = 1e-12;

namespace detail {

// How many pivots are positive; Block: Symmetric4 or Hermitian4 of lanes.
template <class Block, class N>
inline typename Block::Pivot positive_pivots(const WireView& wire, const Terms<N>& of) {
    using Count = typename Block::Pivot;
    const TermsOfSites<N> terms(of);
    Count count = 0.0;
    Block D;
    for (int n = 0; n < wire.sites; ++n) {
        Block A = onsite<Block>(terms(n), wire.V[n], wire.zeeman_x[n], wire.zeeman_y, wire.zeeman_z[n]);
        D = n == 0 ? A : minus(A, D);
        const auto f = factor(D);
        for (int i = 0; i < 4; ++i) count = count + where_greater(f.over[i], Count(0.0), Count(1.0), Count(0.0));
        D = inverse(f);
    }
    return count;
}

// One wire in one field.
template <class A>
struct LevelCounter {
    const Wire& of;
    RotatedWire wire;
    double hop, mu;

    // How many levels lie below each of SECTIONS energies.
    void operator()(const double (&omega)[SECTIONS], double (&count)[SECTIONS]) const {
        for (int first = 0; first < SECTIONS; first += A::LANES) {
            Terms<typename A::N> terms{};
            for (int l = 0; l < A::LANES; ++l) {
                A::set_kinetic(terms, l, (2 * of.hopping - mu) / hop);
                A::set(terms, l, typename A::Pairing(of, omega[std::min(first + l, SECTIONS - 1)]), hop);
            }
            auto found = positive_pivots<typename A::Block, typename A::N>(view(wire), terms);
            for (int l = 0; l < std::min(A::LANES, SECTIONS - first); ++l) count[first + l] = found[l];
        }
    }
};

// The first `count` levels above zero, in meV; NaN where there are no more below the gap.
template <class A>
inline void positive_levels(const LevelCounter<A>& counter, int count, double* out) {
    double edge = counter.of.delta0 * (1 - 1e-9), omega[SECTIONS], below[SECTIONS];
    for (int k = 0; k < count; ++k) {
        double low = 0.0, high = edge, sought = 2.0 * counter.wire.sites() + k + 1;
        auto first_beyond = [&] {
            for (int i = 0; i < SECTIONS; ++i) omega[i] = low + (high - low) * (i + 1) / SECTIONS;
            counter(omega, below);
            return int(std::find_if(below, below + SECTIONS, [&](double found) { return found >= sought; }) - below);
        };
        int at = first_beyond();
        for (bool there = at < SECTIONS; there && high - low > LEVEL_WIDTH; at = first_beyond()) {
            at = std::min(at, SECTIONS - 1);  // whose energy is that of `high`, to rounding
            if (at > 0) low = omega[at - 1];
            high = omega[at];
        }
        out[k] = high < edge ? (low + high) / 2 : NAN;
    }
}

}  // namespace detail

// Fill out, shape (wire, mu, B, level).
template <class A>
inline void levels_above_zero(const Grid& grid, int count, double* out, Stop& stop) {
    int points = grid.mu_count * grid.B_count;
    in_parallel(grid.wire_count * points, stop, [&](int task) {
        const Wire& wire = grid.wires[task / points];
        int m = task % points / grid.B_count, f = task % grid.B_count;
        detail::LevelCounter<A> counter{wire, RotatedWire(wire, grid.B[f], grid.theta), wire.rotated_hopping(), grid.mu[m]};
        detail::positive_levels(counter, count, out + size_t(task) * count);
    });
}

inline void levels_above_zero(const Grid& grid, int count, double* out, Stop& stop) {
    if (grid.theta == 0)
        levels_above_zero<RealArithmetic>(grid, count, out, stop);
    else
        levels_above_zero<HermitianArithmetic>(grid, count, out, stop);
}

}  // namespace core
