// G(z) of the two ends of the isolated wire, without leads, at complex energies and any angle of the
// field: the inverse of M' of elimination.hpp.
//
// With Im z > 0 no pivot can vanish, as no level is at z; the wires have no dissipation of their own.
#pragma once

#include "tilted/arithmetic.hpp"

namespace core {

// Fill out, shape (wire, B, mu, z, 8, 8), with G in the rotated frame, left end first, in 1/meV.
// The energies are x + iy, where x is the grid's omega.
inline void isolated_ends(const Grid& grid, const double* y, Amplitude* out, Stop& stop) {
    using A = TiltedArithmetic;
    int pairs = grid.mu_count * grid.omega_count;
    in_parallel(grid.wire_count * grid.B_count, stop, [&](int task) {
        const Wire& wire = grid.wires[task / grid.B_count];
        RotatedWire turned(wire, grid.B[task % grid.B_count], grid.theta);
        double hop = wire.rotated_hopping();
        std::vector<RetardedPairing> pairing;
        for (int e = 0; e < grid.omega_count; ++e) {
            Amplitude z(grid.omega[e], y[e]);
            pairing.push_back(RetardedPairing(wire, z, z));
        }
        Amplitude* to = out + size_t(task) * pairs * 64;
        for (int first = 0; first < pairs && !stop.asked(); first += A::LANES) {
            Terms<A::N> terms;
            for (int l = 0; l < A::LANES; ++l) {
                int pair = std::min(first + l, pairs - 1);
                A::set_kinetic(terms, l, (2 * wire.hopping - grid.mu[pair / grid.omega_count]) / hop);
                A::set(terms, l, pairing[pair % grid.omega_count], hop);
            }
            const Square8<A::N> G = inverted(ends_of(eliminate_inner_sites<A::N, A::Block>(view(turned), terms)));
            for (int l = 0; l < std::min(A::LANES, pairs - first); ++l)
                for (int k = 0; k < 64; ++k)
                    to[(size_t(first) + l) * 64 + k] = of_lane(G(k / 8, k % 8), l) / hop;
        }
    });
}

}  // namespace core
