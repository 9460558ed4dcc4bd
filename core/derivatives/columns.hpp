// The Green's function of the wire with its leads, from the end sites to every site, at complex energies.
//
// In the frame of wire/elimination.hpp M couples neighbours by −1.  With the leads attached to the end sites,
// D_n = A_n − D_{n−1}⁻¹ holds the site n and all that is left of it, E_n = A_n − E_{n+1}⁻¹ the site and all that is right
// of it, and
//
//     P_n = E_n⁻¹ P_{n−1}, P_0 = E_0⁻¹,     Q_n = D_n⁻¹ Q_{n+1}, Q_{N−1} = D_{N−1}⁻¹
//
// are the columns of G that the left and the right end site drive.  Off the real axis no pivot vanishes; where a
// level of a piece is near, the inverse of the next piece is small along it, and as many digits are lost as its
// inverse is large, not twice as many: so the inverses may be explicit here.
#pragma once

#include <vector>

#include "../leads/attach.hpp"

namespace core {

template <class N>
CORE_INLINE Block4<N> times(const Symmetric4<N>& D, const Block4<N>& wave) {
    Block4<N> to;
#pragma GCC unroll 4
    for (int c = 0; c < 4; ++c)
#pragma GCC unroll 4
        for (int i = 0; i < 4; ++i)
            to(i, c) = D(i, 0) * wave(0, c) + D(i, 1) * wave(1, c) + D(i, 2) * wave(2, c) + D(i, 3) * wave(3, c);
    return to;
}

// ±1 of a component of the last site, which the frame turns by (−τz)ⁿ.
inline double sign_at_the_end(int sites, int component) { return sites % 2 == 0 && component < 2 ? -1.0 : 1.0; }

// What is kept of a site: E_n⁻¹, then D_n⁻¹, and P_n.
template <class R>
struct SiteColumns {
    Symmetric4<Complex<R>> piece;
    Block4<Complex<R>> P;
};

// The onsite blocks of M of a wire with its leads.
template <class R>
class Sites {
    const WireView& wire;
    const TermsOfSites<Complex<R>> terms;
    const LaneLeads<R>& leads;

public:
    Sites(const WireView& wire, const Terms<Complex<R>>& of, const LaneLeads<R>& leads) : wire(wire), terms(of), leads(leads) {}
    Symmetric4<Complex<R>> operator()(int n) const {
        auto A = onsite<Symmetric4<Complex<R>>>(terms(n), wire.V[n], wire.zeeman_x[n], 0.0, wire.zeeman_z[n]);
        if (n == 0) attach_lead(A, leads, 0);
        if (n == wire.sites - 1) attach_lead(A, leads, 1);
        return A;
    }
};

// Fill in D_n⁻¹ of all sites, and call pass(n) before.
template <class R, class Pass>
inline void eliminate_from_the_left(const Sites<R>& onsite_of, std::vector<SiteColumns<R>>& sites, Pass pass) {
    for (int n = 0; n < int(sites.size()); ++n) {
        pass(n);
        auto A = onsite_of(n);
        sites[n].piece = inverse(factor(n == 0 ? A : minus(A, sites[n - 1].piece)));
    }
}

// Call use(n, P_n, Q_n) from the last site to the first; the ends' G, which all sites may need, goes to meet(G) before.
template <class R, class Meet, class Use>
inline void for_all_columns(const WireView& wire, const Terms<Complex<R>>& of, const LaneLeads<R>& leads,
                            std::vector<SiteColumns<R>>& sites, Meet meet, Use use) {
    const Sites<R> onsite_of(wire, of, leads);
    const int last = wire.sites - 1;
    sites[last].piece = inverse(factor(onsite_of(last)));
    for (int n = last - 1; n >= 0; --n) sites[n].piece = inverse(factor(minus(onsite_of(n), sites[n + 1].piece)));
    eliminate_from_the_left<R>(onsite_of, sites, [&](int n) {
        if (n > 0)
            sites[n].P = times(sites[n].piece, sites[n - 1].P);
        else
            for (int k = 0; k < 16; ++k) sites[n].P(k / 4, k % 4) = sites[n].piece(k / 4, k % 4);
    });
    Block4<Complex<R>> Q;
    Ends<R> G;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            double sign = sign_at_the_end(wire.sites, i), of_column = sign_at_the_end(wire.sites, j);
            Q(i, j) = sites[last].piece(i, j) * R(of_column);
            if (i <= j) G(i, j) = sites[0].P(i, j), G(4 + i, 4 + j) = Q(i, j) * R(sign);
            G(j, 4 + i) = sites[last].P(i, j) * R(sign);
        }
    meet(G);
    for (int n = last; n >= 0; --n) {
        if (n < last) Q = times(sites[n].piece, Q);
        use(n, sites[n].P, Q);
    }
}

}  // namespace core
