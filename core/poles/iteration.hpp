// Poles of the wire with its leads, by inverse iteration on H(z), several poles at once.
//
// In the space of the levels this is H(z) = E + UᵀΣ(z)U, with the levels ±E and what the ends see of them,
// U.  One step takes x to (z − H)⁻¹x = R x + R Uᵀ t, M t = U R x (dressing.hpp), and z to
//
//     z − x_newᵀ x_old / x_newᵀ(1 − H')x_new,    xᵀ(1 − H')x = xᵀx + tᵀS't,
//
// the symmetric Rayleigh quotient (no conjugation), which converges cubically: with the starts of
// starts.hpp the second step moves poles by less than CONVERGED in nearly all sets.  No expansion in the
// coupling is left.  As U x_new = S t, a pole's v, G ≈ v vᵀ/(ω − z), needs no further sum.
#pragma once

#include "aberth.hpp"
#include "starts.hpp"

namespace core {

constexpr int STEPS = 2;          // steps of a batch before it is looked at
constexpr int ROUNDS = 8;         // most batches per pole
constexpr double CENTRAL = 1e-7;  // poles with |Re z| below this (meV) are their own mirror images −z*
// A pole has converged if before the last step it was off by less than this part of its width, and of the way
// to the next pole, whose vector is mixed in by as much: cubically, 1e-11 is left.  It was off by
// |x_old||x_new|/|x_newᵀ(1 − H')x_new| at most; the quotient itself may stand still elsewhere, where two poles
// all but meet.  There residues of opposite sign are large, and so are their errors.
constexpr double CONVERGED = 3e-4;

// POLES poles, and room to work on them.
class Batch {
    const Levels& levels;
    std::vector<PoleComplex> own, old;  // room for x, over +E, then −E
    PoleComplex* x = nullptr;
    PoleReal scale{};  // of x, against overflow
    Resolvents R;

public:
    PoleComplex z{}, norm{};
    Ends8 t{};
    CubicValues S;
    DressedEnds M;

    explicit Batch(const Levels& of) : levels(of), own(2 * of.size()), old(2 * of.size()), R(of.size()) {}

    // Factor M = S − G_iso at the energies z.
    void factor_at_energies(const Cubic& inverse) {
        R.fill(z, levels.E);
        S.fill(inverse, z);
        M.fill(levels, R, S, z);
    }

    // f'/f of f = det M ∏(z² − E²) over some levels at the energies `at`, Tr M⁻¹M' + Σ 1/(z − E) + 1/(z + E).  Of the trace
    // M⁻¹ = Σ x xᵀ/Δ, x the columns of L⁻ᵀ.
    PoleComplex slope_of_determinant(const Leads& leads, const std::vector<int>& some, PoleComplex at) {
        z = at;
        factor_at_energies(leads.inverse);
        PoleComplex total(0.0);
        for (int n : some) total = total + R.of[n].even;
        for (int k = 0; k < 8; ++k) {
            t.fill(PoleComplex(0.0));
            t[k] = PoleComplex(1.0);
            M.solve_upper(t);
            norm = PoleComplex(0.0);
            for (int n = 0; n < levels.size(); ++n) {
                auto [up, down] = answer(n);
                norm = norm + up * up + down * down;
            }
            add_slopes(leads);
            total = total + norm * M.over[k];
        }
        return total;
    }

    // Fill in the vectors of the poles at z, x ∝ R Uᵀ t with M t = 0.
    void find_vectors(const Leads& leads, PoleVectors& vectors, int first, int count) {
        factor_at_energies(leads.inverse);
        for (int i = 0; i < 8; ++i) t[i] = PoleComplex(1.0 / (i + 1));
        M.solve(t);
        PoleReal size = 0.0;
        for (const auto& entry : t) size = size + square(entry);
        size = inverse(root(size));
        for (auto& entry : t) entry = entry * size;
        for (int n = 0, half = levels.size(); n < half; ++n) {
            auto [up, down] = answer(n);
            for (int l = 0; l < count; ++l) vectors.set(first + l, n, of_lane(up, l)), vectors.set(first + l, half + n, of_lane(down, l));
        }
    }

    // What a pole's residue needs.
    void load(int lane, const Pole& pole) {
        set_lane(z, lane, pole.z), set_lane(norm, lane, pole.norm);
        for (int i = 0; i < 8; ++i) set_lane(t[i], lane, pole.t[i]);
    }

