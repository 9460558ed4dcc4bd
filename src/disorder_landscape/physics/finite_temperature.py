"""The conductance at finite temperature, exactly: rational in energy, averaged in closed form.

For one wire, μ and B: the end Green's function and its slope at M energies (`recursion`), the
levels of the isolated wire (`levels`), the poles with the leads attached (`pole_starts`,
`inverse_iteration`, `resonances`), their residues (`residues`), the closed-form averages
(`thermal_poles`). A few further energies check the model, some the same for all sets, some where
its own levels are densest (`dense_levels`); where it is off by more than the tolerance, M grows.

What bounds it: see `recursion` for the solver. The algebra of the levels works on WIDTH sets at
once and moves matrices of some 50 × 50 through the second cache; the poles of one set are WIDTH at
a time in the first.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.compilation import compile_kernels
from disorder_landscape.physics.dense_levels import dense_energies
from disorder_landscape.physics.dressing import CUBIC, Leads, leads_between
from disorder_landscape.physics.ends import end_green_functions, lane_conductances
from disorder_landscape.physics.energy_plan import (
    CHECKS,
    COMPARED,
    SOUGHT,
    EnergyPlan,
    energy_plan,
)
from disorder_landscape.physics.fast_solver import GROWTH_LIMIT, Problem, load_lanes, prepare
from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.leads import fill_self_energies, rotate_spin
from disorder_landscape.physics.levels import isolated_end_green_function, to_chiral, wire_levels
from disorder_landscape.physics.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.physics.rational_average import rational_average
from disorder_landscape.physics.recursion import (
    ANOMALOUS,
    ANOMALOUS_SLOPE,
    GROWTH,
    KINETIC,
    LANES,
    NORMAL,
    NORMAL_SLOPE,
    STATE,
    STATE_WITH_SLOPES,
    eliminate_inner_sites,
    eliminate_inner_sites_with_slopes,
)
from disorder_landscape.physics.vectors import WIDTH

DROP = 1e-11
"""Directions of which less than this (squared, relative) is new are left out of the model."""
NODES = (12, 13, 16, 20, 28, 36)
"""Numbers of nodes that are tried in turn."""
TOLERANCE = 1e-4
"""Estimated error in e²/h above which nodes are added."""
AGREEMENT = 2.0
"""Two models that differ by less than their estimates are as wrong as the geometric mean of both:
the estimates are cautious, but models may err together."""
FLOOR = 5e-6
"""Error in e²/h that no check sees: of the kernel's cut and of the smooth part's interpolation."""


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
def _load_slopes(
    plan: EnergyPlan, w: int, energy: NDArray[np.int64], s: FloatArray
) -> None:  # pragma: no cover
    for l in range(LANES):
        s[NORMAL_SLOPE * LANES + l] = plan.slopes[w, 0, energy[l]]
        s[ANOMALOUS_SLOPE * LANES + l] = plan.slopes[w, 1, energy[l]]


class _Solved(NamedTuple):
    """The solver's data of WIDTH sets."""

    isolated: FloatArray  # (WIDTH, node, 8, 8)
    slope: FloatArray  # (WIDTH, node, 8, 8)
    green: ComplexArray  # (WIDTH, COMPARED, 8, 8), leads attached, at the checks
    bare: FloatArray  # (WIDTH, node + COMPARED, 2, 4), conductances at ±ω
    sought: FloatArray  # (WIDTH, SOUGHT), the sets' own checks in meV
    growth: FloatArray  # (WIDTH,)


