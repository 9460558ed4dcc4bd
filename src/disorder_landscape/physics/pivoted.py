"""The wire with its leads solved in complex arithmetic by banded elimination with partial pivoting.

Backward stable at every energy, hundreds of times slower than `recursion`: it takes the lanes in
which real elimination without pivoting has lost digits, because the wire, or a piece of it, has a
level at ω.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.recursion import LANES

BELOW = 7
"""Sub- and superdiagonals of a matrix of tridiagonal 4×4 blocks; pivoting doubles the latter."""
WIDTH = 3 * BELOW + 1
RHS = 4


@nb.njit(cache=True)
def _banded_rows(
    V: FloatArray,
    zeeman_x: FloatArray,
    zeeman_z: FloatArray,
    terms: tuple[float, float, float],
    sigma: ComplexArray,
) -> ComplexArray:  # pragma: no cover
    """Return M − Σ by rows, shape (4 · site, WIDTH): entry (i, j) is at [i, j − i + BELOW]."""
    kinetic, normal, anomalous = terms
    n = 4 * V.size
    rows = np.zeros((n, WIDTH), dtype=np.complex128)
    for site in range(V.size):
        x, z, q = zeeman_x[site], zeeman_z[site], kinetic + V[site]
        for i in range(4):
            row = 4 * site + i
            sign = 1.0 if i < 2 else -1.0
            rows[row, BELOW] = normal - sign * q - (z if i % 2 == 0 else -z)
            rows[row, BELOW + (1 if i % 2 == 0 else -1)] = -x
            rows[row, BELOW + (2 if i < 2 else -2)] = anomalous
            if site > 0:
                rows[row, BELOW - 4] = sign
            if site < V.size - 1:
                rows[row, BELOW + 4] = sign
    for lead in range(2):
        for charge in range(2):
            for i in range(2):
                row = (0 if lead == 0 else n - 4) + 2 * charge + i
                for j in range(2):
                    rows[row, BELOW + j - i] -= sigma[lead, charge, i, j]
    return rows


@nb.njit(cache=True)
def _back_substitute(rows: ComplexArray, x: ComplexArray, first: int) -> None:  # pragma: no cover
    """Solve the upper triangle for the rows from `first` on, in place."""
    n = rows.shape[0]
    for i in range(n - 1, first - 1, -1):
        for r in range(RHS):
            value = x[i, r]
            for j in range(i + 1, min(n, i + 2 * BELOW + 1)):
                value -= rows[i, j - i + BELOW] * x[j, r]
            x[i, r] = value / rows[i, BELOW]


@nb.njit(cache=True)
def pivoted_end_green_functions(
    V: FloatArray,
    zeeman_x: FloatArray,
    zeeman_z: FloatArray,
    terms: tuple[float, float, float],
    sigma: ComplexArray,
    lane: int,
    re: FloatArray,
    im: FloatArray,
) -> None:  # pragma: no cover
    """Write −G of the end sites of one lane, upper triangle, as `ends.end_green_functions` does.

    Arguments as in `recursion.eliminate_inner_sites`, for one lane; sigma is that lane's, shape
    (lead, charge, 2, 2), in units of t'.
    """
    rows = _banded_rows(V, zeeman_x, zeeman_z, terms, sigma)
    n = rows.shape[0]
    left = np.zeros((n, RHS), dtype=np.complex128)
    right = np.zeros((n, RHS), dtype=np.complex128)
    for r in range(RHS):
        left[r, r] = 1.0
        right[n - RHS + r, r] = 1.0
    for k in range(n):
        last = min(n, k + BELOW + 1)
        pivot = k
        for i in range(k + 1, last):
            if abs(rows[i, k - i + BELOW]) > abs(rows[pivot, k - pivot + BELOW]):
                pivot = i
        if pivot != k:
            for j in range(k, min(n, k + 2 * BELOW + 1)):
                a, b = j - k + BELOW, j - pivot + BELOW
                rows[k, a], rows[pivot, b] = rows[pivot, b], rows[k, a]
            for r in range(RHS):
                left[k, r], left[pivot, r] = left[pivot, r], left[k, r]
                right[k, r], right[pivot, r] = right[pivot, r], right[k, r]
        for i in range(k + 1, last):
            factor = rows[i, k - i + BELOW] / rows[k, BELOW]
            if factor == 0:
                continue
            for j in range(k + 1, min(n, k + 2 * BELOW + 1)):
                rows[i, j - i + BELOW] -= factor * rows[k, j - k + BELOW]
            for r in range(RHS):
                left[i, r] -= factor * left[k, r]
                right[i, r] -= factor * right[k, r]
    _back_substitute(rows, left, 0)
    _back_substitute(rows, right, n - RHS)
    for i in range(4):
        for j in range(4):
            at = (8 * i + j + 4) * LANES + lane
            re[at], im[at] = -left[n - 4 + j, i].real, -left[n - 4 + j, i].imag
            if j >= i:
                at = (8 * i + j) * LANES + lane
                re[at], im[at] = -left[i, j].real, -left[i, j].imag
                at += 36 * LANES
                re[at], im[at] = -right[n - 4 + i, j].real, -right[n - 4 + i, j].imag
