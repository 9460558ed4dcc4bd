"""The kernel behind `gradient`: sweeps, ends and contraction, LANES pairs (μ, bias) at a time."""

from __future__ import annotations

from typing import NamedTuple

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics import columns
from disorder_landscape.physics.contraction import contract
from disorder_landscape.physics.ends import end_green_functions
from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.recursion import C_AT, D_AT, E_AT, LANES, STATE
from disorder_landscape.physics.responses import end_responses


class Problem(NamedTuple):
    """What the kernel needs, in units of the wire's t' = √(t² + (α/2a)²)."""

    hop: float  # t' in meV
    zeeman_per_tesla: float
    V: FloatArray  # (site,), with barriers
    angle: FloatArray  # (site,), φn
    log_hop_slope: float  # d ln t'/dα
    angle_slope: FloatArray  # (site,), d(φn)/dα
    zeeman: FloatArray  # (B,)
    kinetic: FloatArray  # (mu,), 2t − μ
    normal: FloatArray  # (bias,), ω + γω/√(Δ₀²−ω²) at ω = |bias|
    anomalous: FloatArray  # (bias,), γΔ₀/√(Δ₀²−ω²)
    hole: NDArray[np.int64]  # (bias,), 1 if the bias is negative
    sigma: ComplexArray  # (B, bias, lead, charge, 2, 2), in the rotated frame
    slopes: ComplexArray  # (B, bias, 2, lead, charge, 2, 2), d/dB and d/dα of sigma


@nb.njit(cache=True)
def _sweep(
    b: FloatArray, sites: FloatArray, V: FloatArray, x: FloatArray, z: FloatArray, s: FloatArray
) -> None:  # pragma: no cover
    """Fill the sites' records, and E, C and D of M' into s as `eliminate_inner_sites` does.

    The growth is the largest of |1/Δ| and of the squared entries of M': the loss of digits.
    """
    L, last = LANES, V.size - 1
    P = columns.P_AT * L
    columns.start(b, V[last - 1], x[last - 1], z[last - 1])
    for n in range(last - 1, 0, -1):
        columns.factor(b, sites[n], V[n - 1], x[n - 1], z[n - 1])
    for k in range(10 * L):
        s[E_AT * L + k] = b[columns.D_AT * L + k]
    columns.start(b, V[1], x[1], z[1])
    for k in range(16 * L):
        sites[0, P + k] = 1.0 if k // L % 5 == 0 else 0.0
    for n in range(1, last):
        columns.carry(sites[n], sites[n - 1, P:], sites[n, P:])
        columns.factor(b, sites[n], V[n + 1], x[n + 1], z[n + 1])
    for k in range(10 * L):
        s[D_AT * L + k] = b[columns.D_AT * L + k]
    for i in range(4):
        for j in range(4):
            for l in range(L):
                entry = sites[last - 1, P + (4 * j + i) * L + l]
                s[(C_AT + 4 * i + j) * L + l] = entry if j < 2 else -entry
    for k in range(36 * L):  # a large M', of a level of the inner sites, cancels against large X_n
        b[columns.GROWTH * L + k % L] = max(b[columns.GROWTH * L + k % L], s[k] ** 2)