@nb.njit(cache=True)
def _solve(
    p: Problem, plan: EnergyPlan, sets: NDArray[np.int64], first: int, data: _Solved
) -> None:  # pragma: no cover
    """Fill data at the nodes from set `first` on for sets of one wire and field, shape (set, 3)."""
    w, f, mu = sets[0, 0], sets[0, 1], sets[:, 2]
    s = np.empty(STATE_WITH_SLOPES * LANES)
    re, im = np.empty(64 * LANES), np.empty(64 * LANES)
    energy, at_mu = np.empty(LANES, dtype=np.int64), np.empty(LANES, dtype=np.int64)
    V, zeeman_x, zeeman_z, sigma = p.V[w], p.zeeman_x[w, f], p.zeeman_z[w, f], p.sigma[w, f]
    for i in range(mu.size):
        data.growth[first + i] = 0.0
    total = mu.size * plan.nodes
    for piece in range(0, total, LANES):
        for l in range(LANES):
            pair = min(piece + l, total - 1)
            at_mu[l], energy[l] = mu[pair // plan.nodes], pair % plan.nodes
        load_lanes(p, w, at_mu, energy, s)
        _load_slopes(plan, w, energy, s)
        eliminate_inner_sites_with_slopes(s, V, zeeman_x, zeeman_z)
        end_green_functions(s, sigma, energy, re, im)
        for l in range(min(LANES, total - piece)):
            i, e = first + (piece + l) // plan.nodes, energy[l]
            _take_growth(s, l, data.growth[i : i + 1])
            lane_conductances(re, im, sigma[e], l, data.bare[i, e])
            isolated_end_green_function(s, l, plan.hop[w], data.isolated[i, e], data.slope[i, e])


@nb.njit(cache=True)
def _take_growth(s: FloatArray, lane: int, growth: FloatArray) -> None:  # pragma: no cover
    """Replace a set's growth by that of one of its lanes if it is larger."""
    grown = s[GROWTH * LANES + lane]
    if not grown <= growth[0]:  # so that NaN spreads
        growth[0] = grown


@nb.njit(cache=True)
def _load_check(
    p: Problem,
    plan: EnergyPlan,
    at: tuple[int, int, int],
    check: int,
    sought: FloatArray,
    lane: int,
    s: FloatArray,
    sigma: ComplexArray,
) -> None:  # pragma: no cover
    """Write one lane's terms and its leads' Σ, shape (1, 2, 2, 2, 2), at a check of set `at`."""
    w, f, mu = at
    s[KINETIC * LANES + lane] = p.kinetic[w, mu]
    if check < CHECKS:
        e = plan.nodes + check
        s[NORMAL * LANES + lane], s[ANOMALOUS * LANES + lane] = p.normal[w, e], p.anomalous[w, e]
        sigma[0] = p.sigma[w, f, e]
        return
    k, hop = check - CHECKS, plan.hop[w]
    gamma, delta0 = plan.parent[w]
    root = np.sqrt(delta0**2 - sought[k] ** 2)
    s[NORMAL * LANES + lane] = sought[k] * (1 + gamma / root) / hop
    s[ANOMALOUS * LANES + lane] = gamma * delta0 / root / hop
    hopping, spin_orbit, zeeman, lead_mu = plan.leads[w]
    omega = sought[k : k + 1]
    fill_self_energies(omega, hopping, spin_orbit, zeeman * plan.B[f], lead_mu, sigma)
    rotate_spin(sigma, plan.turn[w])
    sigma /= hop


@nb.njit(cache=True)
def _solve_checks(
    p: Problem, plan: EnergyPlan, sets: NDArray[np.int64], first: int, data: _Solved
) -> None:  # pragma: no cover
    """Add the solver's data at the checks, once the sets' own are known."""
    w, f = sets[0, 0], sets[0, 1]
    s, re, im = np.empty(STATE * LANES), np.empty(64 * LANES), np.empty(64 * LANES)
    energy, sigma = np.arange(LANES), np.empty((LANES, 2, 2, 2, 2), dtype=np.complex128)
    total = sets.shape[0] * COMPARED
    for piece in range(0, total, LANES):
        for l in range(LANES):
            pair = min(piece + l, total - 1)
            i = pair // COMPARED
            at = w, f, sets[i, 2]
            sought = data.sought[first + i]
            _load_check(p, plan, at, pair % COMPARED, sought, l, s, sigma[l : l + 1])
        eliminate_inner_sites(s, p.V[w], p.zeeman_x[w, f], p.zeeman_z[w, f])
        end_green_functions(s, sigma, energy, re, im)
        for l in range(min(LANES, total - piece)):
            i, e = first + (piece + l) // COMPARED, (piece + l) % COMPARED
            _take_growth(s, l, data.growth[i : i + 1])
            lane_conductances(re, im, sigma[l], l, data.bare[i, plan.nodes + e])
            _chiral_green_function(re, im, l, plan.hop[w], data.green[i, e])


@nb.njit(cache=True)
def _leads(p: Problem, plan: EnergyPlan, w: int, f: int) -> Leads:  # pragma: no cover
    """Return the leads of wire w at field f."""
    at_picks = np.empty((CUBIC, 8, 8), dtype=np.complex128)
    for k in range(CUBIC):
        _chiral_self_energy(p.sigma[w, f, plan.picks[k]], plan.hop[w], at_picks[k])
    leads: Leads = leads_between(plan.cubic, at_picks)
    return leads


@nb.njit(cache=True)
def _average_sets(
    p: Problem,
    plan: EnergyPlan,
    growth_limit: float,
    sets: NDArray[np.int64],
    data: _Solved,
    first: int,
    E: FloatArray,
    weight: FloatArray,
    out: FloatArray,
    error: FloatArray,
) -> None:  # pragma: no cover
    """Fill out and error for sets of one wire and field, whose data and levels start at `first`.

    A function of its own, so that `leads` is assigned once: where a loop replaced it now and then,
    Numba released the arrays while they were in use.
    """
    w, f = sets[0, 0], sets[0, 1]
    leads = _leads(p, plan, w, f)
    for i in range(sets.shape[0]):
        at, mu = first + i, sets[i, 2]
        estimate = np.inf
        if E.shape[1] > 0 and data.growth[at] < growth_limit:
            estimate = rational_average(
                plan,
                plan.hop[w],
                E[at],
                weight[at],
                data.isolated[at, plan.picks[1]],
                leads,
                data.green[at],
                data.bare[at],
                data.sought[at],
                out[w, f, mu],
            )
        error[w, f, mu] = estimate


@nb.njit(cache=True)
def _end_of_group(sets: NDArray[np.int64], first: int) -> int:  # pragma: no cover
    """Return where the sets of the wire and field of set `first` end."""
    last = first
    while (
        last < sets.shape[0] and sets[last, 0] == sets[first, 0] and sets[last, 1] == sets[first, 1]
    ):
        last += 1
    return last


@nb.njit(cache=True)
def _calculate(
    p: Problem,
    plan: EnergyPlan,
    growth_limit: float,
    sets: NDArray[np.int64],
    out: FloatArray,
    error: FloatArray,
) -> None:  # pragma: no cover
    """Fill out and error for up to WIDTH sets."""
    W, m, count = WIDTH, plan.nodes, sets.shape[0]
    data = _Solved(
        np.empty((W, m, 8, 8)),
        np.empty((W, m, 8, 8)),
        np.empty((W, COMPARED, 8, 8), dtype=np.complex128),
        np.empty((W, m + COMPARED, 2, 4)),
        np.empty((W, SOUGHT)),
        np.empty(W),
    )
    first = 0
    while first < count:
        last = _end_of_group(sets, first)
        _solve(p, plan, sets[first:last], first, data)
        first = last
    for i in range(count, W):  # a vector has to be full
        data.isolated[i], data.slope[i] = data.isolated[0], data.slope[0]
    E, weight = np.empty((W, 8 * m)), np.empty((W, 8 * m, 8))
    levels = wire_levels(plan.omega[:m], data.isolated, data.slope, DROP, E, weight)
    some_E, some_weight = E[:, :levels].copy(), weight[:, :levels].copy()
    first = 0
    while first < count:
        last = _end_of_group(sets, first)
        some = sets[first:last]
        for i in range(first, last):
            hop = plan.hop[sets[i, 0]]
            dense_energies(some_E[i], some_weight[i], hop, plan.window, data.sought[i])
        _solve_checks(p, plan, some, first, data)
        _average_sets(p, plan, growth_limit, some, data, first, some_E, some_weight, out, error)
        first = last


@nb.njit(cache=True, parallel=True)
def _kernel(
    p: Problem,
    plan: EnergyPlan,
    growth_limit: float,
    sets: NDArray[np.int64],
    out: FloatArray,
    error: FloatArray,
) -> None:  # pragma: no cover
    """Fill out (wire, B, mu, bias, 4) and error (wire, B, mu) for sets (wire, B, mu)."""
    total = sets.shape[0]
    for task in nb.prange((total + WIDTH - 1) // WIDTH):
        some = sets[task * WIDTH : min((task + 1) * WIDTH, total)]
        _calculate(p, plan, growth_limit, some, out, error)


def _where(wanted: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the indices of the sets that are wanted, shape (set, 3), always in one layout."""
    return np.ascontiguousarray(np.argwhere(wanted))


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
    sets = _where(np.ones(shape, dtype=bool))
    earlier: list[FloatArray] = []
    for nodes in NODES:
        plan = energy_plan(wires, B, bias, kT, nodes)
        found, estimate = np.full_like(G, np.nan), np.full(shape, np.inf)
        _kernel(prepare(wires, mu, B, plan.omega), plan, growth_limit, sets, found, estimate)
        found[~np.isfinite(estimate)] = np.nan
        energies[tuple(sets.T)] += nodes + COMPARED
        for other in earlier:  # NaN agrees with nothing
            apart = AGREEMENT * abs(found - other).max(axis=(-1, -2))
            estimate = np.where(apart < estimate, np.sqrt(apart * estimate), estimate)
        estimate += FLOOR
        better = estimate < error
        G[better], error[better] = found[better], estimate[better]
        sets = _where(error > tolerance)
        if sets.size == 0:
            break
        earlier.append(found)
    return G.swapaxes(1, 2), error.swapaxes(1, 2), energies.swapaxes(1, 2)
