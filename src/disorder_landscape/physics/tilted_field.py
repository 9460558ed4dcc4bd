"""Conductances and T_IV in a field that is tilted by θ against the wire, at any energy.

The σy term makes M complex: its transpose is M at −θ, so neither M nor the leads' self-energies are
symmetric, and probabilities from one end to the other and back differ. Particle–hole symmetry holds
at any θ. θ is in radians.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numba as nb
import numpy as np
from scipy.linalg import solve_banded

from disorder_landscape.physics.above_gap import retarded_pairing_factors
from disorder_landscape.physics.compilation import compile_kernels
from disorder_landscape.physics.fast_solver import Problem, prepare
from disorder_landscape.physics.hamiltonian import ComplexArray, pairing_factors
from disorder_landscape.physics.parameters import FloatArray, Nanowire
from disorder_landscape.physics.tilted_leads import tilted_lead_self_energies
from disorder_landscape.physics.tilted_recursion import WIDTH, eliminate_inner_sites_tilted
from disorder_landscape.solver.compiled import GROWTH_LIMIT

CHARGES = (slice(0, 2), slice(2, 4))
"""Electron and hole entries of one end."""
BELOW = 7
"""Sub- and superdiagonals of a matrix of tridiagonal 4×4 blocks."""


def bare_conductance(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    theta: float,
    growth_limit: float = GROWTH_LIMIT,
) -> FloatArray:
    """Return the T = 0 conductances at ±ω, shape (wire, mu, B, omega, 2, 4), in e²/h.

    As `compiled.complex_conductance`, ω ≠ ±Δ₀, in a field at the angle θ.
    """
    G, sigma = _end_green_functions(wires, mu, B, omega, theta, growth_limit)
    gamma = 1j * (sigma - sigma.conj().swapaxes(-1, -2))  # (wire, B, 1, omega, lead, charge, 2, 2)
    shape = G.shape[:4]
    G = G.reshape(*shape, 2, 2, 2, 2, 2, 2)  # (…, lead, charge, spin) twice, outgoing first
    into = np.einsum("...abij,...abjcdk->...abcdik", gamma, G)
    back = np.einsum("...cdij,...abkcdj->...abcdik", gamma, G.conj())
    P = np.einsum("...abcdij,...abcdji->...abcd", into, back).real
    absorbed = -2 * np.einsum("...ababii->...ab", into).imag
    out = np.empty((*shape, 2, 4))
    for c in range(2):  # at +ω electrons come in, at −ω (by particle–hole symmetry) holes
        for lead in range(2):
            net = absorbed[..., lead, c] - P[..., lead, c, lead, c]
            out[..., c, lead] = net + P[..., lead, 1 - c, lead, c]
            far = 1 - lead
            out[..., c, 3 - lead] = P[..., far, c, lead, c] - P[..., far, 1 - c, lead, c]
    return np.asarray(out.swapaxes(1, 2))


def reflection_determinant(
    wires: Sequence[Nanowire], mu: FloatArray, B: FloatArray, theta: float
) -> FloatArray:
    """Return det r at ω = 0 of both ends, shape (wire, lead, mu, B), as in `compiled`."""
    G, sigma = _end_green_functions(wires, mu, B, np.zeros(1), theta, GROWTH_LIMIT)
    determinant = np.empty((len(wires), 2, mu.size, B.size))
    for lead in range(2):
        gamma = np.zeros((len(wires), B.size, 1, 4, 4), dtype=np.complex128)
        for charge, at in enumerate(CHARGES):
            block = sigma[:, :, :, 0, lead, charge]
            gamma[..., at, at] = 1j * (block - block.conj().swapaxes(-1, -2))
        end = slice(4 * lead, 4 * lead + 4)
        r = 1j * gamma @ G[:, :, :, 0, end, end] - np.eye(4)
        determinant[:, lead] = np.linalg.det(r).real.swapaxes(1, 2)
    return determinant


def _end_green_functions(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    theta: float,
    growth_limit: float,
) -> tuple[ComplexArray, ComplexArray]:
    """Return G of the ends with their leads, and the leads' self-energies, in the rotated frame.

    Returns
    -------
    G : array, shape (wire, B, mu, omega, 8, 8)
        In units of 1/t', left end first.
    sigma : array, shape (wire, B, 1, omega, lead, charge, 2, 2)
        In units of t'.
    """
    leads = partial(tilted_lead_self_energies, theta=theta)
    p = prepare(wires, mu, B, omega, retarded_pairing_factors, leads)
    field = _rotated_field(p, wires, B, theta)
    M, growth = _isolated_ends(p, field)
    sigma = p.sigma[:, :, None]
    for lead in range(2):
        for charge in range(2):
            at = slice(4 * lead + 2 * charge, 4 * lead + 2 * charge + 2)
            M[..., at, at] -= sigma[:, :, :, :, lead, charge]
    bad = ~(growth < growth_limit**2)  # NaN too
    M[bad] = np.eye(8)
    G: ComplexArray = np.asarray(np.linalg.inv(M), dtype=np.complex128)
    for w, f, m, e in np.argwhere(bad):
        terms = p.kinetic[w, m], p.normal[w, e], p.anomalous[w, e]
        G[w, f, m, e] = _ends_by_pivoting(p.V[w], field[w, f], terms, p.sigma[w, f, e])
    return G, sigma


def isolated_green_functions(
    wires: Sequence[Nanowire], mu: FloatArray, B: FloatArray, z: ComplexArray, theta: float
) -> ComplexArray:
    """Return G of the ends of the wires without leads, shape (wire, B, mu, z, 8, 8), in 1/meV.

    In the rotated frame, left end first, at energies z with |Re z| < Δ₀ and Im z > 0, where no
    pivot can vanish.
    """
    p = prepare(wires, mu, B, z, pairing_factors, _no_leads)
    M, _ = _isolated_ends(p, _rotated_field(p, wires, B, theta))
    hop = np.array([w.rotated_hopping for w in wires]).reshape(-1, *[1] * 5)
    return np.asarray(np.linalg.inv(M) / hop, dtype=np.complex128)


def _no_leads(wire: Nanowire, B: float, z: ComplexArray) -> ComplexArray:
    return np.zeros((z.size, 2, 2, 2, 2), dtype=np.complex128)


def _rotated_field(
    p: Problem, wires: Sequence[Nanowire], B: FloatArray, theta: float
) -> FloatArray:
    """Return the Zeeman term's components in the rotated frame, shape (wire, B, site, 3)."""
    across = np.array([w.zeeman_per_tesla / w.rotated_hopping for w in wires])[:, None] * B
    x, z = np.cos(theta) * p.zeeman_x, np.cos(theta) * p.zeeman_z
    y = np.broadcast_to(np.sin(theta) * across[..., None], x.shape)
    return np.stack([x, y, z], axis=-1)


