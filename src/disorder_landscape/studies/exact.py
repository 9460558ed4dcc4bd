"""Exact conductances at T = 0, in numbers of 600 bits: no rounding that anyone could see.

For the study of odd wires. Plain recursion over the sites with the leads attached, in the basis of
`disorder_landscape.model.hamiltonian`; the leads by decimation at ω + i 1e-50.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import acb, acb_mat, arb, ctx

from disorder_landscape.model.parameters import FloatArray, Nanowire

ctx.prec = 600
I = acb(0, 1)


@dataclass
class _Point:
    """A wire at one point, all parameters exactly as the doubles say; any may be moved."""

    V: list[arb]  # with barriers
    t: arb
    s: arb  # α/2a
    zeeman: arb
    gamma: arb
    delta0: arb
    lead_mu: arb
    lead_s: arb
    lead_zeeman: arb
    dissipation: arb
    parent_dissipation: arb
    mu: arb
    omega: arb
    cos: arb
    sin: arb


def exact_conductances(
    wire: Nanowire, mu: float, B: float, omega: float, theta: float
) -> FloatArray:
    """Return G_LL, G_RR, G_LR, G_RL at +ω, then at −ω, shape (2, 4), in e²/h."""
    point = _point(wire, mu, B, omega, theta)
    return np.array([float(G) for G in _conductances(point)]).reshape(2, 4)


def _point(wire: Nanowire, mu: float, B: float, omega: float, theta: float) -> _Point:
    """Return the point of a Nanowire."""
    x = {
        "t": wire.hopping,
        "s": wire.spin_orbit_hopping,
        "zeeman": wire.zeeman_per_tesla,
        "gamma": wire.gamma,
        "delta0": wire.delta0,
        "lead_mu": wire.lead_mu,
        "lead_s": wire.lead_spin_orbit_hopping,
        "lead_zeeman": wire.lead_zeeman_per_tesla,
        "dissipation": wire.dissipation,
        "parent_dissipation": wire.dissipation_of_parent,
        "mu": mu,
        "omega": omega,
    }
    y = {name: arb(float(value)) for name, value in x.items()}
    for name in ("zeeman", "lead_zeeman"):
        y[name] *= arb(float(B))
    angle = arb(float(theta))
    V = [arb(float(v)) for v in wire.potential_with_barriers]
    return _Point(V=V, cos=angle.cos(), sin=angle.sin(), **y)


def _onsite(p: _Point, kinetic: arb, zeeman: arb) -> acb_mat:
    """Return kinetic τz + V_Z (σx cos θ + σy sin θ)."""
    up = zeeman * (p.cos - I * p.sin)
    down = zeeman * (p.cos + I * p.sin)
    k = kinetic
    return acb_mat([[k, up, 0, 0], [down, k, 0, 0], [0, 0, -k, up], [0, 0, down, -k]])


def _hopping(t: arb, s: arb) -> acb_mat:
    """Return −t τz − i s σy τz: from site i + 1 to site i."""
    return acb_mat([[-t, -s, 0, 0], [s, -t, 0, 0], [0, 0, t, s], [0, 0, -s, t]])


def _middle(M: acb_mat) -> acb_mat:
    return acb_mat([[M[i, j].mid() for j in range(4)] for i in range(4)])


def _one(z: Any) -> acb_mat:
    return acb_mat([[z if i == j else 0 for j in range(4)] for i in range(4)])


def _self_energies(p: _Point) -> tuple[acb_mat, acb_mat]:
    """Return Σ of the left and of the right lead."""
    h = _onsite(p, 2 * p.t - p.lead_mu, p.lead_zeeman)
    T = _hopping(p.t, p.lead_s)
    z = _one(p.omega + I * arb("1e-50"))
    right = left = e = h
    a, b = T, T.transpose()
    for _ in range(1000):
        g = (z - e).inv()
        agb, bga = a * g * b, b * g * a
        right, left, e = _middle(right + agb), _middle(left + bga), _middle(e + agb + bga)
        a, b = _middle(a * g * a), _middle(b * g * b)
        if max(float(abs(x).upper()) for m in (a, b) for x in m.entries()) < 1e-100:
            return T.transpose() * (z - left).inv() * T, T * (z - right).inv() * T.transpose()
    raise ArithmeticError("the leads do not converge")


def _ends(p: _Point) -> tuple[list[list[acb_mat]], tuple[acb_mat, acb_mat]]:
    """Return G between the end sites, [to][from], left first, and the leads' self-energies."""
    sigma = _self_energies(p)
    of_parent = p.omega + I * p.parent_dissipation
    root = (p.delta0**2 - of_parent**2).sqrt()
    if p.omega > p.delta0 and p.parent_dissipation == 0:
        root = -I * acb(p.omega**2 - p.delta0**2).sqrt()
    normal, anomalous = p.omega + I * p.dissipation + p.gamma * of_parent / root, p.gamma / root
    uniform = _one(normal)
    for i in range(4):
        uniform[i, (i + 2) % 4] = anomalous * p.delta0
    T = _hopping(p.t, p.s)
    last = len(p.V) - 1

    def site(n: int) -> acb_mat:
        return uniform - _onsite(p, 2 * p.t - p.mu + p.V[n], p.zeeman)

    A = B = C = D = (site(0) - sigma[0]).inv()
    for n in range(1, last + 1):
        M = site(n) - T.transpose() * D * T
        D = (M - sigma[1] if n == last else M).inv()
        A, B, C = A + B * T * D * T.transpose() * C, B * T * D, D * T.transpose() * C
        A, B, C, D = (_middle(x) for x in (A, B, C, D))
    return [[A, B], [C, D]], sigma


def _part(M: acb_mat, a: int, b: int) -> acb_mat:
    return acb_mat([[M[2 * a + i, 2 * b + j] for j in range(2)] for i in range(2)])


def _dagger(M: acb_mat) -> acb_mat:
    return acb_mat([[x.conjugate() for x in row] for row in M.transpose().tolist()])


def _conductances(p: _Point) -> list[arb]:
    """Return G_LL, G_RR, G_LR, G_RL at +ω, then at −ω."""
    G, sigma = _ends(p)
    gamma = [I * (s - _dagger(s)) for s in sigma]
    found: list[arb] = []

    def probability(out: int, into: int, a: int, b: int) -> arb:
        g = _part(G[out][into], a, b)
        to, of = _part(gamma[out], a, a), _part(gamma[into], b, b)
        return (to * g * of * _dagger(g)).trace().real

    for c in range(2):
        for lead in range(2):
            absorbed = -2 * (_part(gamma[lead], c, c) * _part(G[lead][lead], c, c)).trace().imag
            net = absorbed - probability(lead, lead, c, c)
            found.append(net + probability(lead, lead, 1 - c, c))
        for out, into in ((0, 1), (1, 0)):
            found.append(probability(out, into, c, c) - probability(out, into, 1 - c, c))
    return found
