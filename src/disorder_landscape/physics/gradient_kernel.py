"""The kernel behind `gradient`: sweeps, ends and contraction, WIDTH pairs (μ, |ω|) at a time."""

from __future__ import annotations

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.columns import RECORD, Problem, sweep
from disorder_landscape.physics.contraction import SUMS
from disorder_landscape.physics.derivatives import collect, contract
from disorder_landscape.physics.ends import CONDUCTANCE_WEIGHTS
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.responses import (
    LEAD_ENTRIES,
    end_green_functions,
    end_responses,
    pick_sign,
)
from disorder_landscape.physics.vectors import (
    WIDTH,
    Vector,
    load,
    store,
    transposed,
    vectors,
    write,
)

ONE_SIGN = np.eye(4)
"""The conductances as sums of the quantities, where these are the conductances themselves."""


@nb.njit(cache=True, error_model="numpy")
def _weigh(
    state: FloatArray,
    p: Problem,
    field: int,
    energy: NDArray[np.int64],
    S: FloatArray,
    ends: FloatArray,
) -> None:  # pragma: no cover
    """Write S and what the leads add of the six probabilities."""
    leads = vectors(LEAD_ENTRIES)
    for l in range(WIDTH):
        sigma, slopes = p.sigma[field, energy[l]], p.slopes[field, energy[l]]
        for c in range(4):
            for d in range(3):
                part = sigma[c // 2, c % 2] if d == 0 else slopes[d - 1, c // 2, c % 2]
                for entry in range(3):
                    value, at = part[entry // 2, (entry + 1) // 2], 2 * (9 * c + 3 * d + entry)
                    leads[at * WIDTH + l], leads[(at + 1) * WIDTH + l] = value.real, value.imag
    re, im = vectors(64), vectors(64)
    end_green_functions(state, leads, re, im)
    end_responses(re, im, leads, S, ends)


@nb.njit(cache=True, error_model="numpy")
def _solve_lanes(
    p: Problem,
    field: int,
    first: int,
    both: bool,
    records: FloatArray,
    by_V: FloatArray,
    others: FloatArray,
    growth: FloatArray,
) -> None:  # pragma: no cover
    """Fill rows of by_V and others as `gradient_kernel` does, and the growth (mu·omega)."""
    sites, energies, zeeman = p.V.size, p.normal.size, p.zeeman[field]
    pairs, quantities = p.kinetic.size * energies, 6 if both else 4
    terms, state, answers = vectors(4), vectors(36), vectors(18)
    S, ends, sums = vectors(216), vectors(12), vectors(SUMS)
    energy, signs = np.empty(WIDTH, dtype=np.int64), np.empty(WIDTH)
    for l in range(WIDTH):
        energy[l] = min(first + l, pairs - 1) % energies
        terms[l] = p.kinetic[min(first + l, pairs - 1) // energies]
        terms[WIDTH + l] = p.normal[energy[l]]
        terms[2 * WIDTH + l] = p.anomalous[energy[l]]
        signs[l] = 1.0 if p.biases[energy[l], 0] < 0 else 0.0
    sweep(terms, records, p, zeeman, state)
    _weigh(state, p, field, energy, S, ends)
    if not both:
        picked, picked_ends = vectors(144), vectors(8)
        pick_sign(S, ends, signs, picked, picked_ends)
        S, ends = picked, picked_ends
    contract(p, zeeman, terms, records, S, quantities, sums)
    collect(p, zeeman, terms, S, ends, quantities, sums, records, answers)
    lanes, biases = min(WIDTH, pairs - first), p.biases.max() + 1
    rows, spare = np.empty(WIDTH, dtype=np.int64), others.shape[1] // 3 - 1
    for l in range(lanes):
        growth[first + l] = terms[3 * WIDTH + l]
    for sign in range(2 if both else 1):
        rows[:] = spare
        for l in range(lanes):
            bias, mu = p.biases[energy[l], sign], (first + l) // energies
            if not both:
                bias = p.biases[energy[l]].max()
            if bias >= 0:
                rows[l] = (field * p.kinetic.size + mu) * biases + bias
        if rows.min() == spare:
            continue
        for k in range(4):
            weights = CONDUCTANCE_WEIGHTS[sign, k] if both else ONE_SIGN[k]
            which = np.flatnonzero(weights)
            weights = weights[which]
            _write(records, RECORD, which, -1 / p.hop * weights, rows, sites, by_V[k])
            _write(answers, 1, 3 * which, weights, rows, 3, others[k])


@nb.njit(inline="always")
def _mixed(
    source: FloatArray, at: int, which: NDArray[np.int64], weights: FloatArray
) -> Vector:  # pragma: no cover
    """Return the weighted sum of some of what starts at `at`."""
    total = weights[0] * load(source, at + which[0])
    for k in range(1, which.size):
        total = total + weights[k] * load(source, at + which[k])
    return total


@nb.njit(cache=True, error_model="numpy")
def _write(
    source: FloatArray,
    stride: int,
    which: NDArray[np.int64],
    weights: FloatArray,
    rows: NDArray[np.int64],
    sites: int,
    out: FloatArray,
) -> None:  # pragma: no cover
    """Write weighted sums of quantities, site after site, lane l to row rows[l]."""
    some = vectors(WIDTH)
    whole = sites - sites % WIDTH
    for n in range(0, whole, WIDTH):
        at = n * stride
        a, b = _mixed(source, at, which, weights), _mixed(source, at + stride, which, weights)
        at += 2 * stride
        c, d = _mixed(source, at, which, weights), _mixed(source, at + stride, which, weights)
        at += 2 * stride
        e, f = _mixed(source, at, which, weights), _mixed(source, at + stride, which, weights)
        at += 2 * stride
        g, h = _mixed(source, at, which, weights), _mixed(source, at + stride, which, weights)
        a, b, c, d, e, f, g, h = transposed((a, b, c, d, e, f, g, h))
        write(out, rows[0] * sites + n, a)
        write(out, rows[1] * sites + n, b)
        write(out, rows[2] * sites + n, c)
        write(out, rows[3] * sites + n, d)
        write(out, rows[4] * sites + n, e)
        write(out, rows[5] * sites + n, f)
        write(out, rows[6] * sites + n, g)
        write(out, rows[7] * sites + n, h)
    for n in range(whole, sites):
        store(some, 0, _mixed(source, n * stride, which, weights))
        for l in range(WIDTH):
            out[rows[l] * sites + n] = some[l]


@nb.njit(cache=True, parallel=True)
def gradient_kernel(
    p: Problem, workers: int, by_V: FloatArray, others: FloatArray, growth: FloatArray
) -> None:  # pragma: no cover
    """Write the derivatives at all points.

    Parameters
    ----------
    p : Problem
    workers : int
        How many share the work; each needs room for the records of one wire.
    by_V, others : arrays, shapes (4, rows · site) and (4, rows · 3)
        Those of G_LL, G_RR, G_LR, G_RL with respect to V, and to μ, B and α; a row for each
        (B, μ, bias), and a last one for what is not asked for.
    growth : array, shape (B, mu · omega)
        How many digits were lost, as `columns.sweep` measures it.
    """
    fields, pairs = growth.shape
    pieces = (pairs + WIDTH - 1) // WIDTH
    both = False
    for e in range(p.normal.size):
        both |= p.biases[e, 0] >= 0 and p.biases[e, 1] >= 0
    for worker in nb.prange(workers):
        records = vectors(p.V.size * RECORD)
        for task in range(worker, fields * pieces, workers):
            field, first = task // pieces, task % pieces * WIDTH
            out = by_V, others, growth[field]
            _solve_lanes(p, field, first, both, records, *out)
