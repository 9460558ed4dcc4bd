// Where a set's levels are densest: there its model is compared with the solver as well.
//
// A model of few nodes may follow the wire at every check, to 1e-8, and yet be all wrong in between, where
// many levels lie closer together than the nodes, at the edge of the induced gap for example: in 96 of 6,000
// odd sets (µ to 0.6 meV, γ from 0.05 to 0.5 meV, no barriers or up to 300 meV) the error, up to 0.01 e²/h,
// was more than three times an estimate from CHECKS energies alone.  In all of them seven levels of the model
// lay within 0.7 of the nodes' distance.  Two comparisons, each in the widest gap of one of the densest runs
// of levels, show it in all but one.
#pragma once

#include "../poles/starts.hpp"
#include "plan.hpp"

namespace core {

constexpr int RUN = 4;  // gaps between the levels of a run
constexpr double ELSEWHERE[SOUGHT] = {0.382, 0.764};  // where sets of fewer levels are checked: shares of the window, as places

// Distances are measured in θ, sin θ = place(ω), in which the nodes are as far from each other.
inline void dense_energies(const LevelList& levels, double hop, const EnergyPlan& plan, double (&out)[SOUGHT]) {
    std::vector<double> places;
    for (const Level& level : levels)
        if (level.E < std::min(plan.window, plan.pole_limit()) && hop * detail::square(level.w, 8) > INVISIBLE) places.push_back(plan.place(level.E));
    std::sort(places.begin(), places.end());
    int count = int(places.size());
    std::vector<bool> taken(count, false);
    for (int k = 0; k < SOUGHT; ++k) {
        double least = INFINITY, at = ELSEWHERE[k];
        int first = -1;
        for (int n = 0; n < count - RUN; ++n) {
            double span = places[n + RUN] - places[n];
            if (span < least && !taken[n] && !taken[n + RUN]) least = span, first = n;
        }
        if (first >= 0) {
            double widest = -1.0;
            for (int n = first; n < first + RUN; ++n)
                if (places[n + 1] - places[n] > widest) widest = places[n + 1] - places[n], at = (places[n] + places[n + 1]) / 2;
            for (int n = first; n <= first + RUN; ++n) taken[n] = true;
        }
        out[k] = plan.energy(at);
    }
}

}  // namespace core
