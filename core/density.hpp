// The Green's function of a wire with its leads on each of its sites.
//
// D_n = A_n − D_{n−1}⁻¹ holds the site n and all that is left of it, E_n = A_n − E_{n+1}⁻¹ the site and all that is right of
// it, in the frame and the units of wire/elimination.hpp.  So G_nn = (D_n + E_n − A_n)⁻¹.  What is summed over the spin is
// the same in any frame.
#pragma once

#include "isolated.hpp"

namespace core {

namespace detail {

// Of each site the trace of G over the spin, of electrons and of holes, (site, 2); returns the largest inverse pivot.
template <class Block, class N, class Leads>
inline auto traces(const WireView& wire, const Terms<N>& of, const Leads& leads, std::vector<N>& out) {
    const TermsOfSites<N> terms(of);
    auto onsite_of = [&](int n) {
        Block A = onsite<Block>(terms(n), wire.V[n], wire.zeeman_x[n], wire.zeeman_y, wire.zeeman_z[n]);
        if (n == 0) attach_lead(A, leads, 0);
        if (n == wire.sites - 1) attach_lead(A, leads, 1);
        return A;
    };
    decltype(size(N())) growth = 0.0;
    auto inverted_block = [&](const Block& D) {
        const auto f = factor(D);
        for (int i = 0; i < 4; ++i) growth = larger(size(f.over[i]), growth);
        return inverse(f);
    };
    std::vector<Block> from_left(wire.sites);  // D_{n−1}⁻¹
    for (int n = 1; n < wire.sites; ++n) {
        Block D = onsite_of(n - 1);
        from_left[n] = inverted_block(n == 1 ? D : minus(D, from_left[n - 1]));
    }
    Block from_right;
    for (int n = wire.sites - 1; n >= 0; --n) {
        Block E = onsite_of(n);
        if (n < wire.sites - 1) E = minus(E, from_right);
        const Block G = inverted_block(n == 0 ? E : minus(E, from_left[n]));
        out[2 * n] = G(0, 0) + G(1, 1), out[2 * n + 1] = G(2, 2) + G(3, 3);
        if (n > 0) from_right = inverted_block(E);
    }
    return growth;
}

}  // namespace detail

// Fill out, shape (mu, B, z, site, 2), in 1/meV, and growth, shape (mu, B, z), of the one wire of the grid, at x + iy, where
// x is the grid's omega and y ≥ 0.  leads, shape (B, z), are in the wire's frame, in units of t'.
template <class A>
inline void local_green(const Grid& grid, const double* y, const LeadSelfEnergy* leads, Amplitude* out, double* growth,
                        Stop& stop) {
    const Wire& wire = *grid.wires;
    int energies = grid.omega_count;
    double hop = wire.rotated_hopping();
    std::vector<RetardedPairing> pairing;
    for (int e = 0; e < energies; ++e) {
        Amplitude z(grid.omega[e], y[e]);
        bool real = y[e] == 0;
        pairing.push_back(real ? RetardedPairing(wire, z.real())
                               : RetardedPairing(wire, z + Amplitude(0, wire.dissipation), z + Amplitude(0, wire.parent_dissipation)));
    }
    in_parallel(grid.mu_count * grid.B_count, stop, [&](int task) {
        int m = task / grid.B_count, f = task % grid.B_count;
        RotatedWire turned(wire, grid.B[f], grid.theta);
        std::vector<typename A::N> of_sites(2 * size_t(wire.sites));
        for (int first = 0; first < energies && !stop.asked(); first += A::LANES) {
            Terms<typename A::N> terms{};
            typename A::Leads of_lanes{};
            for (int l = 0; l < A::LANES; ++l) {
                int e = std::min(first + l, energies - 1);
                A::set_kinetic(terms, l, (2 * wire.hopping - grid.mu[m]) / hop);
                A::set(terms, l, pairing[e], hop);
                of_lanes.set(l, leads[size_t(f) * energies + e]);
            }
            auto grown = detail::traces<typename A::Block>(view(turned), terms, of_lanes, of_sites);
            for (int l = 0; l < std::min(A::LANES, energies - first); ++l) {
                size_t at = size_t(task) * energies + first + l;
                growth[at] = grown[l];
                for (int k = 0; k < 2 * wire.sites; ++k)
                    out[at * 2 * wire.sites + k] = of_lane(of_sites[k], l) / hop;
            }
        }
    });
}

inline void local_green(const Grid& grid, const double* y, const LeadSelfEnergy* leads, Amplitude* out, double* growth,
                        Stop& stop) {
    if (grid.theta == 0)
        local_green<ComplexArithmetic>(grid, y, leads, out, growth, stop);
    else
        local_green<TiltedArithmetic>(grid, y, leads, out, growth, stop);
}

}  // namespace core
