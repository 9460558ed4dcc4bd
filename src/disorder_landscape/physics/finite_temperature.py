"""The conductance at finite temperature, exactly: rational in energy, averaged in closed form.

For one wire, μ and B: the end Green's function and its slope at M energies (`recursion`), the
levels of the isolated wire (`levels`), the poles with the leads attached (`resonances`), their
residues (`residues`), the closed-form averages (`thermal_poles`). A few further energies check the
model; where it is off by more than the tolerance, M grows.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.compilation import compile_kernels
from disorder_landscape.physics.ends import end_green_functions, lane_conductances
from disorder_landscape.physics.fast_solver import GROWTH_LIMIT, Problem, prepare
from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.levels import isolated_end_green_function, to_chiral, wire_levels
from disorder_landscape.physics.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.physics.recursion import (
    ANOMALOUS,
    ANOMALOUS_SLOPE,
    GROWTH,
    KINETIC,
    LANES,
    NORMAL,
    NORMAL_SLOPE,
    STATE_WITH_SLOPES,
    eliminate_inner_sites,
    eliminate_inner_sites_with_slopes,
)
from disorder_landscape.physics.residues import conductance_residues, pole_sum
from disorder_landscape.physics.resonances import (
    CUBIC,
    UPPER,
    chosen_vectors,
    green_functions_at,
    level_products,
    polish_poles,
    right_half,
    start_poles,
)
from disorder_landscape.physics.thermal_poles import (
    REACH,
    chebyshev_nodes,
    interpolation_weights,
    thermal_node_weights,
    thermal_pole,
)

DROP = 1e-11
"""Directions of which less than this (squared, relative) is new are left out of the model."""
CHUNK = 4
"""Chemical potentials of one task: with CHECKS energies each they fill the lanes."""
CHECKS = 4
"""Energies at which the model is compared with the solver."""
NODES = (12, 13, 16, 20, 28, 36)
"""Numbers of nodes that are tried in turn."""
TOLERANCE = 1e-4
"""Estimated error in e²/h above which nodes are added."""
ROUGHNESS = 10.0
"""Estimated error over the smooth part's largest mismatch at the checks."""
FLOOR = 5e-6
"""Error in e²/h that no check sees: of the kernel's cut and of the smooth part's interpolation."""
SAFETY = 300.0
"""Estimated error over the model's largest mismatch, times t', at the checks."""


class _Plan(NamedTuple):
    """What the kernel needs to know of the energies."""

    nodes: int
    window: float  # W in meV
    omega: FloatArray  # (node + CHECKS,) in meV
    picks: NDArray[np.int64]  # (CUBIC,) nodes through which Σ is interpolated
    cubic: FloatArray  # (CUBIC, CUBIC), inverse of their Vandermonde matrix
    plus: FloatArray  # (bias, node), weights of the values at ω_k
    minus: FloatArray  # (bias, node), at −ω_k
    at_checks: FloatArray  # (CHECKS, 2, 2 · node), of both for the value at ±(a check)
    bias: FloatArray  # (bias,)
    kT: float
    slopes: FloatArray  # (wire, 2, node + CHECKS): of the normal and anomalous terms
    hop: FloatArray  # (wire,)


def _plan(wires: Sequence[Nanowire], bias: FloatArray, kT: float, nodes: int) -> _Plan:
    window = abs(bias).max() + REACH * kT
    between = np.arange(1, CHECKS + 1) * (nodes - 1) // CHECKS
    theta = np.pi * between / (2 * nodes)
    omega = np.concatenate([chebyshev_nodes(window, nodes), window * np.sin(theta)])
    picks = ((np.arange(CUBIC) + 0.5) * nodes / CUBIC).astype(np.int64)
    plus, minus = thermal_node_weights(bias, kT, window, nodes)
    checks = np.stack([omega[nodes:], -omega[nodes:]], axis=1).reshape(-1) / window
    slopes = np.empty((len(wires), 2, omega.size))
    hop = np.array([np.hypot(w.hopping, w.spin_orbit_hopping) for w in wires])
    for wire, slope, t in zip(wires, slopes, hop, strict=True):
        root = np.sqrt(wire.delta0**2 - omega**2)
        slope[0] = (1 + wire.gamma / root + wire.gamma * omega**2 / root**3) / t
        slope[1] = wire.gamma * wire.delta0 * omega / root**3 / t
    return _Plan(
        nodes=nodes,
        window=window,
        omega=omega,
        picks=picks,
        cubic=np.linalg.inv(np.vander(omega[picks], CUBIC, increasing=True)),
        plus=plus,
        minus=minus,
        at_checks=interpolation_weights(checks, nodes).reshape(CHECKS, 2, 2 * nodes),
        bias=bias,
        kT=kT,
        slopes=slopes,
        hop=hop,
    )


