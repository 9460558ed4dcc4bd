"""One set's thermal average from its levels: poles, residues, closed form, and how sure it is.

What is left of the conductance beside its poles is smooth; the polynomial through its values at the
nodes is averaged exactly. Two comparisons with the solver at further energies give the error.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.dressing import (
    Leads,
    Levels,
    add_product,
    level_products,
    of_ends,
    solve_lower,
)
from disorder_landscape.physics.energy_plan import CHECKS, COMPARED, SOUGHT, EnergyPlan
from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.inverse_iteration import Batch, factor_at_energies, new_batch
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.pole_starts import start_poles
from disorder_landscape.physics.residues import Terms, conductance_terms, sum_poles
from disorder_landscape.physics.resonances import find_poles
from disorder_landscape.physics.thermal_poles import average_poles
from disorder_landscape.physics.vectors import WIDTH, everywhere, read, write

ROUGHNESS = 10.0
"""Estimated error over the smooth part's largest mismatch at the checks."""
SAFETY = 300.0
"""Estimated error over the model's largest mismatch, times t', at the checks."""


@nb.njit(cache=True, error_model="numpy")
def rational_average(
    plan: EnergyPlan,
    hop: float,
    E: FloatArray,
    weight: FloatArray,
    isolated: FloatArray,
    leads: Leads,
    green: ComplexArray,
    bare: FloatArray,
    sought: FloatArray,
    out: FloatArray,
) -> float:  # pragma: no cover
    """Write the thermal conductances of one set, shape (bias, 4); return the error estimate.

    Parameters
    ----------
    plan : EnergyPlan
    hop : float
        t' in meV.
    E, weight : arrays, shapes (level,) and (level, 8)
        From `wire_levels`.
    isolated : array, shape (8, 8)
        G of the isolated wire at the second of the picked nodes, chiral basis, 1/meV.
    leads : Leads
    green : array, shape (COMPARED, 8, 8)
        G with the leads attached at the checks, chiral basis, 1/meV.
    bare : array, shape (node + COMPARED, 2, 4)
        Conductances at ±ω.
    sought : array, shape (SOUGHT,)
        The set's own checks, which follow those of the plan, in meV.
    out : array, shape (bias, 4)
    """
    m = plan.nodes
    levels, b = level_products(E, weight), new_batch(E.size)
    omega = plan.omega[plan.picks[1]]
    start, both = start_poles(omega, isolated, plan.window, hop, E, weight, leads)
    poles, order, paired = find_poles(start, both, levels, leads, b)
    if order.size == 0 and both > 0:
        return np.inf
    terms = conductance_terms(poles, order, paired, levels, leads, b)
    checks = np.empty(COMPARED)
    checks[:CHECKS], checks[CHECKS:] = plan.omega[m:], sought
    end = 2 * (m + COMPARED)
    signed = np.zeros((end + WIDTH - 1) // WIDTH * WIDTH)  # full vectors
    signed[: 2 * m] = plan.signed[: 2 * m]
    signed[2 * m : end - COMPARED], signed[end - COMPARED : end] = checks, -checks
    smooth = np.empty((4, signed.size))
    sum_poles(signed, terms, smooth)
    for c in range(4):
        for sign in range(2):
            for k in range(m):
                at = sign * m + k
                smooth[c, at] = bare[k, sign, c] - smooth[c, at]
            for k in range(COMPARED):
                at = 2 * m + sign * COMPARED + k
                smooth[c, at] = bare[m + k, sign, c] - smooth[c, at]
        for v in range(plan.bias.size):
            total = 0.0
            for at in range(2 * m):
                total += plan.weights[v, at] * smooth[c, at]
            out[v, c] = total
    average_poles(terms, plan.bias, plan.kT, out)
    counts = _shares_that_count(checks, plan.kT, terms)
    of_model = SAFETY * hop * _mismatch(checks, levels, leads, green, counts, b)
    counts[CHECKS:] = np.sqrt(counts[CHECKS:])
    rough = ROUGHNESS * _roughness(_at_checks(plan, sought), smooth, counts)
    return float(of_model if of_model > rough else rough)


@nb.njit(cache=True, error_model="numpy")
def _shares_that_count(
    checks: FloatArray, kT: float, terms: Terms
) -> FloatArray:  # pragma: no cover
    """Return what part of a difference at each check the average can have.

    A pole misplaced by δ shows as v²δ/(ω − z)² and counts as v²δ/(kT)² in the average: so a
    difference is scaled down where a pole is nearer than kT. (Where levels are dense, the whole
    pattern of poles may be another, each with its v²/(ω − z) that counts as v²/kT: of the
    conductance there the square root of this is taken.)
    """
    shares = np.empty(COMPARED)
    for k in range(COMPARED):
        nearest = kT**2
        for n in range(terms.zr.size):
            apart = (checks[k] - terms.zr[n]) ** 2 + terms.zi[n] ** 2
            nearest = min(nearest, apart)
        shares[k] = nearest / kT**2
    return shares


@nb.njit(cache=True, error_model="numpy")
def _at_checks(plan: EnergyPlan, sought: FloatArray) -> FloatArray:  # pragma: no cover
    """Return the weights of the smooth part's values at the nodes for those at ±checks.

    At the set's own by the barycentric formula, in which Chebyshev's node u has ±√(1 − u²).
    """
    both = 2 * plan.nodes
    weights = np.empty((2 * COMPARED, both))
    for sign in range(2):
        at, of_all = sign * COMPARED, sign * CHECKS
        weights[at : at + CHECKS] = plan.at_checks[of_all : of_all + CHECKS]
        for k in range(SOUGHT):
            row, total = weights[at + CHECKS + k], 0.0
            omega = sought[k] if sign == 0 else -sought[k]
            for n in range(both):
                u = plan.signed[n] / plan.window
                row[n] = np.sqrt(1 - u * u) / (omega / plan.window - u)
                if (n % plan.nodes + n // plan.nodes) % 2 == 1:
                    row[n] = -row[n]
                total += row[n]
            row /= total
    return weights


@nb.njit(cache=True, error_model="numpy")
def _roughness(
    weights: FloatArray, smooth: FloatArray, shares: FloatArray
) -> float:  # pragma: no cover
    """Return how far the smooth part's polynomial is off at the checks, in e²/h.

    A pole that was lost, or counted twice, leaves its peak in what should be smooth.
    """
    both, worst = weights.shape[1], 0.0
    for k in range(2 * COMPARED):
        for c in range(4):
            value = -smooth[c, both + k]
            for n in range(both):
                value += weights[k, n] * smooth[c, n]
            value = abs(value) * shares[k % COMPARED]
            if not value <= worst:  # so that NaN counts
                worst = value
    return worst


@nb.njit(cache=True, error_model="numpy")
def _mismatch(
    checks: FloatArray,
    levels: Levels,
    leads: Leads,
    green: ComplexArray,
    shares: FloatArray,
    b: Batch,
) -> float:  # pragma: no cover
    """Return the largest difference of the model's G and the solver's at the checks, in 1/meV."""
    W = WIDTH
    for l in range(W):
        b.zr[l], b.zi[l] = checks[min(l, COMPARED - 1)], 0.0
    factor_at_energies(levels, leads.inverse, b)
    unit, f = np.zeros((2, 8 * W)), np.empty((8, 2, 8 * W))
    for j in range(8):
        unit[0, j * W : (j + 1) * W] = 1.0
        of_ends(b.s[0], b.s[1], unit[0], unit[1], f[j, 0], f[j, 1])
        unit[0, j * W : (j + 1) * W] = 0.0
    same_end = f.copy()  # S
    for j in range(8):
        solve_lower(b.re, b.im, f[j, 0], f[j, 1])
    worst, here = 0.0, np.empty((2, W))
    for i in range(8):
        for j in range(i, 8):
            at = i * W
            re, im = (
                everywhere(0.0) - read(same_end[j, 0], at),
                everywhere(0.0) - read(same_end[j, 1], at),
            )
            re, im = add_product(b.pivots, f[i], f[j], re, im)
            write(here[0], 0, re)
            write(here[1], 0, im)
            for k in range(COMPARED):  # no more than a vector
                off = abs(complex(here[0, k], here[1, k]) - green[k, i, j]) * shares[k]
                if not off <= worst:  # so that NaN counts
                    worst = off
    return worst
