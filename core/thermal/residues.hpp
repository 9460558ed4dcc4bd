// Conductances as sums over poles, G₀(ω) = Σ 2 Re[r/(ω − z)] + smooth.
//
// A probability is Tr[Γ_a G_ab Γ_b G_ab†].  On the real axis G† is the function G(z*)†, which is analytic
// where G has its poles z.  So the residue of the probability at z is
//
//     r_ab = (Γ_a v_a)ᵀ [G_ab(z*)]* (Γ_b v_b),   Γ = −2 Im Σ continued from the real axis,
//
// and the thermal average of every term has a closed form (trigamma.hpp).  As G_iso(z*)* is G_iso(z),
// [G(z*)]* = S̄ M̄⁻¹ S̄ − S̄ with S̄(z) = S(z*)* and M̄ = S̄ − G_iso(z) (dressing.hpp).
//
// Where the levels of wire and parent are broadened by Γ, G_iso is taken at z + iΓ, and its conjugate at z − iΓ.  What
// comes in and is absorbed is −2 Im Tr ΓG less what comes back: with that, no sum over probabilities is needed.
#pragma once

#include "../leads/btk.hpp"
#include "../poles/resonances.hpp"

namespace core {

// The poles' 2 Re[r/(ω − z)] in each conductance, for electrons, then holes incident; a hole's r is 0 where a
// pole is its own mirror image.  Up to a multiple of COLUMNS, terms of r = 0 follow.
struct PoleTerms {
    int count;
    Row values;
    double *x, *y, *re[2][4], *im[2][4];  // z = x + iy

    explicit PoleTerms(int count) : count(count), values(18 * size_t(padded(count)), 0.0) {
        double* next = values.data();
        auto take = [&] { return std::exchange(next, next + padded(count)); };
        x = take(), y = take();
        for (int k = 0; k < 8; ++k) re[k / 4][k % 4] = take(), im[k / 4][k % 4] = take();
        std::fill(y, y + padded(count), -1.0);
    }
    // Leave out poles beyond the gap, of which the levels below it tell nothing.  What they make below it is smooth in τ.
    void leave_out_beyond(double gap) {
        for (int n = 0; n < count; ++n)
            for (int k = 0; k < 8 && x[n] > gap; ++k) re[k / 4][k % 4][n] = im[k / 4][k % 4][n] = 0.0;
    }
    PoleTerms(PoleTerms&&) = default;  // the numbers stay where they are
    PoleTerms& operator=(PoleTerms&&) = default;
};

namespace detail {

// The parts of y on Le, Lh, Re, Rh, in the chiral basis: the electrons' part of (c₊, c₋) is
// (c₊ + c₋, c₊ + c₋)/2, the holes' (c₊ − c₋, c₋ − c₊)/2.
inline void split_channels(const Ends8& y, Ends8 (&c)[CHANNELS]) {
    for (auto& part : c) part.fill(PoleComplex(0.0));
    for (int end = 0; end < 2; ++end)
        for (int i = 0; i < 2; ++i) {
            int at = 2 * end + i, to = 4 + at;
            PoleComplex even = (y[at] + y[to]) * PoleReal(0.5), odd = (y[at] - y[to]) * PoleReal(0.5);
            c[2 * end][at] = c[2 * end][to] = even;
            c[2 * end + 1][at] = odd, c[2 * end + 1][to] = -odd;
        }
}

// The residues of the conductances of POLES poles, at b.z = z + iΓ of a wire with levels broadened by Γ.
inline Conductances<PoleComplex> residues(const Leads& leads, double width, Batch& b) {
    Ends8 v, y, c[CHANNELS], f[CHANNELS], same[CHANNELS];
    b.S.fill(leads.inverse, b.z);
    b.S.multiply(b.t, v);
    b.S.fill(leads.gamma, b.z);
    b.S.multiply(v, y);
    split_channels(y, c);
    const PoleComplex z = b.z;
    b.z.im = b.z.im - 2 * width;
    b.factor_at_energies(leads.conjugate);
    b.z = z;
    for (int channel = 0; channel < CHANNELS; ++channel) b.S.multiply(c[channel], f[channel]);
    PoleComplex P[4][4];
    for (int end = 0; end < 2; ++end) {  // −c_a S̄ c_b, for channels on one end
        PoleComplex start(0.0);
        for (int i : ENDS[end]) start = start - c[2 * end][i] * f[2 * end + 1][i];
        P[2 * end][2 * end + 1] = start;
    }
    for (int channel = 0; channel < CHANNELS; ++channel) same[channel] = f[channel], b.M.solve_lower(f[channel]);
    PoleComplex over = inverse(b.norm);  // v is √norm times the pole's
    for (int a = 0; a < CHANNELS; ++a) {
        for (int o = a + 1; o < CHANNELS; ++o)
            P[a][o] = P[o][a] = over * b.M.add_product(f[a], f[o], a / 2 == o / 2 ? P[a][o] : PoleComplex(0.0));
    }
    if (width == 0) return lossless_conductances(P);
    PoleComplex net[4];
    for (int a = 0; a < CHANNELS; ++a) {
        PoleComplex reflected(0.0), absorbed(0.0);  // −c_a S̄ c_a, and v_a Γ v_a
        for (int i : ENDS[a / 2]) reflected = reflected - c[a][i] * same[a][i], absorbed = absorbed + v[i] * c[a][i];
        net[a] = over * (PoleComplex(-absorbed.im, absorbed.re) - b.M.add_product(f[a], f[a], reflected));
    }
    return conductances(P, net);
}

}  // namespace detail

inline PoleTerms conductance_terms(const Resonances& found, const Leads& leads, double width, Batch& batch) {
    int count = int(found.order.size());
    PoleTerms terms(count);
    for (int first = 0; first < count; first += POLES) {
        for (int l = 0; l < POLES; ++l) batch.load(l, found.poles[found.order[std::min(first + l, count - 1)]]);
        auto r = detail::residues(leads, width, batch);
        for (int l = 0; l < POLES && first + l < count; ++l) {
            int at = first + l;
            terms.x[at] = batch.z.re[l], terms.y[at] = batch.z.im[l] - width;
            for (int hole = 0; hole < (at < found.paired ? 2 : 1); ++hole)
                for (int k = 0; k < 4; ++k) terms.re[hole][k][at] = r.at[hole][k].re[l], terms.im[hole][k][at] = r.at[hole][k].im[l];
        }
    }
    return terms;
}

// Σ 2 Re[r/(ω − z)] over all poles at COLUMNS real ω of either sign.  A mirror image −z* has the residue −r̄*
// of the other incident charge.
inline void sum_poles(const PoleTerms& terms, Columns omega, Columns (&out)[4]) {
    for (auto& total : out) total = 0.0;
    for (int n = 0; n < terms.count; ++n) {
        double x = terms.x[n], y = terms.y[n];
        Columns below = omega - x, above = omega + x, square = y * y;
        Columns near = square + below * below, far = square + above * above;
        Columns over = 2.0 * inverse(Columns(near * far)), to_near = over * far, to_far = over * near;
        Columns a = below * to_near, b = y * to_near, c = above * to_far, d = y * to_far;
        for (int k = 0; k < 4; ++k) {
            out[k] = out[k] + a * terms.re[0][k][n] - b * terms.im[0][k][n];
            out[k] = out[k] - c * terms.re[1][k][n] - d * terms.im[1][k][n];
        }
    }
}

}  // namespace core
