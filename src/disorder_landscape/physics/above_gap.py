"""Conductances at any energy: above the gap too, where the parent superconductor absorbs.

There √(Δ₀²−ω²) becomes −i sgn(ω)√(ω²−Δ₀²), the retarded branch, and M = ω − H − Σ(ω) is complex
symmetric, with Im M ≥ γ√((|ω|−Δ₀)/(|ω|+Δ₀)). What comes in from a lead may leave through the
parent, so the probabilities no longer sum to one and G_aa is N_e − R_ee + R_he itself. Below the
gap the results are those of `fast_solver`, at some 14 times the cost. A wire's dissipation, −iΓ on
each site, absorbs in the same way at any energy.
"""

from __future__ import annotations

from collections.abc import Sequence

import numba as nb
import numpy as np

from disorder_landscape.physics.compilation import compile_kernels
from disorder_landscape.physics.complex_recursion import WIDTH, eliminate_inner_sites_complex
from disorder_landscape.physics.fast_solver import Problem, prepare
from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray, Nanowire
from disorder_landscape.physics.pivoted import pivoted_end_green_functions
from disorder_landscape.physics.recursion import LANES

GROWTH_LIMIT = 1e7
"""Largest inverse pivot, or product of couplings, (in units of t') up to which elimination without
pivoting is trusted."""


