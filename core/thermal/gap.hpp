// Whether a thermal window reaches the gap, how many nodes it has, and how they are spread up to the gap.
#pragma once

#include <algorithm>

#include "../wire/wire.hpp"
#include "kernel.hpp"

namespace core {

// The nodes span this many kT beyond the largest |V|, where 2e-5 of the kernel is cut.
constexpr double REACH = 11.0;

// Part of the gap up to which the nodes end with the window; if the window is wider, they go up to the gap.
constexpr double BELOW_GAP = 0.98;
// W in meV, up to which energies count.
inline double window_of(const double* bias, int count, double kT) {
    double largest = 0.0;
    for (int v = 0; v < count; ++v) largest = std::max(largest, std::abs(bias[v]));
    return largest + REACH * kT;
}

// Numbers of nodes that are tried in turn.
constexpr int ROUNDS_OF_NODES = 10;
constexpr int NODES[ROUNDS_OF_NODES] = {12, 13, 16, 20, 28, 36, 52, 76, 112, 160};
constexpr int NODES_TO_GAP[ROUNDS_OF_NODES] = {16, 20, 24, 30, 36, 52, 76, 112, 160, 0};
constexpr int NODES_TO_HOT_GAP = 24;  // the fewest where much is
// For derivatives, which change their sign with each level next to the gap.  Of 200 derivatives each of hot wires, by V, μ, γ and Δ₀, 96,
// 87, 94 and 86 % are within 1e-4 of the largest if 36 come first, and 97, 93, 94 and 90 % if 44 do.
constexpr int NODES_TO_GAP_FOR_SLOPES[ROUNDS_OF_NODES] = {44, 52, 76, 112, 160};

// How nodes are spread that go up to the gap: at equal distances of gathered · tanh τ + τ up to τ = farthest, where
// ω = Δ₀ tanh τ.
struct Spread {
    double gathered, farthest;

    double place(double tau) const { return (gathered * std::tanh(tau) + tau) / (gathered * std::tanh(farthest) + farthest); }
    double tau(double at) const {
        double low = 0.0, high = farthest;
        for (int step = 0; step < 60; ++step) {
            double middle = (low + high) / 2;
            (place(middle) < at ? low : high) = middle;
        }
        return low;
    }
};

// Little of the kernel is at the gap if it has less than HOT there, in 1/meV.  Then nodes are spread so; else with HOT_GATHERED.
constexpr Spread COOL{8.0, 4.5};
constexpr double HOT = 0.1, HOT_GATHERED = 1.0;
// Next to the gap levels lie ever more densely.  Where much of the kernel is there, and nodes can no longer tell them apart
// (`resolved_up_to`), the conductance is sampled instead, from a little before that τ up to the last: at distances of SAMPLE
// beside NODES_TO_HOT_GAP, which double twice, after SAMPLED each time.  Nodes go a little further.
constexpr double BEFORE = 0.15, FURTHER_ON = 0.45, SAMPLE = 0.07, SAMPLED = 0.9, LAST = 6.6;
constexpr double LEAST_RESOLVED = 2.5;  // Before this τ resonances are too narrow to be sampled.
constexpr double RESOLVED = 80.0;  // phases kL up to which NODES_TO_HOT_GAP tell levels apart, in proportion

// τ up to which nodes tell the levels of a wire apart.  There those of kinetic energy ε lie at γΔ₀ exp τ = ε² + γ² − Δ₀², at
// distances of π in the phase kL = sites √(ε/t).
inline double resolved_up_to(const Wire& wire, int nodes) {
    double k = RESOLVED * nodes / NODES_TO_HOT_GAP / wire.sites, kinetic = wire.hopping * k * k;
    double square = kinetic * kinetic + (wire.gamma - wire.delta0) * (wire.gamma + wire.delta0);
    return square > 0 ? std::min(std::log(square / (wire.gamma * wire.delta0)), LAST) : 0.0;
}

// How far the nodes of a plan go: to the end of its window, or up to the gap, where the kernel is small or is not.
enum class Reach { WINDOW, GAP, HOT_GAP };

inline Reach reach_of(const double* bias, int count, double kT, double delta0) {
    if (window_of(bias, count, kT) <= BELOW_GAP * delta0) return Reach::WINDOW;
    double at_gap = 0.0;
    for (int v = 0; v < count; ++v) at_gap = std::max(at_gap, thermal_kernel(delta0, std::abs(bias[v]), kT).real());
    return at_gap > HOT ? Reach::HOT_GAP : Reach::GAP;
}

// A wire has a level for so many sites, so a long one begins with more nodes, one for each SITES_FOR_LEAST sites, and goes
// on to more.  Of 160 sets of 1,000 sites 28 then have no model within the tolerance, and one of the others is 2.3 times as
// wrong as estimated; with 12 to 36 nodes it was 20 and one, 79 times, of 60 sets.
constexpr int SITES_FOR_LEAST = 25, SITES_FOR_MOST = 6, MOST_FOR_ALL = 36, MOST_TO_GAP = 52;

// Zero if a wire is not to be tried in a round.
inline int nodes_in_round(int round, Reach reach, const Wire& wire, bool with_slopes) {
    int nodes = reach == Reach::WINDOW ? NODES[round] : with_slopes ? NODES_TO_GAP_FOR_SLOPES[round] : NODES_TO_GAP[round];
    int most = std::max(reach == Reach::WINDOW ? MOST_FOR_ALL : MOST_TO_GAP, wire.sites / SITES_FOR_MOST);
    if (nodes * SITES_FOR_LEAST < wire.sites || nodes > most) return 0;
    bool few = reach == Reach::HOT_GAP && (nodes < NODES_TO_HOT_GAP || !(resolved_up_to(wire, nodes) > LEAST_RESOLVED));
    return few ? 0 : nodes;
}

}  // namespace core
