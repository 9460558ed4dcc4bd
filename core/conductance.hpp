// Bare conductances, T = 0, of all wires on a grid of fields, chemical potentials and energies.
//
// Work is cut into one wire, one field and as many pairs (μ, ω) as lanes; a result depends on its
// own lane alone, so that it is the same for any number of threads.
#pragma once

#include "determinant.hpp"
#include "leads/attach.hpp"
#include "parallel.hpp"
#include "wire/parent.hpp"
#include "wire/pivoted.hpp"

namespace core {

struct Grid {
    const Wire* wires;
    int wire_count;
    const double *mu, *B, *omega;
    int mu_count, B_count, omega_count;
    double theta = 0;  // angle of the fields
};

inline WireView view(const RotatedWire& w) {
    return {w.sites(), w.V.data(), w.zeeman_x.data(), w.zeeman_z.data(), w.zeeman_y};
}

// Number of lanes whose divisions hide each other's latency best.
constexpr int REAL_LANES = 2 * REGISTER;
constexpr int COMPLEX_LANES = REGISTER;

// One wire and field: its frame, its leads and its parent at every energy.
template <class Arithmetic>
struct FieldOf {
    RotatedWire wire;
    double hop, kinetic_zero;  // t', and 2t in units of it
    std::vector<int> energies;  // those of the grid that this arithmetic is for
    std::vector<typename Arithmetic::Pairing> pairing;
    std::vector<LeadSelfEnergy> leads;

