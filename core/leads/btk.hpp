// The conductance matrix as sums of probabilities (Blonder, Tinkham and Klapwijk 1982; S-I).
//
// P[out][in] is the probability from one channel set to another, `net[in]` what does not come back
// as it was, N − P[in][in].  At +ω electrons come in, at −ω, by particle–hole symmetry, holes:
//
//     G_aa = N − R_ee + R_he,   G_ba = T_ee − T_he (from a to b).
#pragma once

#include "../values/complex.hpp"
#include "self_energy.hpp"

namespace core {

enum Conductance { LL, RR, LR, RL };

template <class N>
struct Conductances {
    N at[2][4];  // sign of ω (+, −), then LL, RR, LR, RL, in e²/h
};

template <class R>
inline Conductances<double> lane_of(const Conductances<R>& G, int lane) {
    Conductances<double> out;
    for (int sign = 0; sign < 2; ++sign)
        for (int k = 0; k < 4; ++k) out.at[sign][k] = G.at[sign][k][lane];
    return out;
}

template <class N>
CORE_INLINE Conductances<N> conductances(const N (&P)[4][4], const N (&net)[4]) {
    Conductances<N> G;
    for (int charge = 0; charge < 2; ++charge)
        for (int lead = 0; lead < 2; ++lead) {
            int same = 2 * lead + charge, other = 2 * lead + 1 - charge, far = 2 - 2 * lead;
            G.at[charge][lead] = net[same] + P[other][same];
            G.at[charge][3 - lead] = P[far + charge][same] - P[far + 1 - charge][same];
        }
    return G;
}

// Where nothing is absorbed, probabilities sum to one, and net is a sum without cancellation.
template <class N>
CORE_INLINE Conductances<N> lossless_conductances(const N (&P)[4][4]) {
    N net[4];
    for (int in = 0; in < 4; ++in) {
        net[in] = 0.0;
        for (int out = 0; out < 4; ++out)
            if (out != in) net[in] = net[in] + P[out][in];
    }
    return conductances(P, net);
}

}  // namespace core