def _isolated_ends(p: Problem, field: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """Return M of the ends, (wire, B, mu, omega, 8, 8), and the largest squared inverse pivot."""
    compile_kernels()
    shape = (*field.shape[:2], p.kinetic.shape[1], p.normal.shape[1])
    M = np.empty((*shape[:2], shape[2] * shape[3], 8, 8), dtype=np.complex128)
    growth = np.empty(M.shape[:3])
    _kernel(p, field, M, growth)
    return M.reshape(*shape, 8, 8), growth.reshape(shape)


@nb.njit(cache=True, parallel=True)
def _kernel(
    p: Problem, field: FloatArray, out: ComplexArray, growth: FloatArray
) -> None:  # pragma: no cover
    """Fill out (wire, B, mu·omega, 8, 8), M of the ends, and growth (wire, B, mu·omega)."""
    wires, fields, pairs = growth.shape
    energies, pieces = p.normal.shape[1], (pairs + WIDTH - 1) // WIDTH
    for task in nb.prange(wires * fields * pieces):
        w, f, first = task // pieces // fields, task // pieces % fields, task % pieces * WIDTH
        s, grown, terms = np.empty(128 * WIDTH), np.empty(WIDTH), np.empty((5, WIDTH))
        for l in range(WIDTH):
            pair = min(first + l, pairs - 1)
            normal, anomalous = p.normal[w, pair % energies], p.anomalous[w, pair % energies]
            terms[0, l] = p.kinetic[w, pair // energies]
            terms[1, l], terms[2, l] = normal.real, normal.imag
            terms[3, l], terms[4, l] = anomalous.real, anomalous.imag
        eliminate_inner_sites_tilted(p.V[w], field[w, f], terms, s, grown)
        for l in range(min(WIDTH, pairs - first)):
            growth[w, f, first + l] = grown[l]
            for a in range(8):
                for b in range(8):
                    at = (16 * a + 2 * b) * WIDTH + l
                    out[w, f, first + l, a, b] = complex(s[at], s[at + WIDTH])


def _ends_by_pivoting(
    V: FloatArray,
    field: FloatArray,
    terms: tuple[float, complex, complex],
    sigma: ComplexArray,
) -> ComplexArray:
    """Return the ends' G of one (μ, ω) by banded elimination with partial pivoting, (8, 8)."""
    kinetic, normal, anomalous = terms
    n = 4 * V.size
    bands = np.zeros((2 * BELOW + 1, n), dtype=np.complex128)  # entry (i, j) at [i − j + BELOW, j]
    charge, spin = np.tile([1, 1, -1, -1], V.size), np.tile([1, -1, 1, -1], V.size)
    x, y, z = np.repeat(field, 4, axis=0).T
    bands[BELOW] = normal - charge * (kinetic + np.repeat(V, 4)) - spin * z
    # by columns: from spin up to down, and back, from electron to hole, and back, site to site
    bands[BELOW + 1] = np.where(spin > 0, -x - 1j * y, 0)
    bands[BELOW - 1] = np.where(spin < 0, -x + 1j * y, 0)
    bands[BELOW + 2] = np.where(charge > 0, anomalous, 0)
    bands[BELOW - 2] = np.where(charge < 0, anomalous, 0)
    bands[BELOW + 4] = bands[BELOW - 4] = charge
    for lead in range(2):
        for c in range(2):
            at = (0 if lead == 0 else n - 4) + 2 * c
            for i in range(2):
                for j in range(2):
                    bands[i - j + BELOW, at + j] -= sigma[lead, c, i, j]
    ends = np.append(np.arange(4), np.arange(n - 4, n))
    unit = np.zeros((n, 8), dtype=np.complex128)
    unit[ends, np.arange(8)] = 1.0
    return np.asarray(solve_banded((BELOW, BELOW), bands, unit)[ends])