    FieldOf(const Wire& of, double B, const Grid& grid)
        : wire(of, B, grid.theta), hop(of.rotated_hopping()), kinetic_zero(2 * of.hopping / hop) {
        for (int e = 0; e < grid.omega_count; ++e) {
            if (!Arithmetic::takes(of, grid.omega[e])) continue;
            energies.push_back(e);
            pairing.push_back(typename Arithmetic::Pairing(of, grid.omega[e]));
            leads.push_back(in_frame_of(of, Arithmetic::leads(of, B, grid.omega[e], grid.theta)));
        }
    }
    int energy_count() const { return int(energies.size()); }
};

// Below the gap, no broadening: real numbers.
struct RealArithmetic {
    using Pairing = core::Pairing;
    using R = Lanes<REAL_LANES>;
    using N = R;
    using Block = Symmetric4<N>;
    using Leads = LaneLeads<R>;
    static constexpr int LANES = REAL_LANES;
    static bool takes(const Wire& w, double omega) { return w.dissipation == 0 && w.parent_dissipation == 0 && std::abs(omega) < w.delta0; }
    static LeadSelfEnergy leads(const Wire& w, double B, double omega, double) { return self_energy_of_leads(w, B, omega); }
    static void set(Terms<N>& t, int lane, const Pairing& p, double hop) {
        t.normal.set(lane, p.normal / hop);
        t.anomalous.set(lane, p.anomalous / hop);
    }
    static ComplexTerms one(double kinetic, const Pairing& p, double hop) { return {kinetic, p.normal / hop, p.anomalous / hop}; }
    static void set_kinetic(Terms<N>& t, int lane, double value) { t.kinetic.set(lane, value); }
    static Conductances<R> conductances(const Ends<R>& G, const LaneLeads<R>& leads) { return lossless_conductances_of_ends<R>(G, leads); }
};

// At any energy ω ≠ ±Δ₀, and where levels are broadened: complex numbers.
struct ComplexArithmetic {
    using Pairing = RetardedPairing;
    using R = Lanes<COMPLEX_LANES>;
    using N = Complex<R>;
    using Block = Symmetric4<N>;
    using Leads = LaneLeads<R>;
    static constexpr int LANES = COMPLEX_LANES;
    static bool takes(const Wire& w, double omega) { return !RealArithmetic::takes(w, omega); }
    static LeadSelfEnergy leads(const Wire& w, double B, double omega, double) { return self_energy_of_leads(w, B, omega); }
    static void set(Terms<N>& t, int lane, const Pairing& p, double hop) {
        t.normal.re.set(lane, p.normal.re / hop), t.normal.im.set(lane, p.normal.im / hop);
        t.anomalous.re.set(lane, p.anomalous.re / hop), t.anomalous.im.set(lane, p.anomalous.im / hop);
    }
    static ComplexTerms one(double kinetic, const Pairing& p, double hop) {
        return {kinetic, Amplitude(p.normal.re, p.normal.im) / hop, Amplitude(p.anomalous.re, p.anomalous.im) / hop};
    }
    static void set_kinetic(Terms<N>& t, int lane, double value) { set_lane(t.kinetic, lane, value); }
    template <class Ends, class Leads>
    static Conductances<R> conductances(const Ends& G, const Leads& leads) { return lossy_conductances_of_ends<R>(G, leads); }
};

template <class Ends>
inline void set_ends(Ends& G, int lane, const EndMatrix& one) {
    for (int i = 0; i < 8; ++i)
        for (int j = Ends::SYMMETRIC ? i : 0; j < 8; ++j) set_lane(G(i, j), lane, one(i, j));
}

// In each lane a number only if all of G is: where leads are closed, a level of the whole at ω makes it none.
template <class R, class Ends>
inline R sum_of_entries(const Ends& G) {
    R total = 0.0;
    for (int i = 0; i < 8; ++i)
        for (int j = Ends::SYMMETRIC ? i : 0; j < 8; ++j) total = total + G(i, j).re + G(i, j).im;
    return total;
}

// Solve the lanes of G that lost digits by pivoting; one(lane) are its terms and its leads.
template <class A, class Eliminated, class Ends, class One>
inline void solve_lost_lanes(const RotatedWire& wire, const Eliminated& ends, Ends& G, int count, double growth_limit, One one) {
    auto sum = sum_of_entries<typename A::R>(G);
    for (int l = 0; l < count; ++l)
        if (!(ends.growth[l] < growth_limit) || !std::isfinite(sum[l])) {
            const auto [terms, leads] = one(l);
            set_ends(G, l, pivoted_ends(wire, terms, on_the_ends(leads)));
        }
}

// G and the leads of LANES pairs (μ, ω) from `first` on.
template <class A, class Use>
inline void solve_pairs(const Grid& grid, const FieldOf<A>& field, int first, double growth_limit, Use use) {
    int energies = field.energy_count(), pairs = grid.mu_count * energies;
    Terms<typename A::N> terms{};
    typename A::Leads leads{};
    auto kinetic = [&](int pair) { return field.kinetic_zero - grid.mu[pair / energies] / field.hop; };
    for (int l = 0; l < A::LANES; ++l) {
        int pair = std::min(first + l, pairs - 1), e = pair % energies;
        A::set_kinetic(terms, l, kinetic(pair));
        A::set(terms, l, field.pairing[e], field.hop);
        leads.set(l, field.leads[e]);
    }
    auto ends = eliminate_inner_sites<typename A::N, typename A::Block>(view(field.wire), terms);
    auto G = attach_leads(ends, leads);
    int count = std::min(A::LANES, pairs - first);
    solve_lost_lanes<A>(field.wire, ends, G, count, growth_limit, [&](int l) {
        int e = (first + l) % energies;
        return std::pair(A::one(kinetic(first + l), field.pairing[e], field.hop), field.leads[e]);
    });
    use(G, leads, count);
}

// Which wire, chemical potential, field and energy.
struct Place {
    int w, m, f, e;
};

// Call use(place, G, leads, count) for all pieces of up to LANES pairs (μ, ω); place(lane) is a Place.
template <class A, class Use>
inline void for_all_pairs(const Grid& grid, double growth_limit, Stop& stop, Use use) {
    in_parallel(grid.wire_count * grid.B_count, stop, [&](int task) {
        int w = task / grid.B_count, f = task % grid.B_count;
        auto takes = [&](double omega) { return A::takes(grid.wires[w], omega); };
        if (std::none_of(grid.omega, grid.omega + grid.omega_count, takes)) return;
        FieldOf<A> field(grid.wires[w], grid.B[f], grid);
        int pairs = grid.mu_count * field.energy_count();
        for (int first = 0; first < pairs && !stop.asked(); first += A::LANES)
            solve_pairs<A>(grid, field, first, growth_limit, [&](const auto& G, const auto& leads, int count) {
                auto place = [&](int lane) {
                    int pair = first + lane, energies = field.energy_count();
                    return Place{w, pair / energies, f, field.energies[pair % energies]};
                };
                use(place, G, leads, count);
            });
    });
}

// Fill out, shape (wire, mu, B, omega, 2, 4), with the conductances at ±ω.
template <class A>
inline void bare_conductance(const Grid& grid, double growth_limit, double* out, Stop& stop) {
    for_all_pairs<A>(grid, growth_limit, stop, [&](auto place, const auto& G, const auto& leads, int count) {
        auto found = A::conductances(G, leads);
        for (int l = 0; l < count; ++l) {
            auto [w, m, f, e] = place(l);
            double* to = out + (((size_t(w) * grid.mu_count + m) * grid.B_count + f) * grid.omega_count + e) * 8;
            for (int k = 0; k < 8; ++k) to[k] = found.at[k / 4][k % 4][l];
        }
    });
}

// Fill out, shape (wire, lead, mu, B), with det r at the grid's one energy, ω = 0.
template <class A>
inline void reflection_determinants(const Grid& grid, double growth_limit, double* out, Stop& stop) {
    for_all_pairs<A>(grid, growth_limit, stop, [&](auto place, const auto& G, const auto& leads, int count) {
        for (int l = 0; l < count; ++l) {
            auto [w, m, f, e] = place(l);
            for (int lead = 0; lead < 2; ++lead)
                out[((size_t(w) * 2 + lead) * grid.mu_count + m) * grid.B_count + f] =
                    reflection_determinant(G, leads, lead, l);
        }
    });
}

}  // namespace core
