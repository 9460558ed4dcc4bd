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
// Where modes of two spins cross, at λ = σ = ±1, two roots all but coincide, and λ cannot tell them apart.  Nor
// can it tell all four apart near the edge of a band whose width is large.  With
// λ = σ e^{iq}, e = E' + 2tσ, they are worked out in q, in which nothing small is a difference of what is not:
//
//     m = e − 4tσ sin² ½q,   w = v + 2sσ sin q,   q ≈ (−v ± √(e² − h²))/2sσ.
//
// Where spins are all but degenerate, the spinors lose all digits.  So F is only the start of Newton's
// iteration for T F² − (E − H₀) F + T† = 0; and where V_Z is small, compared with what it takes to make
// an outgoing mode meet an incoming one, the start is F without a field.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
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

// |λ − σ| up to which two roots are worked out in q: itself, and as a part of that of the third.
constexpr double NEARBY = 1e-2, NEARER = 0.1;
constexpr double CLOSE = 1e-4;          // distance of modes up to which Newton's iteration would lose their digits
constexpr double ACROSS = 1e-15;        // cos θ up to which it is rounding of that of ±π/2
constexpr double REAL = 1e-6;           // |Im q| over the distance of both up to which they propagate
constexpr double ON_THE_CIRCLE = 1e-7;  // how close to 1 |λ| is taken for that of a propagating mode
// By up to this part of the distance between outgoing and incoming modes, of any spin, the field may move them
// for the iteration to start without it.
constexpr double SMALL = 0.02;
// V_Z/t' up to which the field is left out at the edge of a band, where a mode meets its own mirror image.
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

// A mode's λ and what its spinor and its velocity follow from; q where it is known.
struct TiltedMode {
    Amplitude lambda, m, w, sin, cos;
    bool crosses = false, propagates = false;
};

struct TiltedLead {
    double low, high, t, s, along, across;  // E' + 2t and E' − 2t; h and v

    TiltedMode mode_at(Amplitude lambda) const {
        constexpr Amplitude I(0.0, 1.0);
        Amplitude over = 1.0 / lambda, cos = (lambda + over) / 2.0, sin = (lambda - over) / (2.0 * I);
        return {lambda, (low + high) / 2 + 2 * t * cos, across + 2 * s * sin, sin, cos, false, std::abs(std::abs(lambda) - 1) < ON_THE_CIRCLE};
    }
    TiltedMode mode_at(Amplitude q, double sigma) const {
        Amplitude half = std::sin(0.5 * q), sin = sigma * std::sin(q);
        double e = sigma > 0 ? low : high;
        return {sigma * std::exp(Amplitude(-q.imag(), q.real())), e - 4 * t * sigma * half * half, across + 2 * s * sin, sin, sigma * std::cos(q), true, q.imag() == 0};
    }

    // The modes near σ whose q start from these, by Aberth's iteration.
    void near_edge(double sigma, std::span<Amplitude> q, std::span<TiltedMode> modes) const {
        constexpr int STEPS = 60;
        for (int step = 0; step < STEPS; ++step) {
            double moved = 0.0;
            for (size_t k = 0; k < q.size(); ++k) {
                TiltedMode at = mode_at(q[k], sigma);
                Amplitude value = (at.m - along) * (at.m + along) - at.w * at.w;
                Amplitude slope = -4.0 * t * at.m * at.sin - 4.0 * s * at.w * at.cos;
                Amplitude newton = value / slope, repelled = 0.0;
                for (size_t other = 0; other < q.size(); ++other)
                    if (other != k) repelled += 1.0 / (q[k] - q[other]);
                Amplitude change = newton / (1.0 - newton * repelled);
                if (!std::isfinite(std::abs(change))) continue;
                q[k] -= change;
                moved = std::max(moved, std::abs(change) / distance(q, k));
            }
            if (moved <= 1e-16) break;
        }
        for (size_t k = 0; k < q.size(); ++k)
            if (std::abs(q[k].imag()) <= REAL * distance(q, k)) q[k] = q[k].real();
        for (size_t k = 0; k < q.size(); ++k) modes[k] = mode_at(q[k], sigma);
    }

    // The two modes that cross near σ, from where the bands are straight lines on.
    void crossing(double sigma, std::span<TiltedMode> modes) const {
        double e = sigma > 0 ? low : high;
        Amplitude root = std::sqrt(Amplitude((e - along) * (e + along)));
        Amplitude q[2] = {(root - across) / (2 * s * sigma), (-root - across) / (2 * s * sigma)};
        near_edge(sigma, q, modes);
    }

    // All four modes, which are near σ, from a circle on whose radius is that of the roots of
    //
    //     (e − tσq²)² − h² − (v + 2sσq)² = 0.
    void band_edge(double sigma, std::span<TiltedMode> modes) const {
        double e = sigma > 0 ? low : high, rest = std::abs((e - along) * (e + along) - across * across);
        double radius = std::max({std::sqrt(2 * std::abs(e) / t + 4 * s * s / (t * t)), std::cbrt(4 * std::abs(across * s) / (t * t)),
                                  std::sqrt(std::sqrt(rest) / t)});
        Amplitude q[4];
        for (int k = 0; k < 4; ++k) q[k] = std::polar(radius, 0.4 + k * 1.5707963267948966);
        near_edge(sigma, q, modes);
    }

private:
    // From q_k to the nearest other one.
    static double distance(std::span<const Amplitude> q, size_t k) {
        double least = std::numeric_limits<double>::infinity();
        for (size_t other = 0; other < q.size(); ++other)
            if (other != k) least = std::min(least, std::abs(q[k] - q[other]));
        return least;
    }
};

