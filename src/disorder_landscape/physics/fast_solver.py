"""The fast solver: the real recursion over all wires, fields and pairs (μ, ω), in parallel.

Same signatures as `kwant_solver`. Work is cut into pieces of one wire, one field and LANES pairs
(μ, ω); a result depends on its own lane alone, so it is the same for any number of threads.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.compilation import compile_kernels
from disorder_landscape.physics.ends import end_green_functions, lane_conductances
from disorder_landscape.physics.hamiltonian import ComplexArray, pairing_factors
from disorder_landscape.physics.leads import lead_self_energies, rotate_spin
from disorder_landscape.physics.parameters import FloatArray, Nanowire
from disorder_landscape.physics.pivoted import pivoted_end_green_functions
from disorder_landscape.physics.recursion import (
    ANOMALOUS,
    GROWTH,
    KINETIC,
    LANES,
    NORMAL,
    STATE,
    eliminate_inner_sites,
)

GROWTH_LIMIT = 1e7
"""Largest inverse pivot, or product of couplings, (in units of t') up to which real elimination is
trusted: see `recursion.LOOK_EVERY`."""


PairingFactors = Callable[[Nanowire, Any], tuple[Any, Any]]
"""What `hamiltonian.pairing_factors` is, real or complex."""
LeadSelfEnergies = Callable[[Nanowire, float, Any], ComplexArray]
"""What `leads.lead_self_energies` is, at any angle of the field."""


class Problem(NamedTuple):
    """What the kernels need, in units of each wire's t' = √(t² + (α/2a)²)."""

    V: FloatArray  # (wire, site), with barriers
    zeeman_x: FloatArray  # (wire, B, site), V_Z cos 2φn
    zeeman_z: FloatArray  # (wire, B, site), V_Z sin 2φn
    kinetic: FloatArray  # (wire, mu), 2t − μ
    normal: FloatArray | ComplexArray  # (wire, omega), ω + γω/√(Δ₀²−ω²), real below the gap
    anomalous: FloatArray | ComplexArray  # (wire, omega), γΔ₀/√(Δ₀²−ω²)
    sigma: ComplexArray  # (wire, B, omega, lead, charge, 2, 2), in the rotated frame


def prepare(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray | ComplexArray,
    factors: PairingFactors = pairing_factors,
    leads: LeadSelfEnergies = lead_self_energies,
) -> Problem:
    """Return the terms of all wires, with Σ(ω) of the parent superconductor from `factors`."""
    sites = wires[0].sites
    hop = np.array([w.rotated_hopping for w in wires])
    angle = np.array([np.arctan2(w.spin_orbit_hopping, w.hopping) for w in wires])
    zeeman = np.outer([w.zeeman_per_tesla for w in wires] / hop, B)[:, :, None]
    phases = 2 * angle[:, None, None] * np.arange(sites)
    pairing = np.array([factors(w, omega) for w in wires])
    sigma = np.array([[leads(w, field, omega) for field in B] for w in wires])
    for of_wire, phi in zip(sigma, angle, strict=True):
        for of_field in of_wire:
            rotate_spin(of_field, phi * (sites - 1))
    return Problem(
        V=np.array([w.potential_with_barriers for w in wires]) / hop[:, None],
        zeeman_x=zeeman * np.cos(phases),
        zeeman_z=zeeman * np.sin(phases),
        kinetic=(2 * np.array([[w.hopping] for w in wires]) - mu) / hop[:, None],
        normal=(omega + pairing[:, 0]) / hop[:, None],
        anomalous=pairing[:, 1] / hop[:, None],
        sigma=sigma / hop.reshape(-1, *[1] * 6),
    )


@nb.njit(cache=True)
def load_lanes(
    p: Problem, w: int, mu: NDArray[np.int64], energy: NDArray[np.int64], s: FloatArray
) -> None:  # pragma: no cover
    """Write the terms of wire w for the lanes' pairs (μ, ω), given by their indices."""
    for l in range(LANES):
        s[KINETIC * LANES + l] = p.kinetic[w, mu[l]]
        s[NORMAL * LANES + l] = p.normal[w, energy[l]]
        s[ANOMALOUS * LANES + l] = p.anomalous[w, energy[l]]


@nb.njit(cache=True)
def _solve_lanes(
    p: Problem,
    w: int,
    f: int,
    first: int,
    growth_limit: float,
    re: FloatArray,
    im: FloatArray,
) -> None:  # pragma: no cover
    """Write −G of the end sites of wire w at field f for the pairs (μ, ω) from `first` on."""
    s = np.empty(STATE * LANES)
    energy, mu = np.empty(LANES, dtype=np.int64), np.empty(LANES, dtype=np.int64)
    energies = p.normal.shape[1]
    pairs = p.kinetic.shape[1] * energies
    for l in range(LANES):
        pair = min(first + l, pairs - 1)
        mu[l], energy[l] = pair // energies, pair % energies
    load_lanes(p, w, mu, energy, s)
    V, zeeman_x, zeeman_z, sigma = p.V[w], p.zeeman_x[w, f], p.zeeman_z[w, f], p.sigma[w, f]
    eliminate_inner_sites(s, V, zeeman_x, zeeman_z)
    end_green_functions(s, sigma, energy, re, im)
    for l in range(min(LANES, pairs - first)):
        if not s[GROWTH * LANES + l] < growth_limit:  # so that NaN pivots too
            e = energy[l]
            terms = p.kinetic[w, mu[l]], p.normal[w, e], p.anomalous[w, e]
            pivoted_end_green_functions(V, zeeman_x, zeeman_z, terms, sigma[e], l, re, im)


@nb.njit(cache=True, parallel=True)
def _conductance_kernel(
    p: Problem,
    growth_limit: float,
    out: FloatArray,
) -> None:  # pragma: no cover
    """Fill out, shape (wire, B, mu·omega, 2, 4)."""
    wires, fields, pairs = out.shape[:3]
    pieces = (pairs + LANES - 1) // LANES
    for task in nb.prange(wires * fields * pieces):
        w, f, first = task // pieces // fields, task // pieces % fields, task % pieces * LANES
        re, im = np.empty(64 * LANES), np.empty(64 * LANES)
        _solve_lanes(p, w, f, first, growth_limit, re, im)
        for l in range(min(LANES, pairs - first)):
            at = p.sigma[w, f, (first + l) % p.normal.shape[1]]
            lane_conductances(re, im, at, l, out[w, f, first + l])


@nb.njit(cache=True, parallel=True)
def _end_block_kernel(
    p: Problem,
    growth_limit: float,
    out: ComplexArray,
) -> None:  # pragma: no cover
    """Fill out, shape (wire, B, mu·omega, lead, 4, 4), with G_LL and G_RR in units of 1/t'."""
    wires, fields, pairs = out.shape[:3]
    pieces = (pairs + LANES - 1) // LANES
    for task in nb.prange(wires * fields * pieces):
        w, f, first = task // pieces // fields, task // pieces % fields, task % pieces * LANES
        re, im = np.empty(64 * LANES), np.empty(64 * LANES)
        _solve_lanes(p, w, f, first, growth_limit, re, im)
        for l in range(min(LANES, pairs - first)):
            for lead in range(2):
                for i in range(4):
                    for j in range(4):
                        at = (8 * min(i, j) + max(i, j) + 36 * lead) * LANES + l
                        out[w, f, first + l, lead, i, j] = -complex(re[at], im[at])


def bare_conductance(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    growth_limit: float = GROWTH_LIMIT,
) -> FloatArray:
    """Return the T = 0 conductances at ±ω, shape (wire, mu, B, omega, 2, 4), in e²/h.

    The last axes are the sign of ω (+, −) and G_LL, G_RR, G_LR, G_RL; 0 ≤ ω < Δ₀. All wires have
    the same number of sites. Lanes that grow beyond `growth_limit` are solved by `pivoted`.
    """
    compile_kernels()
    p = prepare(wires, mu, B, omega)
    out = np.empty((len(wires), B.size, mu.size * omega.size, 2, 4))
    _conductance_kernel(p, growth_limit, out)
    shaped = out.reshape(len(wires), B.size, mu.size, omega.size, 2, 4)
    return np.asarray(shaped.swapaxes(1, 2))


def reflection_determinant(
    wires: Sequence[Nanowire], mu: FloatArray, B: FloatArray, growth_limit: float = GROWTH_LIMIT
) -> FloatArray:
    """Return det r at ω = 0 of both ends, shape (wire, lead, mu, B).

    r = −1 + iΓ^½ G Γ^½ (Fisher–Lee), so det r = det(−1 + iΓG), real by particle–hole symmetry.
    """
    compile_kernels()
    p = prepare(wires, mu, B, np.zeros(1))
    out = np.empty((len(wires), B.size, mu.size, 2, 4, 4), dtype=np.complex128)
    _end_block_kernel(p, growth_limit, out)
    gamma = np.zeros((len(wires), B.size, 1, 2, 4, 4))
    for charge in range(2):
        block = slice(2 * charge, 2 * charge + 2)
        gamma[:, :, 0, :, block, block] = -2 * p.sigma[:, :, 0, :, charge].imag
    determinant = np.linalg.det(1j * gamma @ out - np.eye(4)).real
    return np.asarray(np.moveaxis(determinant, (3, 2, 1), (1, 2, 3)))
