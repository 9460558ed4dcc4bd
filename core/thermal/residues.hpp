// Conductances as sums over poles, G₀(ω) = Σ 2 Re[r/(ω − z)] + smooth.
//
// A probability is Tr[Γ_a G_ab Γ_b G_ab†].  On the real axis G† is the function G(z*)†, which is analytic
// where G has its poles z.  So the residue of the probability at z is
//
//     r_ab = (Γ_a v_a)ᵀ [G_ab(z*)]* (Γ_b v_b),   Γ = −2 Im Σ continued from the real axis,
//
// and the thermal average of every term has a closed form (trigamma.hpp).  As G_iso(z*)* is G_iso(z),
// [G(z*)]* = S̄ M̄⁻¹ S̄ − S̄ with S̄(z) = S(z*)* and M̄ = S̄ − G_iso(z) (dressing.hpp).
#pragma once

#include "../leads/btk.hpp"
#include "../poles/resonances.hpp"

namespace core {

// One pole's 2 Re[r/(ω − z)] in each conductance, for electrons, then holes incident; a hole's r is 0 where a
// pole is its own mirror image.
struct Term {
    Amplitude z, r[2][4];
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

// The residues of the conductances of POLES poles.
inline Conductances<PoleComplex> residues(const Leads& leads, Batch& b) {
    Ends8 v, y, c[CHANNELS], f[CHANNELS];
    b.S.fill(leads.inverse, b.z);
    b.S.multiply(b.t, v);
    for (int l = 0; l < POLES; ++l) {
        Amplitude over = 1.0 / std::sqrt(Amplitude(b.norm.re[l], b.norm.im[l]));
        for (auto& entry : v) Batch::set(entry, l, Amplitude(entry.re[l], entry.im[l]) * over);
    }
    b.S.fill(leads.gamma, b.z);
    b.S.multiply(v, y);
    split_channels(y, c);
    b.factor_at_energies(leads.conjugate);
    for (int channel = 0; channel < CHANNELS; ++channel) b.S.multiply(c[channel], f[channel]);
    PoleComplex P[4][4];
    for (int end = 0; end < 2; ++end) {  // −c_a S̄ c_b, for channels on one end
        PoleComplex start(0.0);
        for (int i : ENDS[end]) start = start - c[2 * end][i] * f[2 * end + 1][i];
        P[2 * end][2 * end + 1] = start;
    }
    for (auto& x : f) b.M.solve_lower(x);
    for (int a = 0; a < CHANNELS; ++a) {
        P[a][a] = PoleComplex(0.0);
        for (int o = a + 1; o < CHANNELS; ++o)
            P[a][o] = P[o][a] = b.M.add_product(f[a], f[o], a / 2 == o / 2 ? P[a][o] : PoleComplex(0.0));
    }
    return lossless_conductances(P);
}

}  // namespace detail

inline std::vector<Term> conductance_terms(const Resonances& found, const Leads& leads, Batch& batch) {
    std::vector<Term> terms;
    size_t count = found.order.size();
    for (size_t first = 0; first < count; first += POLES) {
        for (size_t l = 0; l < POLES; ++l) batch.load(int(l), found.poles[found.order[std::min(first + l, count - 1)]]);
        auto r = detail::residues(leads, batch);
        for (size_t l = 0; l < POLES && first + l < count; ++l) {
            Term term{found.poles[found.order[first + l]].z, {}};
            for (int hole = 0; hole < (int(first + l) < found.paired ? 2 : 1); ++hole)
                for (int k = 0; k < 4; ++k) term.r[hole][k] = {r.at[hole][k].re[int(l)], r.at[hole][k].im[int(l)]};
            terms.push_back(term);
        }
    }
    return terms;
}

// Σ 2 Re[r/(ω − z)] over all poles at COLUMNS real ω of either sign.  A mirror image −z* has the residue −r̄*
// of the other incident charge.
inline void sum_poles(const std::vector<Term>& terms, Columns omega, Columns (&out)[4]) {
    for (auto& total : out) total = 0.0;
    for (const Term& term : terms) {
        double x = term.z.real(), y = term.z.imag();
        Columns below = omega - x, above = omega + x, square = y * y;
        Columns near = 2.0 * inverse(square + below * below), far = 2.0 * inverse(square + above * above);
        Columns a = below * near, b = y * near, c = above * far, d = y * far;
        for (int k = 0; k < 4; ++k) {
            out[k] = out[k] + a * term.r[0][k].real() - b * term.r[0][k].imag();
            out[k] = out[k] - c * term.r[1][k].real() - d * term.r[1][k].imag();
        }
    }
}

}  // namespace core
