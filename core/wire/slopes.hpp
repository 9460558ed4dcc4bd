// The end blocks' derivatives by ω, carried along with the elimination.
//
// With X = D⁻¹, Y = C X, which is the new C, and Z = dC − Y dD of the old blocks,
//
//     dE ← dE − Z Yᵀ − Y dCᵀ,   dC ← Z X,   dD ← dA + X dD X.
//
// Numbers that carry a slope (dual numbers) through the factorisation do it at the same cost, but where a
// level of the eliminated piece lies at ω, D⁻¹ being some g ≫ 1, they differentiate terms of the order of g² that
// cancel: at g = 8,000 slopes were off by 2e-6, and the models of the levels found 48 directions, not 59.
#pragma once

#include "elimination.hpp"

namespace core {

template <class N>
struct EndSlopes {
    Symmetric4<N> E, D;
    Block4<N> C;
};

// dA_n.
template <class N>
CORE_INLINE Symmetric4<N> onsite_slope(N normal, N anomalous) {
    Symmetric4<N> A;
    for (N& entry : A.entry) entry = 0.0;
    A(0, 0) = A(1, 1) = A(2, 2) = A(3, 3) = normal;
    A(0, 2) = A(1, 3) = anomalous;
    return A;
}

// Carry the slopes over the site that has just been eliminated.
template <class N>
CORE_INLINE void differentiate_site(EndSlopes<N>& d, const Block4<N>& Y, const Symmetric4<N>& X, const Symmetric4<N>& dA) {
    Block4<N> Z, XdD;
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
#pragma GCC unroll 4
        for (int j = 0; j < 4; ++j) {
            Z(i, j) = d.C(i, j) - Y(i, 0) * d.D(0, j) - Y(i, 1) * d.D(1, j) - Y(i, 2) * d.D(2, j) - Y(i, 3) * d.D(3, j);
            XdD(i, j) = X(i, 0) * d.D(0, j) + X(i, 1) * d.D(1, j) + X(i, 2) * d.D(2, j) + X(i, 3) * d.D(3, j);
        }
    }
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i)
#pragma GCC unroll 4
        for (int j = i; j < 4; ++j) {
            N ZY = Z(i, 0) * Y(j, 0) + Z(i, 1) * Y(j, 1) + Z(i, 2) * Y(j, 2) + Z(i, 3) * Y(j, 3);
            N YdC = Y(i, 0) * d.C(j, 0) + Y(i, 1) * d.C(j, 1) + Y(i, 2) * d.C(j, 2) + Y(i, 3) * d.C(j, 3);
            d.E(i, j) = d.E(i, j) - ZY - YdC;
            N XdDX = XdD(i, 0) * X(0, j) + XdD(i, 1) * X(1, j) + XdD(i, 2) * X(2, j) + XdD(i, 3) * X(3, j);
            d.D(i, j) = dA(i, j) + XdDX;
        }
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i)
#pragma GCC unroll 4
        for (int j = 0; j < 4; ++j) {
            d.C(i, j) = Z(i, 0) * X(0, j) + Z(i, 1) * X(1, j) + Z(i, 2) * X(2, j) + Z(i, 3) * X(3, j);
        }
}

// As eliminate_inner_sites, with the derivatives of the normal and anomalous terms given.
template <class N>
inline EndBlocks<N> eliminate_inner_sites_with_slopes(const WireView& wire, const Terms<N>& of, N normal_slope,
                                                      N anomalous_slope, EndSlopes<N>& d) {
    const TermsOfSites<N> terms(of);
    auto A = [&](int n) { return onsite<Symmetric4<N>>(terms(n), wire.V[n], wire.zeeman_x[n], 0.0, wire.zeeman_z[n]); };
    const N signed_slope[2] = {anomalous_slope, -anomalous_slope};
    auto dA = [&](int n) { return onsite_slope(normal_slope, signed_slope[n % 2]); };
    EndBlocks<N> s = first_two_sites<N>(A(0), A(1));
    d.E = dA(0), d.D = dA(1);
    for (int k = 0; k < 16; ++k) d.C(k / 4, k % 4) = 0.0;
    decltype(s.growth) before = 1.0;
    for (int n = 2; n < wire.sites; ++n) {
        Symmetric4<N> X = eliminate_site(s, A(n));
        look_at_coupling(s, n, wire.sites, before);
        differentiate_site(d, s.C, X, dA(n));
    }
    turn_back_onsite(wire.sites, s.D), turn_back_coupling(wire.sites, s.C);
    turn_back_onsite(wire.sites, d.D), turn_back_coupling(wire.sites, d.C);
    return s;
}

}  // namespace core
