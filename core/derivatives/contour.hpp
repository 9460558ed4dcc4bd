// Where the thermal average of a derivative is summed: at points of a path (path.hpp), and at poles.
//
// With Ḡ(z) = G(z*)*, probabilities are p_ab = Tr[Γ_a G_ab Γ_b Ḡ_ba] on the real axis, and a change of the wire alone
// makes them change by −2 Re of
//
//     Tr[∂M Q_ab],   Q_ab = G_·b m G_a·,   m = Γ_b Ḡ_ba Γ_a.
//
// Above the real axis G is analytic, Ḡ has simple poles at z_k* with the residues v̄v̄ᵀ, z_k and v the poles and vectors
// of G (resonances.hpp), and the kernel K_V has its own at V + iπkT.  There are no derivatives of residues, and no differences of
// poles.
//
// At the pole of a narrow level G is as large as 1/width, and the two columns of Q_ab are nearly the same imaginary
// vector: all but a part width/kT of the residue drops out.  So z_k must be that of the very matrix of which G is the
// inverse, to a small part of the width, and is found from it (exact_poles.hpp).  Where two poles are equal, the model
// serves instead: to it its own G, with vvᵀ/(z_k* − z_k), is right, and the matrix has λ⁻¹vvᵀ/(z_k* − z_k) beside the
// same rest.  λ follows from both at the ends, and multiplies each column of Q_ab.
//
// Particle–hole symmetry makes f at −z* that of z with electrons and holes exchanged, so only Re z ≥ 0 is summed.
//
// Where the levels of wire and parent are broadened by Γ_d, wire and parent are at z + iΓ_d in G and at z − iΓ_d in Ḡ, the
// leads at z.  The model and its poles are functions of the energy of the wire (resonances.hpp), the points ones of that of the
// leads.
#pragma once

#include "../thermal/average.hpp"
#include "path.hpp"

namespace core {

// In meV; poles that the leads make no wider change no conductance and lose all digits.  It is the width that the matrix has,
// where it is found: a level between wider ones at zero energy had 5e-10 in the model and 2.5e-6 in truth, and without it a
// derivative was off by its own size.
constexpr double NARROWEST = 1e-8;

struct ContourPoint {
    enum Kind { ABOVE_AXIS, ON_AXIS, POLE_OF_MODEL, POLE_OF_MATRIX };  // which of the two has z* for a pole
    Kind kind;
    Amplitude z, weight;
    bool mirrored;        // whether −z* counts, too
    EndMatrix conjugate;  // above the axis Ḡ of the ends, or its residue, in the frame of the sites, in units of 1/t' and of meV/t'
    // At a pole:
    Amplitude pole = 0.0;    // z_k = z*
    double isolation = 0.0;  // distance to the next one
    double moved = 0.0;      // distance from the model's
    EndMatrix own{};         // what the model has for G at z
    Amplitude v[8] = {};     // v̄, of which the residue is v̄v̄ᵀ
    Amplitude y[8] = {};     // Γv̄ in the units of the model
    Amplitude scale = 0.0;   // 1/λ = 1 + scale · yᵀ(G − own)y

    // Of which so much of the width is not by the leads.
    void leave_out_if_narrow(double broadening) {
        if (!(z.imag() > broadening + NARROWEST)) weight = 0.0;
    }
    void set_residue() {
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8; ++j) conjugate(i, j) = v[i] * v[j];
    }
};

namespace detail {

// From the chiral basis to that of the sites: the rows of a matrix of the ends, and all of it.
inline EndMatrix from_chiral_rows(const EndMatrix& M) {
    EndMatrix found;
    for (int j = 0; j < 8; ++j) {
        Amplitude column[8], turned[8];
        for (int i = 0; i < 8; ++i) column[i] = M(i, j);
        turn_to_sites(column, turned);
        for (int i = 0; i < 8; ++i) found(i, j) = turned[i];
    }
    return found;
}
inline EndMatrix from_chiral(const EndMatrix& M) {
    EndMatrix rows = from_chiral_rows(M), turned;
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) turned(i, j) = rows(j, i);
    return from_chiral_rows(turned);  // of a symmetric matrix
}

// One lane in the frame of the sites, in units of 1/t'.
inline EndMatrix lane_at_sites(const Symmetric8<PoleComplex>& G, int lane, double hop) {
    EndMatrix one;
    for (int k = 0; k < 8; ++k)
        for (int j = 0; j < 8; ++j) one(k, j) = hop * of_lane(G(k, j), lane);
    return from_chiral(one);
}

