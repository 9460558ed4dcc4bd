// Levels of the isolated wire from its end Green's function at a few energies.
//
// Particle–hole symmetry: C = τyσy anticommutes with H.  In the basis of chiral.hpp the ends see a level
// ±E through a (C = 1) and b (C = −1), and
//
//     G₊₊ = Σ a aᵀ ω/(ω² − E²),   G₊₋ = Σ a bᵀ E/(ω² − E²),   G₋₋ = Σ b bᵀ ω/(ω² − E²).
//
// So Φ(x) = [[G₊₊/ω, G₊₋], [G₋₊, ωG₋₋]], with x = ω², is Σ w wᵀ/(x − E²) + diag(0, 1), w = (a, Eb),
// where the sum runs over all levels of wire and parent superconductor together: with it the
// Hamiltonian does not depend on the energy, and Φ is the resolvent of a symmetric operator A ≥ 0,
// Φ − diag(0, 1) = Pᵀ(x − A)⁻¹P.
//
// Rayleigh–Ritz: the vectors (x_k − A)⁻¹P at M energies span a space in which A is diagonalised.  Their
// products need no vectors, only Φ and its slope (a Loewner matrix, Mayo and Antoulas 2007):
//
//     ⟨j|k⟩ = −(Φ_j − Φ_k)/(x_j − x_k),   ⟨j|A|k⟩ = −(x_jΦ_j − x_kΦ_k)/(x_j − x_k),
//
// with derivatives for j = k.  So the levels are real and the residues positive by construction, and the
// model meets Φ and dΦ/dx at every node.
#pragma once

#include <algorithm>

#include "pencil.hpp"
#include "tridiagonal.hpp"

namespace core {

constexpr double LOW = 1e-3;         // meV; below it completeness tells b of the lowest level better than Eb does
constexpr double ZERO_MODE = 3e-5;   // meV; below it Eb is too small to tell b
// A low level whose a is less than this (squared) may be one of rounding errors alone: with few nodes some
// levels are found at zero that the wire does not have.  (Of those that it has, and whose a was still too
// small to find E, the least that was seen in 440,000 sets is three times as much.)
constexpr double UNSEEN = 1e-10;
// So it is taken to be if all that is left for its b is less than this part of that of a low level whose a
// is seen, of which Eb says b with an error.
constexpr double REMAINDER = 0.1;

struct Level {
    double E;
    double w[8];  // a, then b
};
using LevelList = std::vector<Level>;

namespace detail {

inline double square(const double* a, int count) {
    double total = 0.0;
    for (int i = 0; i < count; ++i) total += a[i] * a[i];
    return total;
}

// The lowest level of those whose a is no less than this (squared), or −1.
inline int lowest(const LevelList& levels, double least) {
    int found = -1;
    for (int j = 0; j < int(levels.size()); ++j)
        if ((found < 0 || levels[j].E < levels[found].E) && levels[j].E < INFINITY && square(levels[j].w, 4) >= least) found = j;
    return found;
}

// What levels leave of ωG₋₋ = Σ b bᵀ ω²/(ω² − E²).
struct Rest {
    double omega, entry[4][4];

    double share(double E) const { return omega * omega / (omega * omega - E * E); }
    void add(double factor, const Level& level) {
        for (int i = 0; i < 4; ++i)
            for (int k = 0; k < 4; ++k) entry[i][k] += factor * level.w[4 + i] * level.w[4 + k];
    }
    // Give a level the b that makes most of what is left, signed as the b or Eb that it has.
    void take(Level& level) const {
        int p = 0;
        for (int i = 1; i < 4; ++i)
            if (entry[i][i] > entry[p][p]) p = i;
        double root = std::sqrt(std::max(entry[p][p], 0.0) * share(level.E)), along = 0.0;
        for (int i = 0; i < 4; ++i) along += level.w[4 + i] * entry[i][p];
        if (along < 0.0) root = -root;
        for (int i = 0; i < 4; ++i) level.w[4 + i] = root != 0.0 ? entry[i][p] / root : 0.0;
    }
};

// Take b of low levels from what the others leave: of the lowest level, and of all below ZERO_MODE; those
// that are seen come first.
inline void complete_low_levels(double omega, const NodeData& at, LevelList& levels) {
    double below = std::min(LOW, 0.25 * omega), limit = std::min(ZERO_MODE, below);
    int low = lowest(levels, 0.0);
    if (low < 0 || !(levels[low].E < below)) return;
    Rest rest{omega, {}};
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k) rest.entry[i][k] = omega * at.G[4 + i][4 + k];
    for (int j = 0; j < int(levels.size()); ++j)
        if (j != low && levels[j].E >= limit) rest.add(-rest.share(levels[j].E), levels[j]);
    int seen = lowest(levels, UNSEEN);
    if (seen >= 0 && seen != low && limit <= levels[seen].E && levels[seen].E < below) {
        double share = rest.share(levels[seen].E), left = 0.0;
        for (int i = 0; i < 4; ++i) left += std::abs(rest.entry[i][i]);
        if (left < REMAINDER * share * square(levels[seen].w + 4, 4)) {
            rest.add(share, levels[seen]);
            if (levels[low].E >= limit) rest.add(-rest.share(levels[low].E), levels[low]);
            low = seen;
        }
    }
    for (bool unseen : {false, true})
        for (int j = 0; j < int(levels.size()); ++j)
            if ((j == low || levels[j].E < limit) && (square(levels[j].w, 4) < UNSEEN) == unseen) {
                rest.take(levels[j]);
                rest.add(-rest.share(levels[j].E), levels[j]);
            }
}

}  // namespace detail

// The levels of up to SETS sets, each with its data at the nodes omega (positive, in meV); a set of which
// the data make no model has none.
inline void wire_levels(const double* omega, int nodes, const std::vector<const NodeData*>& sets, LevelList* out) {
    static thread_local Pencil pencil;
    static thread_local Tridiagonal T;
    T.clear(8 * nodes);
    std::vector<int> rank;
    for (int s = 0; s < int(sets.size()); ++s) {
        pencil.make(omega, sets[s], nodes);
        rank.push_back(pencil.rank);
        if (pencil.rank > 0) tridiagonalise(pencil, T, s);
    }
    T.n = std::max(1, *std::max_element(rank.begin(), rank.end()));
    bool converged = diagonalise(T);
    for (int s = 0; s < int(sets.size()); ++s) {
        out[s].clear(), out[s].reserve(rank[s]);
        if (!converged) continue;
        for (int k = 0; k < rank[s]; ++k) {
            double square = T.diagonal[k][s];
            Level level{!(square < 0.0) ? std::sqrt(square) : 0.0, {}};
            for (int c = 0; c < 8; ++c) level.w[c] = T.rows[k][c][s];
            if (level.E >= ZERO_MODE)
                for (int c = 4; c < 8; ++c) level.w[c] /= level.E;
            out[s].push_back(level);
        }
        detail::complete_low_levels(omega[0], sets[s][0], out[s]);
    }
}

}  // namespace core