@nb.njit(cache=True)
def _weigh(
    b: FloatArray, s: FloatArray, p: Problem, field: int, energy: NDArray[np.int64]
) -> FloatArray:  # pragma: no cover
    """Write S, the symmetric part of −2 Re Y, into b; return what the leads add, (lane, 4, 2)."""
    L = LANES
    re, im = np.empty(64 * L), np.empty(64 * L)
    G, Y = np.empty((8, 8), dtype=np.complex128), np.empty((4, 8, 8), dtype=np.complex128)
    T, ends = np.empty((4, 2, 8), dtype=np.complex128), np.empty((L, 4, 2))
    end_green_functions(s, p.sigma[field], energy, re, im)
    for l in range(L):
        for i in range(8):
            for j in range(8):
                at = (8 * min(i, j) + max(i, j)) * L + l
                G[i, j] = -complex(re[at], im[at])
        e = energy[l]
        end_responses(G, p.sigma[field, e], p.slopes[field, e], p.hole[e], T, Y, ends[l])
        for column in range(4):
            for row in range(column + 1):
                for entry in range(4):
                    i, j = 2 * row + entry // 2, 2 * column + entry % 2
                    at = columns.FORMS + 24 * (column * (column + 1) // 2 + row) + 6 * entry
                    for k in range(4):
                        S = -(Y[k, i, j] + Y[k, j, i]).real * (1 if i == j else 2)
                        b[(at + 2 + k) * L + l] = S if i <= j else 0.0
    return ends


@nb.njit(cache=True)
def _collect(
    b: FloatArray, p: Problem, field: int, l: int, ends: FloatArray, out: FloatArray
) -> None:  # pragma: no cover
    """Write the derivatives with respect to μ, B and α into out, shape (4, 3)."""
    L = LANES
    for k in range(4):
        by_field, by_turn = 0.0, 0.0
        for entry in range(40):
            at = (columns.FORMS + 6 * entry) * L + l
            by_field += b[at] * b[at + (2 + k) * L]
            by_turn += b[at + L] * b[at + (2 + k) * L]
        total, weighted = b[(columns.SUM + k) * L + l], b[(columns.V_SUM + k) * L + l]
        scaled = b[columns.KINETIC * L + l] * total + weighted + p.zeeman[field] * by_field
        out[k, 0] = total / p.hop
        out[k, 1] = ends[k, 0] - p.zeeman_per_tesla * by_field
        out[k, 2] = ends[k, 1] + by_turn + p.log_hop_slope * scaled


@nb.njit(cache=True)
def _solve_lanes(
    p: Problem,
    field: int,
    first: int,
    records: FloatArray,
    by_V: FloatArray,
    others: FloatArray,
    growth: FloatArray,
) -> None:  # pragma: no cover
    """Fill by_V (4, lane, site), others (lane, 4, 3), growth (lane) for pairs from `first` on."""
    L, sites, biases, per_hop = LANES, p.V.size, p.normal.size, 1.0 / p.hop
    b, s, Q = np.zeros(columns.ENTRIES * L), np.empty(STATE * L), np.zeros((3, 16 * L))
    energy = np.empty(L, dtype=np.int64)
    for l in range(L):
        pair = min(first + l, p.kinetic.size * biases - 1)
        energy[l] = pair % biases
        w, a = p.normal[energy[l]], p.anomalous[energy[l]]
        b[columns.KINETIC * L + l] = p.kinetic[pair // biases]
        b[columns.NORMAL * L + l], b[columns.ANOMALOUS * L + l] = w, a
        b[columns.SCALED * L + l] = -p.log_hop_slope * w
        b[(columns.SCALED + 1) * L + l] = -p.log_hop_slope * a
    x, z = p.zeeman[field] * np.cos(2 * p.angle), p.zeeman[field] * np.sin(2 * p.angle)
    _sweep(b, records, p.V, x, z, s)
    ends = _weigh(b, s, p, field, energy)
    zero, now, after = Q[0], Q[1], Q[2]
    for k in range(16 * L):
        now[k] = 1.0 if k // L % 5 == 0 else 0.0
    for n in range(sites - 1, -1, -1):
        P = records[n, columns.P_AT * L :] if n < sites - 1 else zero
        if 0 < n < sites - 1:
            columns.carry(records[n], now, after)
            now, after = after, now
        turn = 2 * p.zeeman[field] * p.angle_slope[n]
        c, d = np.cos(np.pi / 4 - p.angle[n]), np.sin(np.pi / 4 - p.angle[n])
        contract(b, P, now if n > 0 else zero, p.V[n], c, d, turn)
        for k in range(4 * L):
            records[n, k] = b[columns.SITE_SUM * L + k]  # the record is no longer needed
    for l in range(growth.size):
        growth[l] = b[columns.GROWTH * L + l]
        _collect(b, p, field, l, ends[l], others[l])
        for k in range(4):
            for n in range(sites):
                by_V[k, l, n] = -records[n, k * L + l] * per_hop


@nb.njit(cache=True, parallel=True)
def gradient_kernel(
    p: Problem, workers: int, by_V: FloatArray, others: FloatArray, growth: FloatArray
) -> None:  # pragma: no cover
    """Fill by_V (4, B, mu·bias, site), others (B, mu·bias, 4, 3) and the growth (B, mu·bias)."""
    fields, pairs = growth.shape
    pieces = (pairs + LANES - 1) // LANES
    for worker in nb.prange(workers):
        records = np.empty((p.V.size, columns.RECORD * LANES))
        for task in range(worker, fields * pieces, workers):
            field, first = task // pieces, task % pieces * LANES
            some = slice(first, min(first + LANES, pairs))
            out = by_V[:, field, some], others[field, some], growth[field, some]
            _solve_lanes(p, field, first, records, *out)