// How far from pole p the next of those in order, or the mirror image of one, is; zero if one is equal.
inline double separation(const Resonances& of, int p) {
    const Amplitude z = of.poles[p].z;
    double nearest = std::abs(z.real()) > CENTRAL ? 2 * z.real() : INFINITY;
    for (int k : of.order)
        if (k != p) nearest = std::min({nearest, std::abs(z - of.poles[k].z), std::abs(z + std::conj(of.poles[k].z))});
    return nearest > -EQUAL * z.imag() ? nearest : 0.0;
}

// A pole's point; own is the model's G there.
inline ContourPoint point_of_pole(const Pole& pole, const EndMatrix& own, const Path& path, const Leads& leads, double hop,
                                  Amplitude broadening) {
    const Amplitude at = pole.z - broadening, z = std::conj(at);
    EndMatrix S = leads.inverse.at(pole.z), gamma = leads.gamma.at(z + broadening), columns{};  // v̄ and Γv̄
    Amplitude v[8], width = 0.0;
    for (int k = 0; k < 8; ++k) {
        v[k] = 0.0;
        for (int l = 0; l < 8; ++l) v[k] += S(k, l) * pole.t[l];
        v[k] /= std::sqrt(pole.norm);
        columns(k, 0) = std::conj(v[k]);
    }
    for (int k = 0; k < 8; ++k)
        for (int l = 0; l < 8; ++l) columns(k, 1) += gamma(k, l) * std::conj(v[l]);
    for (int k = 0; k < 8; ++k) width += columns(k, 1) * v[k];
    columns = from_chiral_rows(columns);
    ContourPoint point{ContourPoint::POLE_OF_MODEL, z, path.weight_of_pole(z), true, {}};
    point.pole = at, point.own = own;
    for (int k = 0; k < 8; ++k) point.y[k] = columns(k, 1), point.v[k] = std::sqrt(hop) * columns(k, 0);
    point.set_residue();
    point.scale = (z - at) / (width * width * hop);
    return point;
}

}  // namespace detail

// The points of one set, of a wire whose levels are broadened by so much, poles first, then as the path has them; with the Ḡ that the
// model has where the path ends below the gap.
inline std::vector<ContourPoint> contour(const Path& path, double hop, const Resonances& poles, const Leads& leads, double width,
                                         Batch& b) {
    const Amplitude broadening(0, width);
    std::vector<ContourPoint> points;
    std::vector<int> seen;
    for (int n = 0; n < int(poles.order.size()); ++n) {
        Amplitude z = std::conj(poles.poles[poles.order[n]].z);
        if (z.imag() > 0 && path.sees(z + broadening)) seen.push_back(n);
    }
    // Call use(k, G at the k-th energy) for so many energies.
    auto for_green = [&](int count, const Cubic& inverse, auto energy, auto use) {
        for (int first = 0; first < count; first += POLES) {
            for (int l = 0; l < POLES; ++l) set_lane(b.z, l, energy(std::min(first + l, count - 1)));
            auto G = dressed_green(inverse, b);
            for (int l = 0; l < POLES && first + l < count; ++l) use(first + l, detail::lane_at_sites(G, l, hop));
        }
    };
    auto pole = [&](int k) -> const Pole& { return poles.poles[poles.order[seen[k]]]; };
    auto above = [&](int k) { return std::conj(pole(k).z) + 2.0 * broadening; };
    for_green(int(seen.size()), leads.inverse, above, [&](int k, const EndMatrix& G) {
        points.push_back(detail::point_of_pole(pole(k), G, path, leads, hop, broadening));
        points.back().mirrored = seen[k] < poles.paired;
        points.back().isolation = detail::separation(poles, poles.order[seen[k]]);
        points.back().leave_out_if_narrow(width);
    });
    auto add = [&](ContourPoint::Kind kind, const Path::Point& of, const EndMatrix& G) { points.push_back({kind, of.z, of.weight, true, G}); };
    if (path.reaches_gap())
        for (const Path::Point& of : path.above_axis) add(ContourPoint::ABOVE_AXIS, of, {});
    else
        for_green(int(path.above_axis.size()), leads.conjugate, [&](int k) { return path.above_axis[k].z - broadening; },
                  [&](int k, const EndMatrix& G) { add(ContourPoint::ABOVE_AXIS, path.above_axis[k], G); });
    for (const auto* some : {&path.next_to_gap, &path.above_gap})
        for (const Path::Point& of : *some) add(ContourPoint::ON_AXIS, of, {});
    return points;
}

}  // namespace core