def retarded_pairing_factors(
    wire: Nanowire, omega: FloatArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return γω/√(Δ₀²−ω²) + iΓ and γΔ₀/√(Δ₀²−ω²) in meV, ω ≠ ±Δ₀, on the retarded branch."""
    root = np.sqrt(abs(wire.delta0**2 - omega**2)).astype(np.complex128)
    root[abs(omega) > wire.delta0] *= -1j
    root[omega < -wire.delta0] *= -1
    return wire.gamma * omega / root + 1j * wire.dissipation, wire.gamma * wire.delta0 / root


@nb.njit(cache=True)
def _probability(G: ComplexArray, gamma: FloatArray, a: int, b: int) -> float:  # pragma: no cover
    """Return Tr[Γ_a G_ab Γ_b G_ab†]."""
    total = 0.0
    for i in range(2):
        for j in range(2):
            left = gamma[a, i, 0] * G[2 * a, 2 * b + j] + gamma[a, i, 1] * G[2 * a + 1, 2 * b + j]
            bra = np.conj(G[2 * a + i, 2 * b]) * gamma[b, 0, j]
            bra += np.conj(G[2 * a + i, 2 * b + 1]) * gamma[b, 1, j]
            total += (left * bra).real
    return total


@nb.njit(cache=True)
def _conductances(
    G: ComplexArray, sigma: ComplexArray, out: FloatArray
) -> None:  # pragma: no cover
    """Write the BTK conductances at ±ω into out, shape (2, 4): LL, RR, LR, RL.

    G: ends' Green's function, shape (8, 8); sigma: shape (lead, charge, 2, 2). With
    r = −1 + iΓ^½GΓ^½ (Fisher–Lee), N − Tr rr† = −2 Im Tr ΓG − Tr ΓGΓG†, closed channels included.
    """
    gamma = np.empty((4, 2, 2))
    for block in range(4):
        gamma[block] = -2 * sigma[block // 2, block % 2].imag
    for c in range(2):  # at +ω electrons come in, at −ω (by particle–hole symmetry) holes
        for lead in range(2):
            same, other = 2 * lead + c, 2 * lead + 1 - c
            net = _probability(G, gamma, other, same) - _probability(G, gamma, same, same)
            for i in range(2):
                for j in range(2):
                    net -= 2 * gamma[same, i, j] * G[2 * same + j, 2 * same + i].imag
            out[c, lead] = net
            far = 2 - 2 * lead
            out[c, 3 - lead] = _probability(G, gamma, far + c, same)
            out[c, 3 - lead] -= _probability(G, gamma, far + 1 - c, same)


@nb.njit(cache=True)
def _ends_of_lane(
    s: FloatArray, sigma: ComplexArray, lane: int
) -> ComplexArray:  # pragma: no cover
    """Return the Green's function of the ends with their leads, shape (8, 8), in units of 1/t'."""
    M = np.empty((8, 8), dtype=np.complex128)
    for a in range(8):
        for b in range(a, 8):
            at = (16 * a + 2 * b) * WIDTH + lane
            M[a, b] = M[b, a] = complex(s[at], s[at + WIDTH])
    for block in range(4):
        at = 2 * block
        M[at : at + 2, at : at + 2] -= sigma[block // 2, block % 2]
    M[:] = np.linalg.inv(M)
    return M


@nb.njit(cache=True)
def _ends_by_pivoting(
    V: FloatArray,
    zeeman_x: FloatArray,
    zeeman_z: FloatArray,
    terms: tuple[complex, complex, complex],
    sigma: ComplexArray,
) -> ComplexArray:  # pragma: no cover
    """Return the same for one (μ, ω), by banded elimination with partial pivoting."""
    G = np.empty((8, 8), dtype=np.complex128)
    re, im = np.empty(64 * LANES), np.empty(64 * LANES)
    pivoted_end_green_functions(V, zeeman_x, zeeman_z, terms, sigma, 0, re, im)
    for a in range(8):
        for b in range(a, 8):
            at = (8 * a + b) * LANES
            G[a, b] = G[b, a] = -complex(re[at], im[at])
    return G


@nb.njit(cache=True, parallel=True)
def _conductance_kernel(
    p: Problem, growth_limit: float, out: FloatArray
) -> None:  # pragma: no cover
    """Fill out, shape (wire, B, mu·omega, 2, 4)."""
    wires, fields, pairs = out.shape[:3]
    energies, pieces = p.normal.shape[1], (pairs + WIDTH - 1) // WIDTH
    for task in nb.prange(wires * fields * pieces):
        w, f, first = task // pieces // fields, task // pieces % fields, task % pieces * WIDTH
        V, zeeman_x, zeeman_z = p.V[w], p.zeeman_x[w, f], p.zeeman_z[w, f]
        s, growth, terms = np.empty(128 * WIDTH), np.empty(WIDTH), np.empty((5, WIDTH))
        for l in range(WIDTH):
            pair = min(first + l, pairs - 1)
            normal, anomalous = p.normal[w, pair % energies], p.anomalous[w, pair % energies]
            terms[0, l] = p.kinetic[w, pair // energies]
            terms[1, l], terms[2, l] = normal.real, normal.imag
            terms[3, l], terms[4, l] = anomalous.real, anomalous.imag
        eliminate_inner_sites_complex(V, zeeman_x, zeeman_z, terms, s, growth)
        for l in range(min(WIDTH, pairs - first)):
            m, e = (first + l) // energies, (first + l) % energies
            sigma = p.sigma[w, f, e]
            if growth[l] < growth_limit**2:
                G = _ends_of_lane(s, sigma, l)
            else:  # NaN too
                given = p.kinetic[w, m] + 0j, p.normal[w, e], p.anomalous[w, e]
                G = _ends_by_pivoting(V, zeeman_x, zeeman_z, given, sigma)
            _conductances(G, sigma, out[w, f, first + l])


def bare_conductance(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    growth_limit: float = GROWTH_LIMIT,
) -> FloatArray:
    """Return the T = 0 conductances at ±ω, shape (wire, mu, B, omega, 2, 4), in e²/h.

    As `fast_solver.bare_conductance`, for real ω of either sign, ω ≠ ±Δ₀ of each wire.
    """
    compile_kernels()
    p = prepare(wires, mu, B, omega, retarded_pairing_factors)
    out = np.empty((len(wires), B.size, mu.size * omega.size, 2, 4))
    _conductance_kernel(p, growth_limit, out)
    shaped = out.reshape(len(wires), B.size, mu.size, omega.size, 2, 4)
    return np.asarray(shaped.swapaxes(1, 2))
