"""From a wire's records and S to the derivatives: all sites, block by block, then their sums."""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.columns import P_AT, RECORD, Problem, carry, write_unit
from disorder_landscape.physics.contraction import (
    ENTRY,
    ROWS,
    SITES,
    TURNED,
    TURNED_PAIRS,
    add_own_tiles,
    add_tiles,
    add_turned,
    trace,
)
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.vectors import everywhere, load, store, vectors


@nb.njit(cache=True, error_model="numpy")
def contract(
    p: Problem,
    zeeman: float,
    terms: FloatArray,
    records: FloatArray,
    S: FloatArray,
    quantities: int,
    sums: FloatArray,
) -> None:  # pragma: no cover
    """Replace the records by the traces of each site and quantity; fill the sums over sites."""
    last = p.V.size - 1
    rows, forms = vectors(SITES * 8 * ROWS), vectors(36 * SITES)
    Q, turns = vectors(16 * SITES), np.empty(3 * SITES)
    a = -p.log_hop_slope * load(terms, 2)
    sums[:] = 0.0
    for top in range(last, -1, -SITES):
        some = min(SITES, top + 1)
        for m in range(some):
            n = top - m
            if n == last:
                write_unit(Q, 0, 1.0)
            elif n == 0:
                write_unit(Q, 16 * m, 0.0)
            else:
                carry(records, RECORD * n, Q, 16 * ((m - 1) % SITES), Q, 16 * m)
            turns[3 * m], turns[3 * m + 1] = p.turns[n, 0], p.turns[n, 1]
            turns[3 * m + 2] = 2 * zeeman * p.angle_slope[n]
        P = RECORD * top + P_AT
        add_own_tiles(records, P, -RECORD, turns, some, rows, 0, a, forms, sums)
        add_own_tiles(Q, 0, 16, turns, some, rows, 1, a, forms, sums)
        add_tiles(rows, some, forms, sums)
        add_turned(rows, some, sums)
        trace(forms, S, quantities, some, records, RECORD * top, -RECORD)


@nb.njit(cache=True, error_model="numpy")
def collect(
    p: Problem,
    zeeman: float,
    terms: FloatArray,
    S: FloatArray,
    ends: FloatArray,
    quantities: int,
    sums: FloatArray,
    records: FloatArray,
    answers: FloatArray,
) -> None:  # pragma: no cover
    """Write the derivatives of every quantity with respect to μ, B and α."""
    slope = p.log_hop_slope
    kinetic, normal = load(terms, 0), -slope * load(terms, 1)
    anomalous = -slope * load(terms, 2)
    weights = slope * p.V - 2 * zeeman * p.angle_slope
    for k in range(quantities):
        zero = everywhere(0.0)
        u, n, turned = zero, zero, zero
        for entry in range(36):
            s = load(S, quantities * entry + k)
            u, n = u + s * load(sums, 2 * entry), n + s * load(sums, 2 * entry + 1)
            i, j = TURNED_PAIRS[entry]
            s = load(S, quantities * ENTRY[i, j] + k)
            turned = turned + (1.0 if i == j else 0.5) * s * load(sums, TURNED + entry)
        total, weighted, more, more_weighted = zero, zero, zero, zero
        for site in range(0, p.V.size - 1, 2):  # two sums of each, as additions take their time
            x, y = load(records, RECORD * site + k), load(records, RECORD * (site + 1) + k)
            total, weighted = total + x, weighted + weights[site] * x
            more, more_weighted = more + y, more_weighted + weights[site + 1] * y
        if p.V.size % 2 == 1:
            x = load(records, RECORD * (p.V.size - 1) + k)
            total, weighted = total + x, weighted + weights[-1] * x
        total, weighted = total + more, weighted + more_weighted
        field = 2.0 * u - total
        by_alpha = normal * (field + 2.0 * n) - anomalous * field + turned + weighted
        store(answers, 3 * k, (1 / p.hop) * total)
        store(answers, 3 * k + 1, load(ends, 2 * k) - p.zeeman_per_tesla * field)
        by_alpha = by_alpha + slope * (kinetic * total + zeeman * field)
        store(answers, 3 * k + 2, load(ends, 2 * k + 1) + by_alpha)