@nb.njit(cache=True)
def _chiral_green_function(
    re: FloatArray, im: FloatArray, lane: int, hop: float, out: ComplexArray
) -> None:  # pragma: no cover
    """Turn −G of `ends` into G, chiral basis, 1/meV."""
    for i in range(8):
        for j in range(i, 8):
            at = (8 * i + j) * LANES + lane
            out[i, j] = -complex(re[at], im[at]) / hop
            out[j, i] = out[i, j]
    to_chiral(out)


@nb.njit(cache=True)
def _chiral_self_energy(
    sigma: ComplexArray, hop: float, out: ComplexArray
) -> None:  # pragma: no cover
    """Write the leads' Σ, shape (lead, charge, 2, 2) in units of t', as an 8×8 matrix in meV."""
    out[:] = 0.0
    for lead in range(2):
        for charge in range(2):
            first = 4 * lead + 2 * charge
            for i in range(2):
                for j in range(2):
                    out[first + i, first + j] = sigma[lead, charge, i, j] * hop
    to_chiral(out)


@nb.njit(cache=True)
def _self_energy_terms(plan: _Plan, lead: ComplexArray) -> ComplexArray:  # pragma: no cover
    """Return the coefficients of 1, ω, ω², ω³ of Σ's upper triangle, from Σ at the picked nodes."""
    terms = np.zeros((CUBIC, UPPER), dtype=np.complex128)
    for p in range(CUBIC):
        for k in range(CUBIC):
            at = 0
            for i in range(8):
                for j in range(i, 8):
                    terms[p, at] += plan.cubic[p, k] * lead[k, i, j]
                    at += 1
    return terms


@nb.njit(cache=True)
def _load_lanes(
    p: Problem,
    plan: _Plan,
    s: FloatArray,
    w: int,
    mu: NDArray[np.int64],
    energy: NDArray[np.int64],
) -> None:  # pragma: no cover
    for l in range(LANES):
        s[KINETIC * LANES + l] = p.kinetic[w, mu[l]]
        s[NORMAL * LANES + l] = p.normal[w, energy[l]]
        s[ANOMALOUS * LANES + l] = p.anomalous[w, energy[l]]
        s[NORMAL_SLOPE * LANES + l] = plan.slopes[w, 0, energy[l]]
        s[ANOMALOUS_SLOPE * LANES + l] = plan.slopes[w, 1, energy[l]]


class _Solved(NamedTuple):
    """The solver's data of one (wire, B) and up to CHUNK chemical potentials."""

    isolated: FloatArray  # (CHUNK, node, 8, 8)
    slope: FloatArray  # (CHUNK, node, 8, 8)
    green: ComplexArray  # (CHUNK, CHECKS, 8, 8), leads attached, at the checks
    bare: FloatArray  # (CHUNK, node + CHECKS, 2, 4), conductances at ±ω
    growth: FloatArray  # (CHUNK,)