    // Take `steps` steps with some of the poles; write how far each was off before the last one.
    void iterate(std::vector<Pole>& poles, PoleVectors& vectors, const int* which, int count, int steps, const Leads& leads,
                 double* off) {
        int block = which[0] / POLES;
        bool whole = which[0] % POLES == 0 && count == std::min(POLES, int(poles.size()) - which[0]);
        for (int l = 0; l < count; ++l) whole = whole && which[l] == which[0] + l;
        x = whole ? vectors.block(block) : own.data();
        for (int l = 0; l < POLES; ++l) {
            int p = which[std::min(l, count - 1)];
            load(l, poles[p]);
            if (!whole)
                for (int k = 0; k < 2 * levels.size(); ++k) set_lane(x[k], l, vectors.get(p, k));
        }
        scale = 1.0;
        for (int step = 0; step < steps; ++step) improve(leads);
        PoleReal before = 0.0, after = 0.0;
        for (int k = 0; k < 2 * levels.size(); ++k) {
            x[k] = x[k] * scale;
            after = after + x[k].re * x[k].re + x[k].im * x[k].im;
            before = before + old[k].re * old[k].re + old[k].im * old[k].im;
        }
        before = root(PoleReal(before * after)) * scale;
        for (auto& entry : t) entry = entry * scale;
        norm = norm * PoleReal(scale * scale);
        for (int l = 0; l < count; ++l) {
            Pole& pole = poles[which[l]];
            pole.z = of_lane(z, l), pole.norm = of_lane(norm, l);
            for (int i = 0; i < 8; ++i) pole.t[i] = of_lane(t[i], l);
            if (!whole)
                for (int k = 0; k < 2 * levels.size(); ++k) vectors.set(which[l], k, of_lane(x[k], l));
            off[l] = before[l];
        }
    }

private:
    // Improve the poles and their vectors by one step.
    void improve(const Leads& leads) {
        factor_at_energies(leads.inverse);
        apply_resolvent();
        M.solve(t);
        PoleComplex overlap = add_mixed();
        add_slopes(leads);
        PoleComplex shift = overlap * inverse(norm);
        z.re = z.re - shift.re;
        PoleReal below = z.im - shift.im, least = -1e-16;
        z.im = where_greater(below, least, least, below);
        scale = inverse(root(root(square(norm))));
    }

    // Uᵀ y at ±E of a level.
    std::pair<PoleComplex, PoleComplex> at_level(int n, const Ends8& y) const {
        PoleComplex first(0.0), second(0.0);
        const auto& weight = levels.weight[n];
        for (int i = 0; i < 4; ++i) first = first + y[i] * PoleReal(weight[i]);
        for (int i = 4; i < 8; ++i) second = second + y[i] * PoleReal(weight[i]);
        return {first + second, first - second};
    }
    // R Uᵀ t at ±E of a level.
    std::pair<PoleComplex, PoleComplex> answer(int n) const {
        auto [above, below] = at_level(n, t);
        return {above * R.of[n].up, below * R.of[n].down};
    }

    // Add tᵀM't less what the levels of x give to the norm.
    void add_slopes(const Leads& leads) { norm = norm + slope_between(leads.inverse, t, z) - levels.far.slope_between(t, t, z); }

    // x ← R x, t ← U R x.
    void apply_resolvent() {
        Ends8 sum;
        sum.fill(PoleComplex(0.0));
        for (int n = 0, half = levels.size(); n < half; ++n) {
            PoleComplex up = x[n] * scale, down = x[half + n] * scale;
            old[n] = up, old[half + n] = down;
            up = up * R.of[n].up, down = down * R.of[n].down;
            x[n] = up, x[half + n] = down;
            PoleComplex even = up + down, odd = up - down;
            const auto& weight = levels.weight[n];
            for (int i = 0; i < 4; ++i) sum[i] = sum[i] + even * PoleReal(weight[i]);
            for (int i = 4; i < 8; ++i) sum[i] = sum[i] + odd * PoleReal(weight[i]);
        }
        t = sum;
    }

    // x ← x + R Uᵀ t; the norm becomes xᵀx.  Return xᵀx_old.
    PoleComplex add_mixed() {
        const Ends8 added = t;
        PoleComplex overlap(0.0), total(0.0);
        for (int n = 0, half = levels.size(); n < half; ++n) {
            auto [above, below] = at_level(n, added);
            PoleComplex up = x[n] + above * R.of[n].up, down = x[half + n] + below * R.of[n].down;
            x[n] = up, x[half + n] = down;
            total = total + up * up + down * down;
            overlap = overlap + up * old[n] + down * old[half + n];
        }
        norm = total;
        return overlap;
    }
};

// How far from pole p the next one, or the mirror image of one, is.
inline double isolation(const std::vector<Pole>& poles, size_t p) {
    double x = poles[p].z.real(), y = poles[p].z.imag();
    double nearest = std::abs(x) > CENTRAL ? 4 * x * x : INFINITY;
    for (size_t k = 0; k < poles.size(); ++k)
        if (k != p) {
            double across = std::abs(x) - std::abs(poles[k].z.real()), along = y - poles[k].z.imag();
            nearest = std::min(nearest, across * across + along * along);
        }
    return std::sqrt(nearest);
}

// Iterate the active poles in place.  The norm of a pole that does not converge is NaN.
inline void iterate(std::vector<Pole>& poles, PoleVectors& vectors, std::vector<int> active, const Leads& leads, Batch& batch) {
    std::vector<double> off(active.size());
    for (int round = 0; round < ROUNDS && !active.empty(); ++round) {
        int count = int(active.size());
        for (int first = 0; first < count; first += POLES)
            batch.iterate(poles, vectors, &active[first], std::min(POLES, count - first), STEPS, leads, &off[first]);
        std::vector<int> left;  // once all have moved, so that batches of any size end alike
        for (int k = 0; k < count; ++k) {
            int p = active[k];
            if (!(off[k] <= CONVERGED * (FAINT + std::min(-poles[p].z.imag(), isolation(poles, p))))) left.push_back(p);
        }
        active = left;
    }
    for (int p : active) poles[p].norm = NAN;
}

}  // namespace core
