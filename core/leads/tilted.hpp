// Self-energies of the normal leads in a field that is tilted by θ against the wire.
//
// With h = V_Z cos θ, v = V_Z sin θ and w = v + 2s sin k the electron block of self_energy.hpp is
// ε(k) + hσx + wσy, and its modes λ = e^{ik} at energy E solve m² = h² + w², m = E' + t(λ + 1/λ):
//
//     (t²+s²)(λ⁴ + 1) + 2(tE' + isv)λ³ + 2(tE' − isv)λ + (E'² + 2t² − 2s² − v² − h²)λ² = 0.
//
// The roots come in pairs λ, 1/λ*, of which one is outgoing to the right: it decays, or its group
// velocity 2t sin k + 2sw cos k/m points there.  With spinors u in the columns of U, the right lead's
// self-energy is T F, F = U λ U⁻¹, T the hopping.  The mirror takes θ to −θ and that transposes, so
// that the left lead's is σx Σᵀ σx, and holes are those of self_energy.hpp.
//
// Where spins are all but degenerate, the spinors lose all digits.  So F is only the start of Newton's
// iteration for T F² − (E − H₀) F + T† = 0; and where V_Z is small, compared with what it takes to make
// an outgoing mode meet an incoming one, the start is F without a field.
#pragma once

#include <algorithm>
#include <limits>
#include <utility>

#include "self_energy.hpp"

namespace core {

inline Spin2 operator*(const Spin2& A, const Spin2& B) {
    Spin2 out{};
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) out(i, j) = A(i, 0) * B(0, j) + A(i, 1) * B(1, j);
    return out;
}
inline Spin2 operator+(const Spin2& A, const Spin2& B) {
    return {{{A(0, 0) + B(0, 0), A(0, 1) + B(0, 1)}, {A(1, 0) + B(1, 0), A(1, 1) + B(1, 1)}}};
}
inline Spin2 inverse(const Spin2& A) {
    Amplitude over = 1.0 / (A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0));
    return {{{A(1, 1) * over, -A(0, 1) * over}, {-A(1, 0) * over, A(0, 0) * over}}};
}

namespace detail {

constexpr double ON_THE_CIRCLE = 1e-7;  // how close to 1 |λ| is taken for that of a propagating mode
// By up to this part of the distance between outgoing and incoming modes, of any spin, the field may move them
// for the iteration to start without it.
constexpr double SMALL = 0.02;
// V_Z/t' up to which the field is left out where incoming and outgoing modes of two spins cross: there rounding
// moves the modes, all but twofold roots, by as much.
constexpr double NEGLIGIBLE = 1e-8;
constexpr int NEWTON_STEPS = 6;         // from 0.02 it takes four

// The roots of λ⁴ + cλ³ + qλ² + c*λ + 1 by Aberth's iteration (Math. Comp. 27, 339, 1973), each until
// what is left is rounding.
inline void find_roots(Amplitude c, double q, Amplitude (&root)[4]) {
    constexpr int STEPS = 100;
    constexpr double ROUNDING = 4 * std::numeric_limits<double>::epsilon();
    for (int k = 0; k < 4; ++k) root[k] = std::polar(1.0, 0.4 + k * 1.5707963267948966);
    bool done[4] = {};
    for (int step = 0; step < STEPS && !(done[0] && done[1] && done[2] && done[3]); ++step)
        for (int k = 0; k < 4; ++k) {
            Amplitude z = root[k], repelled = 0.0;
            double r = std::abs(z), rc = std::abs(c);
            Amplitude value = (((z + c) * z + q) * z + std::conj(c)) * z + 1.0;
            Amplitude slope = ((4.0 * z + 3.0 * c) * z + 2 * q) * z + std::conj(c);
            done[k] = std::abs(value) <= ROUNDING * ((((r + rc) * r + std::abs(q)) * r + rc) * r + 1);
            if (done[k]) continue;
            for (int j = 0; j < 4; ++j)
                if (j != k && root[j] != z) repelled += 1.0 / (z - root[j]);
            root[k] = z - value / (slope - value * repelled);
        }
}

// Solve M x = b by elimination with partial pivoting; x is returned in b.
inline void solve(Amplitude (&M)[4][4], Amplitude (&b)[4]) {
    for (int k = 0; k < 4; ++k) {
        int pivot = k;
        for (int i = k + 1; i < 4; ++i)
            if (std::abs(M[i][k]) > std::abs(M[pivot][k])) pivot = i;
        std::swap(M[k], M[pivot]);
        std::swap(b[k], b[pivot]);
        for (int i = k + 1; i < 4; ++i) {
            Amplitude factor = M[i][k] / M[k][k];
            for (int j = k + 1; j < 4; ++j) M[i][j] -= factor * M[k][j];
            b[i] -= factor * b[k];
        }
    }
    for (int i = 3; i >= 0; --i) {
        for (int j = i + 1; j < 4; ++j) b[i] -= M[i][j] * b[j];
        b[i] /= M[i][i];
    }
}

// The solution near F of T F² + H F + T† = 0 with real T, H = H₀ − E, by Newton's iteration: each step
// T(F dF + dF F) + H dF is linear in the four entries of dF.
inline Spin2 refined(Spin2 F, const Spin2& T, const Spin2& H) {
    Spin2 best = F, adjoint{{{T(0, 0), T(1, 0)}, {T(0, 1), T(1, 1)}}};
    double least = std::numeric_limits<double>::infinity(), scale = std::abs(T(0, 0));
    for (int step = 0; step <= NEWTON_STEPS; ++step) {
        Spin2 left = T * F + H, rest = left * F + adjoint;
        double size = 0;
        for (int k = 0; k < 4; ++k) size = std::max(size, std::abs(rest(k / 2, k % 2)));
        if (size < least)
            best = F, least = size;
        else if (least < 1e-12 * scale)  // where only rounding is left
            break;
        Amplitude M[4][4], dF[4];
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) {
                dF[2 * i + j] = rest(i, j);
                for (int k = 0; k < 2; ++k)
                    for (int l = 0; l < 2; ++l)
                        M[2 * i + j][2 * k + l] = T(i, k) * F(l, j) + (j == l ? left(i, k) : 0.0);
            }
        solve(M, dF);
        for (int k = 0; k < 4; ++k) F(k / 2, k % 2) -= dF[k];
    }
    return best;
}

