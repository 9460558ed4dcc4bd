// Poles of the wire with its leads in a tilted field, and their residues in the conductances.
//
// They are the zeros of f(z) = det D(z) ∏(z² − E²), D = 1 − F Σ, as many as there are levels ±E, and aberth.hpp finds them:
//
//     f'/f = Tr D⁻¹D' + Σ 1/(z − E) + 1/(z + E).
//
// It starts at the levels as the leads shift them.  Zeros far outside the window are taken for the levels themselves, which
// then cancel.
//
// G† is on the real axis the function G(z*)†, which is analytic where G has its poles.  So with ρ = D⁻¹F/Tr D⁻¹D', the residue
// of G at z, that of the probability Tr[Γ_b G_ba Γ_a G_ba†] is the sum of (ΓρΓ)_ij (G(z*)_ij)* over i in b and j in a.
#pragma once

#include "../leads/btk.hpp"
#include "../poles/aberth.hpp"
#include "sums.hpp"

namespace core {

struct TiltedPole {
    Amplitude z;
    Amplitude residue[4];  // of G_LL, G_RR, G_LR, G_RL, in e²/h · meV
};

namespace detail {

constexpr double NEAR_TILTED = 1.3;   // levels up to so many windows have poles; with 1.15 conductances change by 1e-6 e²/h
constexpr double LOW_LEVEL = 4.0;     // levels up to so many times their shift may end on the imaginary axis, each by itself
constexpr double TO_SIDE = 0.1;       // by this part of its width one of such a pair is moved off the other's mirror image
constexpr double FEEDS = 1e-9;        // a pole further above the real axis, in units of the window, makes no model
constexpr double PAIRED = 1e-3;       // distance of two zeros, as a part of their width, that are one
constexpr double AXIS = 1e-14;        // starts are so far below the real axis at least, in meV

// Where the levels' poles start: E + w†Tw with T = Σ/(1 − F Σ) of the far levels.
inline std::vector<Zero> starts(const std::vector<TiltedLevel>& levels, int near, const TiltedLeads& leads,
                                TiltedSums& sums) {
    std::vector<Zero> found;
    for (int first = 0; first < near; first += POLES) {
        PoleComplex z(0.0), w[8];
        for (int l = 0; l < POLES; ++l) {
            const TiltedLevel& level = levels[std::min(first + l, near - 1)];
            z.re.set(l, level.E);
            for (int i = 0; i < 8; ++i) w[i].re.set(l, level.w[i].re), w[i].im.set(l, level.w[i].im);
        }
        sums.fill(z, near);
        EndSquares sigma;
        fill_ends(sigma, [&](int end, int i, int j) { return leads.at(z, end, i, j); });
        const EndSquares T = product(sigma, sums.undressed(leads, z));
        PoleComplex form[2][2] = {{0.0, 0.0}, {0.0, 0.0}};  // between w, w* and w, w*
        for (int i = 0; i < 8; ++i) {
            PoleComplex right[2] = {0.0, 0.0};
            for (int j = 0; j < 8; ++j) right[0] = right[0] + T(i, j) * w[j], right[1] = right[1] + T(i, j) * conj(w[j]);
            for (int b = 0; b < 2; ++b) form[0][b] = form[0][b] + conj(w[i]) * right[b], form[1][b] = form[1][b] + w[i] * right[b];
        }
        for (int l = 0; l < POLES && first + l < near; ++l) {
            auto of = [&](int a, int b) { return of_lane(form[a][b], l); };
            double E = levels[first + l].E;
            auto below = [](Amplitude start) { return Amplitude(start.real(), std::min(start.imag(), -AXIS)); };
            if (E > LOW_LEVEL * std::abs(of(0, 0))) {
                found.push_back({below(E + of(0, 0)), true});
                continue;
            }
            Amplitude up = E + of(0, 0), down = of(1, 1) - E, middle = (up + down) / 2.0, half = (up - down) / 2.0;
            Amplitude root = std::sqrt(half * half + of(0, 1) * of(1, 0)), one = middle + root;
            found.push_back({below(one + TO_SIDE * std::abs(one.imag())), false});
            found.push_back({below(middle - root), false});
        }
    }
    return found;
}

// Where a zero that is for itself is off the imaginary axis and its mirror image is none of the others, count that too.
inline void complete_pairs(std::vector<Zero>& zeros) {
    for (Zero& zero : zeros) {
        const Amplitude image = -std::conj(zero.z);
        auto is_image = [&](const Zero& other) { return std::abs(other.z - image) <= PAIRED * std::abs(image.imag()); };
        if (std::none_of(zeros.begin(), zeros.end(), is_image)) zero.mirrored = true;
    }
}

// Residues of the conductances at POLES poles, of electrons, then of holes that come in.
inline Conductances<PoleComplex> residues(const TiltedLeads& leads, TiltedSums& sums, PoleComplex z) {
    sums.fill(z);
    const EndSquares D = sums.undressed(leads, z);
    const PoleComplex over = -inverse(trace(D, sums.change(leads, z)));
    EndSquares rho = product(D, sums.F), gamma;
    fill_ends(gamma, [&](int end, int i, int j) { return leads.gamma_at(z, end, i, j); });
    rho = product(product(gamma, rho), gamma);
    sums.fill(conj(z));
    EndSquares mirror = product(sums.undressed(leads, conj(z)), sums.F);
    from_majorana(rho.entry);
    from_majorana(mirror.entry);
    PoleComplex P[4][4];  // channels, of which each has two entries
    for (auto& row : P)
        for (auto& entry : row) entry = 0.0;
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) P[i / 2][j / 2] = P[i / 2][j / 2] + rho(i, j) * conj(mirror(i, j));
    for (auto& row : P)
        for (auto& entry : row) entry = entry * over;
    return lossless_conductances(P);
}

}  // namespace detail

