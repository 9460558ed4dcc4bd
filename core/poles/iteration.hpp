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

#include "starts.hpp"

namespace core {

constexpr double FAINT = 1e-9;    // widths below this (meV) carry no conductance and need no digits
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
    std::vector<PoleComplex> up, down, old_up, old_down;  // x over +E and over −E
    Resolvents R;

public:
    PoleComplex z{}, norm{};
    PoleReal scale{};  // of x, against overflow
    Ends8 t{};
    CubicValues S;
    DressedEnds M;

    explicit Batch(const Levels& of)
        : levels(of), up(of.size()), down(of.size()), old_up(of.size()), old_down(of.size()), R(of.size()) {}

    // Factor M = S − G_iso at the energies z.
    void factor_at_energies(const Cubic& inverse) {
        R.fill(z, levels.E);
        S.fill(inverse, z);
        M.fill(levels, R, S);
    }

    void load(int lane, const Pole& pole) {
        set(z, lane, pole.z);
        set(norm, lane, pole.norm);
        scale.set(lane, 1.0);
        for (int i = 0; i < 8; ++i) set(t[i], lane, pole.t[i]);
        int n = levels.size();
        for (int k = 0; k < n; ++k) {
            set(up[k], lane, {pole.x[k], pole.x[n + k]});
            set(down[k], lane, {pole.x[2 * n + k], pole.x[3 * n + k]});
        }
    }

    // Take a lane back into its pole; return how far the pole was off before the last step.
    double take(int lane, Pole& pole) const {
        int n = levels.size();
        double factor = scale[lane], before = 0.0, after = 0.0;
        for (int k = 0; k < n; ++k) {
            double now[4] = {up[k].re[lane], up[k].im[lane], down[k].re[lane], down[k].im[lane]};
            double then[4] = {old_up[k].re[lane], old_up[k].im[lane], old_down[k].re[lane], old_down[k].im[lane]};
            for (int part = 0; part < 4; ++part) {
                double x = pole.x[part * n + k] = now[part] * factor;
                after += x * x;
                before += then[part] * then[part];
            }
        }
        for (int i = 0; i < 8; ++i) pole.t[i] = Amplitude(t[i].re[lane], t[i].im[lane]) * factor;
        pole.norm = Amplitude(norm.re[lane], norm.im[lane]) * (factor * factor);
        pole.z = Amplitude(z.re[lane], z.im[lane]);
        return std::sqrt(before * after) * factor;
    }

    // Improve the poles and their vectors.
    void step(const Leads& leads) {
        factor_at_energies(leads.inverse);
        apply_resolvent();
        M.solve(t);
        PoleComplex overlap = add_mixed();
        add_slope();
        PoleComplex shift = overlap * inverse(norm);
        z.re = z.re - shift.re;
        PoleReal below = z.im - shift.im, least = -1e-16;
        z.im = where_greater(below, least, least, below);
        scale = inverse(root(root(square(norm))));
    }

    static void set(PoleComplex& x, int lane, Amplitude value) {
        x.re.set(lane, value.real());
        x.im.set(lane, value.imag());
    }

private:
    // x ← R x, t ← U R x.
    void apply_resolvent() {
        for (auto& entry : t) entry = PoleComplex(0.0);
        for (int n = 0; n < levels.size(); ++n) {
            old_up[n] = up[n] * scale, old_down[n] = down[n] * scale;
            up[n] = old_up[n] * R.up[n], down[n] = old_down[n] * R.down[n];
            PoleComplex even = up[n] + down[n], odd = up[n] - down[n];
            for (int i = 0; i < 4; ++i) t[i] = t[i] + even * PoleReal(levels.weight[n][i]);
            for (int i = 4; i < 8; ++i) t[i] = t[i] + odd * PoleReal(levels.weight[n][i]);
        }
    }

    // x ← x + R Uᵀ t; the norm becomes xᵀx.  Return xᵀx_old.
    PoleComplex add_mixed() {
        PoleComplex overlap(0.0), total(0.0);
        for (int n = 0; n < levels.size(); ++n) {
            PoleComplex first(0.0), second(0.0);
            for (int i = 0; i < 4; ++i) first = first + t[i] * PoleReal(levels.weight[n][i]);
            for (int i = 4; i < 8; ++i) second = second + t[i] * PoleReal(levels.weight[n][i]);
            up[n] = up[n] + (first + second) * R.up[n];
            down[n] = down[n] + (first - second) * R.down[n];
            total = total + up[n] * up[n] + down[n] * down[n];
            overlap = overlap + up[n] * old_up[n] + down[n] * old_down[n];
        }
        norm = total;
        return overlap;
    }

    // Add tᵀS't to the norm.
    void add_slope() {
        int at = 0;
        for (int end = 0; end < 2; ++end)
            for (int i = 0; i < 4; ++i)
                for (int j = i; j < 4; ++j, ++at) {
                    PoleComplex pair = t[ENDS[end][i]] * t[ENDS[end][j]];
                    norm = norm + S.slope[at] * pair;
                    if (i != j) norm = norm + S.slope[at] * pair;
                }
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
inline void iterate(std::vector<Pole>& poles, std::vector<int> active, const Leads& leads, Batch& batch) {
    for (int round = 0; round < ROUNDS && !active.empty(); ++round) {
        std::vector<double> off;
        for (size_t first = 0; first < active.size(); first += POLES) {
            size_t some = std::min(size_t(POLES), active.size() - first);
            for (size_t l = 0; l < POLES; ++l) batch.load(int(l), poles[active[first + std::min(l, some - 1)]]);
            for (int step = 0; step < STEPS; ++step) batch.step(leads);
            for (size_t l = 0; l < some; ++l) off.push_back(batch.take(int(l), poles[active[first + l]]));
        }
        std::vector<int> left;  // once all have moved, so that batches of any size end alike
        for (size_t k = 0; k < active.size(); ++k) {
            int p = active[k];
            if (!(off[k] <= CONVERGED * (FAINT + std::min(-poles[p].z.imag(), isolation(poles, p))))) left.push_back(p);
        }
        active = left;
    }
    for (int p : active) poles[p].norm = NAN;
}

}  // namespace core