// F of the modes that are outgoing to the right; shifted is E', along h and across v.
inline Spin2 from_modes(double shifted, double t, double s, double along, double across) {
    constexpr Amplitude I(0.0, 1.0);
    double hop2 = t * t + s * s;
    Amplitude root[4];
    find_roots(2.0 * Amplitude(t * shifted, s * across) / hop2,
               (shifted * shifted + 2 * t * t - 2 * s * s - across * across - along * along) / hop2, root);
    double inwards[4];
    Amplitude spinor[4][2];
    for (int k = 0; k < 4; ++k) {
        Amplitude lambda = root[k], over = 1.0 / lambda;
        Amplitude m = shifted + t * (lambda + over), w = across - I * s * (lambda - over);
        // of the columns of m + hσx + wσy the one that cannot vanish
        Amplitude up = along + I * w, down = along - I * w;
        bool first = std::norm(up) > std::norm(down);
        double size = std::sqrt(std::norm(m) + std::norm(first ? up : down));
        spinor[k][0] = (first ? m : down) / size;
        spinor[k][1] = (first ? up : m) / size;
        double slope = m == 0.0 ? 0.0 : (w / m).real();
        double velocity = 2 * t * lambda.imag() + 2 * s * slope * lambda.real();
        bool propagates = std::abs(std::abs(lambda) - 1) < ON_THE_CIRCLE;
        inwards[k] = propagates ? (velocity > 0 ? -1 : velocity < 0 ? 1 : 0) * ON_THE_CIRCLE : std::log(std::abs(lambda));
    }
    int mode[4] = {0, 1, 2, 3};
    std::sort(mode, mode + 4, [&](int a, int b) { return inwards[a] < inwards[b]; });
    int a = mode[0], b = mode[1];
    Spin2 U{{{spinor[a][0], spinor[b][0]}, {spinor[a][1], spinor[b][1]}}};
    Spin2 shift{{{root[a], 0.0}, {0.0, root[b]}}};
    return U * shift * inverse(U);
}

// The right lead's electron block at energy E, in meV.
inline Spin2 tilted_electron_self_energy(double E, const LeadParameters& lead, double theta) {
    double t = lead.t, s = lead.s, cos = std::cos(theta), sin = std::sin(theta);
    double along = lead.zeeman * cos, across = lead.zeeman * sin;
    if (s == 0) {  // spins are along the field, or against it, at every energy
        Spin2 straight = electron_self_energy(E, lead);
        Amplitude same = straight(0, 0), turned = straight(0, 1);
        return {{{same, turned * Amplitude(cos, -sin)}, {turned * Amplitude(cos, sin), same}}};
    }
    double shifted = E - 2 * t + lead.mu, hop = std::hypot(t, s), zeeman = std::abs(lead.zeeman);
    Amplitude cosine = -shifted / (2 * hop);  // of k without field, but for ±atan(s/t)
    Amplitude sine = std::sqrt(1.0 - cosine * cosine);
    double apart = std::min({std::abs(sine), std::abs(sine * t + cosine * s) / hop, std::abs(sine * t - cosine * s) / hop});
    bool small = zeeman < 4 * SMALL * hop * std::abs(sine) * apart, lost = !small && zeeman < NEGLIGIBLE * hop;
    LeadParameters free = lead;
    free.zeeman = 0;
    if (lost) return electron_self_energy(E, free);
    Spin2 T{{{-t, -s}, {s, -t}}};
    Spin2 F = small ? inverse(T) * electron_self_energy(E, free) : from_modes(shifted, t, s, along, across);
    Spin2 H{{{-shifted, Amplitude(along, -across)}, {Amplitude(along, across), -shifted}}};
    return T * refined(F, T, H);
}

}  // namespace detail

// Both leads' Σ at one energy in their own frame, in meV.
inline LeadSelfEnergy tilted_self_energy_of_leads(const Wire& wire, double B, double omega, double theta) {
    LeadParameters lead(wire, B);
    if (lead.zeeman == 0) return self_energy_of_leads(wire, B, omega);  // any angle is the same
    return of_both_leads(detail::tilted_electron_self_energy(omega, lead, theta),
                         detail::tilted_electron_self_energy(-omega, lead, theta));
}

}  // namespace core