// The poles up to about NEAR_TILTED windows, −z* beside every z; false if the levels and leads make no model.
inline bool tilted_poles(std::vector<TiltedLevel> levels, const TiltedLeads& leads, double hop, double window,
                         std::vector<TiltedPole>& out) {
    if (levels.empty()) return false;
    std::erase_if(levels, [&](const TiltedLevel& level) {
        double seen = 0.0;
        for (const auto& entry : level.w) seen += square(entry);
        return hop * seen < INVISIBLE;
    });
    TiltedSums sums(levels);
    auto is_near = [&](const TiltedLevel& level) { return level.E < detail::NEAR_TILTED * window; };
    const int near = int(std::count_if(levels.begin(), levels.end(), is_near));
    std::vector<Zero> zeros = detail::starts(levels, near, leads, sums);
    auto slope = [&](PoleComplex z) {
        sums.fill(z);
        return PoleComplex(sums.resolvents(near) - trace(sums.undressed(leads, z), sums.change(leads, z)));
    };
    if (!settle(zeros, slope)) return false;
    detail::complete_pairs(zeros);
    for (const Zero& zero : zeros)
        if (!(zero.z.imag() <= detail::FEEDS * window)) return false;
    const std::vector<int> all = first_numbers(zeros.size());
    for (size_t first = 0; first < all.size(); first += POLES) {
        const auto r = detail::residues(leads, sums, load(zeros, all, first));
        for (int l = 0; l < POLES && first + l < all.size(); ++l) {
            const Zero& zero = zeros[first + l];
            TiltedPole pole{zero.z, {}}, image{-std::conj(zero.z), {}};
            for (int k = 0; k < 4; ++k) {
                pole.residue[k] = of_lane(r.at[0][k], l);
                image.residue[k] = {-r.at[1][k].re[l], r.at[1][k].im[l]};
            }
            out.push_back(pole);
            if (zero.mirrored) out.push_back(image);
        }
    }
    return true;
}

}  // namespace core