// F of the modes that are outgoing to the right, whether some cross, and whether one propagates.
struct Outgoing {
    Spin2 F;
    bool crosses, open;
};

inline Outgoing from_modes(const TiltedLead& lead) {
    constexpr Amplitude I(0.0, 1.0);
    double t = lead.t, s = lead.s, shifted = (lead.low + lead.high) / 2, hop2 = t * t + s * s;
    Amplitude root[4];
    find_roots(2.0 * Amplitude(t * shifted, s * lead.across) / hop2,
               (shifted * shifted + 2 * t * t - 2 * s * s - lead.across * lead.across - lead.along * lead.along) / hop2, root);
    TiltedMode modes[4];
    for (int k = 0; k < 4; ++k) modes[k] = lead.mode_at(root[k]);
    bool crosses = false;
    for (double sigma : {1.0, -1.0}) {
        int near[4] = {0, 1, 2, 3};
        auto away = [&](int k) { return std::abs(root[k] - sigma); };
        std::sort(near, near + 4, [&](int a, int b) { return away(a) < away(b); });
        if (away(near[3]) < NEARBY) {
            lead.band_edge(sigma, modes);
            crosses = true;
        } else if (away(near[1]) < NEARBY && away(near[1]) < NEARER * away(near[2])) {
            TiltedMode two[2];
            lead.crossing(sigma, two);
            for (int k = 0; k < 2; ++k) modes[near[k]] = two[k];
            crosses = true;
        }
    }
    double inwards[4];
    Amplitude spinor[4][2];
    for (int k = 0; k < 4; ++k) {
        const TiltedMode& at = modes[k];
        // of the columns of m + hσx + wσy the one that cannot vanish
        Amplitude up = lead.along + I * at.w, down = lead.along - I * at.w;
        bool first = std::norm(up) > std::norm(down);
        double size = std::sqrt(std::norm(at.m) + std::norm(first ? up : down));
        spinor[k][0] = (first ? at.m : down) / size;
        spinor[k][1] = (first ? up : at.m) / size;
        double slope = at.m == 0.0 ? 0.0 : (at.w / at.m).real();
        double velocity = 2 * t * at.sin.real() + 2 * s * slope * at.cos.real();
        inwards[k] = at.propagates ? (velocity > 0 ? -1 : velocity < 0 ? 1 : 0) * ON_THE_CIRCLE : std::log(std::abs(at.lambda));
    }
    int mode[4] = {0, 1, 2, 3};
    std::sort(mode, mode + 4, [&](int a, int b) { return inwards[a] < inwards[b]; });
    int a = mode[0], b = mode[1];
    Spin2 U{{{spinor[a][0], spinor[b][0]}, {spinor[a][1], spinor[b][1]}}};
    Spin2 shift{{{modes[a].lambda, 0.0}, {0.0, modes[b].lambda}}};
    return {U * shift * inverse(U), crosses, modes[a].propagates || modes[b].propagates};
}

// Σ of a lead in which no mode propagates, as in self_energy.hpp: it is Hermitian.
inline Spin2 closed_tilted(const Spin2& M) {
    Amplitude off = 0.5 * (M(0, 1) + std::conj(M(1, 0)));
    return {{{M(0, 0).real(), off}, {std::conj(off), M(1, 1).real()}}};
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
    double low = E + lead.mu, shifted = low - 2 * t, hop = std::hypot(t, s), zeeman = std::abs(lead.zeeman);
    Spin2 T{{{-t, -s}, {s, -t}}};
    if (std::abs(along) <= ACROSS * zeeman) {  // the field is along the spin–orbit field: two chains, of σy = ±1
        Amplitude F[2];
        for (int k = 0; k < 2; ++k) {
            double own = low - (k == 0 ? across : -across);
            Amplitude turn(t / hop, (k == 0 ? -s : s) / hop);
            F[k] = turn * outgoing((own + 2 * (hop - t)) / (2 * hop), (4 * t - own + 2 * (hop - t)) / (2 * hop), true).lambda;
        }
        Amplitude same = 0.5 * (F[0] + F[1]), differ = Amplitude(0.0, 0.5) * (F[0] - F[1]);  // F₊(1 + σy)/2 + F₋(1 − σy)/2
        return T * Spin2{{{same, -differ}, {differ, same}}};
    }
    Amplitude cosine = -shifted / (2 * hop);  // of k without field, but for ±atan(s/t)
    Amplitude sine = std::sqrt(1.0 - cosine * cosine);
    double edge = std::abs(sine), cross = std::min(std::abs(sine * t + cosine * s), std::abs(sine * t - cosine * s)) / hop;
    LeadParameters free = lead;
    free.zeeman = 0;
    Spin2 H{{{-shifted, Amplitude(along, -across)}, {Amplitude(along, across), -shifted}}};
    if (cross > CLOSE && zeeman < 4 * SMALL * hop * edge * std::min(edge, cross))
        return T * refined(inverse(T) * electron_self_energy(E, free), T, H);
    if (zeeman < NEGLIGIBLE * hop && edge < cross) return electron_self_energy(E, free);
    auto [F, crosses, open] = from_modes({low, low - 4 * t, t, s, along, across});
    Spin2 sigma = T * (crosses ? F : refined(F, T, H));
    return open ? sigma : closed_tilted(sigma);
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