@nb.njit(cache=True)
def _solve(
    p: Problem, plan: _Plan, w: int, f: int, mu: NDArray[np.int64], data: _Solved
) -> None:  # pragma: no cover
    """Fill data for the chemical potentials with indices mu."""
    s = np.empty(STATE_WITH_SLOPES * LANES)
    re, im = np.empty(64 * LANES), np.empty(64 * LANES)
    energy, at_mu = np.empty(LANES, dtype=np.int64), np.empty(LANES, dtype=np.int64)
    V, zeeman_x, zeeman_z, sigma = p.V[w], p.zeeman_x[w, f], p.zeeman_z[w, f], p.sigma[w, f]
    data.growth[:] = 0.0
    for checking in range(2):
        each = CHECKS if checking else plan.nodes
        total = mu.size * each
        for first in range(0, total, LANES):
            for l in range(LANES):
                pair = min(first + l, total - 1)
                at_mu[l], energy[l] = mu[pair // each], pair % each + checking * plan.nodes
            _load_lanes(p, plan, s, w, at_mu, energy)
            if checking:
                eliminate_inner_sites(s, V, zeeman_x, zeeman_z)
            else:
                eliminate_inner_sites_with_slopes(s, V, zeeman_x, zeeman_z)
            end_green_functions(s, sigma, energy, re, im)
            for l in range(min(LANES, total - first)):
                i, e = (first + l) // each, energy[l]
                growth = s[GROWTH * LANES + l]
                if not growth <= data.growth[i]:  # so that NaN spreads
                    data.growth[i] = growth
                lane_conductances(re, im, sigma[e], l, data.bare[i, e])
                if checking:
                    at = data.green[i, e - plan.nodes]
                    _chiral_green_function(re, im, l, plan.hop[w], at)
                else:
                    isolated_end_green_function(
                        s, l, plan.hop[w], data.isolated[i, e], data.slope[i, e]
                    )


@nb.njit(cache=True)
def _average(
    plan: _Plan,
    sigma: ComplexArray,
    hop: float,
    isolated: FloatArray,
    slope: FloatArray,
    green: ComplexArray,
    bare: FloatArray,
    out: FloatArray,
) -> float:  # pragma: no cover
    """Write the thermal conductances of one set, shape (bias, 4); return the error estimate."""
    m = plan.nodes
    E, weight = np.empty(8 * m), np.empty((8 * m, 8))
    count = wire_levels(plan.omega[:m], isolated, slope, E, weight, DROP)
    if count == 0:
        return np.inf
    E, weight = E[:count], weight[:count]
    lead = np.empty((CUBIC, 8, 8), dtype=np.complex128)
    for k in range(CUBIC):
        _chiral_self_energy(sigma[plan.picks[k]], hop, lead[k])
    z = np.empty(2 * count, dtype=np.complex128)
    up, down = np.zeros((4 * count, count)), np.zeros((4 * count, count))
    at = plan.picks[1]
    started, both = start_poles(
        plan.omega[at], isolated[at], lead[1], plan.window, hop, E, weight, z, up, down
    )
    kept = np.arange(started)
    z, up, down = (
        z[:started],
        chosen_vectors(up, kept, 2 * count),
        chosen_vectors(down, kept, 2 * count),
    )
    levels, terms = level_products(E, weight), _self_energy_terms(plan, lead)
    v = polish_poles(z, up, down, levels, terms)
    paired, single = right_half(z, v, up, down)
    if 2 * paired + single != both:
        return np.inf
    half = paired + single
    z, v = z[:half], v[:half]
    at_poles_and_checks = np.empty(half + CHECKS, dtype=np.complex128)
    for k in range(half):
        at_poles_and_checks[k] = np.conj(z[k])
    for k in range(CHECKS):
        at_poles_and_checks[half + k] = plan.omega[m + k]
    G = green_functions_at(at_poles_and_checks, levels, terms)
    r = np.empty((half, 2, 4), dtype=np.complex128)
    conductance_residues(z, v, G[:half], terms, r)
    out[:] = 0.0
    smooth, poles_at = np.empty((2 * m, 4)), np.empty(4)
    for k in range(m):
        for sign in range(2):
            w = plan.omega[k] if sign == 0 else -plan.omega[k]
            pole_sum(w, z, r, paired, poles_at)
            for c in range(4):
                smooth[sign * m + k, c] = bare[k, sign, c] - poles_at[c]
            for b in range(plan.bias.size):
                q = plan.plus[b, k] if sign == 0 else plan.minus[b, k]
                for c in range(4):
                    out[b, c] += q * smooth[sign * m + k, c]
    for j in range(half):
        for b in range(plan.bias.size):
            kernel = thermal_pole(z[j], plan.bias[b], plan.kT)
            for c in range(4):
                out[b, c] += 2 * (kernel * r[j, 0, c]).real
            if j < paired:
                kernel = thermal_pole(z[j], -plan.bias[b], plan.kT)
                for c in range(4):
                    out[b, c] += 2 * (kernel * r[j, 1, c]).real
    of_model = SAFETY * hop * _mismatch(plan, z, G[half:], green)
    rough = ROUGHNESS * _roughness(plan, z, r, paired, bare, smooth)
    return float(of_model if of_model > rough else rough)


@nb.njit(cache=True, error_model="numpy")
def _share_that_counts(plan: _Plan, z: ComplexArray, check: int) -> float:  # pragma: no cover
    """Return what part of a difference at a check the average can have.

    A pole misplaced by δ shows as v²δ/(ω − z)² and counts as v²δ/(kT)² in the average: so a
    difference is scaled down where a pole is nearer than kT.
    """
    nearest = plan.kT
    for n in range(z.size):
        nearest = min(nearest, abs(plan.omega[plan.nodes + check] - z[n]))
    return float((nearest / plan.kT) ** 2)


@nb.njit(cache=True, error_model="numpy")
def _roughness(
    plan: _Plan,
    z: ComplexArray,
    r: ComplexArray,
    paired: int,
    bare: FloatArray,
    smooth: FloatArray,
) -> float:  # pragma: no cover
    """Return how far the smooth part's polynomial is off at the checks, in e²/h.

    A pole that was lost, or counted twice, leaves its peak in what should be smooth.
    """
    m = plan.nodes
    worst = 0.0
    poles_at = np.empty(4)
    for k in range(CHECKS):
        share = _share_that_counts(plan, z, k)
        for sign in range(2):
            w = plan.omega[m + k] if sign == 0 else -plan.omega[m + k]
            pole_sum(w, z, r, paired, poles_at)
            for c in range(4):
                value = poles_at[c] - bare[m + k, sign, c]
                for n in range(2 * m):
                    value += plan.at_checks[k, sign, n] * smooth[n, c]
                value = abs(value) * share
                if not value <= worst:
                    worst = value
    return worst


@nb.njit(cache=True, error_model="numpy")
def _mismatch(
    plan: _Plan, z: ComplexArray, G: ComplexArray, green: ComplexArray
) -> float:  # pragma: no cover
    """Return the largest difference of model and solver at the checks, in 1/meV."""
    worst = 0.0
    for k in range(CHECKS):
        largest = 0.0
        for i in range(8):
            for j in range(i, 8):
                difference = abs(G[k, i, j] - green[k, i, j])
                if not difference <= largest:  # so that NaN counts
                    largest = difference
        largest *= _share_that_counts(plan, z, k)
        if not largest <= worst:
            worst = largest
    return worst


@nb.njit(cache=True, parallel=True)
def _kernel(
    p: Problem,
    plan: _Plan,
    growth_limit: float,
    tasks: NDArray[np.int64],
    out: FloatArray,
    error: FloatArray,
) -> None:  # pragma: no cover
    """Fill out (wire, B, mu, bias, 4) and error (wire, B, mu) for tasks (wire, B, first, last)."""
    for task in nb.prange(tasks.shape[0]):
        w, f, first, last = tasks[task]
        m = plan.nodes
        data = _Solved(
            np.empty((CHUNK, m, 8, 8)),
            np.empty((CHUNK, m, 8, 8)),
            np.empty((CHUNK, CHECKS, 8, 8), dtype=np.complex128),
            np.empty((CHUNK, m + CHECKS, 2, 4)),
            np.empty(CHUNK),
        )
        mu = np.arange(first, last)
        _solve(p, plan, w, f, mu, data)
        for i in range(mu.size):
            estimate = np.inf
            if data.growth[i] < growth_limit:
                estimate = _average(
                    plan,
                    p.sigma[w, f],
                    plan.hop[w],
                    data.isolated[i],
                    data.slope[i],
                    data.green[i],
                    data.bare[i],
                    out[w, f, mu[i]],
                )
            error[w, f, mu[i]] = estimate


def thermal_conductance(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    bias: FloatArray,
    temperature: float,
    tolerance: float = TOLERANCE,
    growth_limit: float = GROWTH_LIMIT,
) -> tuple[FloatArray, FloatArray, NDArray[np.int64]]:
    """Return conductances, their estimated error and how many energies each set took.

    Returns
    -------
    G : array, shape (wire, mu, B, bias, 4)
        G_LL, G_RR, G_LR, G_RL in e²/h.
    error : array, shape (wire, mu, B)
    energies : array, shape (wire, mu, B)
    """
    compile_kernels()
    kT = BOLTZMANN * temperature
    shape = (len(wires), B.size, mu.size)
    G, error = np.zeros((*shape, bias.size, 4)), np.full(shape, np.inf)
    energies = np.zeros(shape, dtype=np.int64)
    starts = np.arange(0, mu.size, CHUNK)
    grid = np.indices((len(wires), B.size, starts.size)).reshape(3, -1)
    first = starts[grid[2]]
    tasks = np.stack([grid[0], grid[1], first, np.minimum(first + CHUNK, mu.size)], axis=1)
    earlier: list[FloatArray] = []
    for nodes in NODES:
        plan = _plan(wires, bias, kT, nodes)
        found, estimate = np.full_like(G, np.nan), np.full(shape, np.inf)
        _kernel(prepare(wires, mu, B, plan.omega), plan, growth_limit, tasks, found, estimate)
        found[~np.isfinite(estimate)] = np.nan
        for w, f, start, stop in tasks:
            energies[w, f, start:stop] += plan.omega.size
        for other in earlier:  # two models that agree need no check; NaN agrees with nothing
            apart = abs(found - other).max(axis=(-1, -2))
            estimate = np.where(2 * apart < estimate, 2 * apart, estimate)
        estimate += FLOOR
        better = estimate < error
        G[better], error[better] = found[better], estimate[better]
        w, f, m = np.nonzero(error > tolerance)
        if w.size == 0:
            break
        earlier.append(found)
        tasks = np.stack([w, f, m, m + 1], axis=1)
    return G.swapaxes(1, 2), error.swapaxes(1, 2), energies.swapaxes(1, 2)
