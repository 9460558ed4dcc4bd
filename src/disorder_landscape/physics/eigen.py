"""Real symmetric eigenproblems of small pencils, tracking a few rows of the eigenvectors only.

A wire's levels come from the pencil K y = e N y with b = (the ends' 8 rows of the basis). What is
wanted are the e and the 8-vectors yᵀb, never the eigenvectors themselves. So: pivoted Cholesky of
N = RᵀR, which leaves out basis vectors that depend on the others; A = R⁻ᵀ K R⁻¹; Householder
tridiagonalisation; implicit QL (Golub and Van Loan, Matrix Computations, 4.2, 8.3), with the same
orthogonal steps applied to R⁻ᵀ b. All loops run along rows, the way memory does.
"""

from __future__ import annotations

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.parameters import FloatArray

EPSILON = 2.3e-16
SUMS = {"reassoc", "contract", "nsz", "arcp"}
"""What the compiler may do to sums: reorder them into vectors."""


@nb.njit(cache=True, fastmath=SUMS, error_model="numpy")
def _subtract(row: FloatArray, factor: float, other: FloatArray) -> None:  # pragma: no cover
    """Subtract factor times the other row."""
    for j in range(row.size):
        row[j] -= factor * other[j]


@nb.njit(cache=True, fastmath=SUMS, error_model="numpy")
def pivoted_cholesky(
    N: FloatArray, drop: float, R: FloatArray, order: NDArray[np.int64]
) -> int:  # pragma: no cover
    """Factor N[order][:, order] = RᵀR with the largest remaining pivot first.

    Row k of R is written in the order of the original columns. Stops at pivots below `drop`
    and returns how many rows there are.
    """
    n = N.shape[0]
    pivots = np.empty(n)
    for i in range(n):
        pivots[i] = N[i, i]
    for k in range(n):
        best = 0
        for i in range(1, n):
            if pivots[i] > pivots[best]:
                best = i
        if not pivots[best] > drop:
            return int(k)
        order[k] = best
        row = R[k]
        row[:] = N[best]
        for i in range(k):
            factor = R[i, best]
            for j in range(n):
                row[j] -= factor * R[i, j]
        root = 1.0 / np.sqrt(row[best])
        for j in range(n):
            row[j] *= root
            pivots[j] -= row[j] ** 2
        pivots[best] = -1.0
    return int(n)


@nb.njit(cache=True, fastmath=SUMS, error_model="numpy")
def reduce_pencil(
    K: FloatArray,
    b: FloatArray,
    R: FloatArray,
    order: NDArray[np.int64],
    rank: int,
    A: FloatArray,
    rows: FloatArray,
) -> None:  # pragma: no cover
    """Write the upper triangle of A = R⁻ᵀKR⁻¹ and rows = R⁻ᵀb, shape (rank, 8)."""
    U, Y = np.empty((rank, rank)), np.empty((rank, rank))
    for k in range(rank):
        for j in range(rank):
            U[k, j] = R[k, order[j]]
    for k in range(rank):
        scale = 1.0 / U[k, k]
        for j in range(rank):
            Y[k, j] = K[order[k], order[j]]
        for c in range(8):
            rows[k, c] = b[order[k], c]
        for i in range(k):
            factor = U[i, k]
            for j in range(rank):
                Y[k, j] -= factor * Y[i, j]
            for c in range(8):
                rows[k, c] -= factor * rows[i, c]
        for j in range(rank):
            Y[k, j] *= scale
        for c in range(8):
            rows[k, c] *= scale
    for k in range(rank):
        scale = 1.0 / U[k, k]
        for j in range(k, rank):
            A[k, j] = Y[j, k]
        for i in range(k):
            factor = U[i, k]
            for j in range(k, rank):
                A[k, j] -= factor * A[i, j]
        for j in range(k, rank):
            A[k, j] *= scale


@nb.njit(cache=True, fastmath=SUMS, error_model="numpy")
def _update_and_multiply(
    A: FloatArray,
    first: int,
    n: int,
    v: FloatArray,
    p: FloatArray,
    new: FloatArray,
    product: FloatArray,
) -> None:  # pragma: no cover
    """Subtract v pᵀ + p vᵀ from A[first:, first:] and multiply it by `new`, in one pass over A."""
    for j in range(first, n):
        product[j] = 0.0
    for i in range(first, n):
        vi, pi, ni = v[i], p[i], new[i]
        diagonal = A[i, i] - 2 * vi * pi
        A[i, i] = diagonal
        total = diagonal * ni
        row, p_row, v_row = A[i, i + 1 : n], p[i + 1 : n], v[i + 1 : n]
        new_row, product_row = new[i + 1 : n], product[i + 1 : n]
        for j in range(row.size):
            a = row[j] - vi * p_row[j] - pi * v_row[j]
            row[j] = a
            total += a * new_row[j]
            product_row[j] += a * ni
        product[i] += total


@nb.njit(cache=True, fastmath=SUMS, error_model="numpy")
def tridiagonalise(
    A: FloatArray, n: int, rows: FloatArray, diagonal: FloatArray, off: FloatArray
) -> None:  # pragma: no cover
    """Bring A (n×n, upper triangle, destroyed) to tridiagonal form by Householder reflections."""
    v, p = np.zeros(n), np.zeros(n)
    new, product, reflected = np.zeros(n), np.empty(n), np.empty(8)
    for k in range(n - 2):
        for j in range(k, n):  # the previous reflection, of row k
            A[k, j] -= v[k] * p[j] + p[k] * v[j]
        diagonal[k] = A[k, k]
        norm = 0.0
        for j in range(k + 1, n):
            norm += A[k, j] ** 2
            new[j] = A[k, j]
        norm = np.sqrt(norm)
        head = A[k, k + 1]
        alpha = -norm if head > 0 else norm
        off[k] = alpha
        new[k + 1] -= alpha
        beta = 1.0 / (norm * (norm + abs(head))) if norm > 0.0 else 0.0
        _update_and_multiply(A, k + 1, n, v, p, new, product)
        overlap = 0.0
        for j in range(k + 1, n):
            product[j] *= beta
            overlap += product[j] * new[j]
        overlap *= 0.5 * beta
        for j in range(k + 1, n):
            v[j] = new[j]
            p[j] = product[j] - overlap * new[j]
        reflected[:] = 0.0
        for j in range(k + 1, n):
            _subtract(reflected, -beta * new[j], rows[j])
        for j in range(k + 1, n):
            _subtract(rows[j], new[j], reflected)
    for k in range(max(n - 2, 0), n):
        for j in range(k, n):
            A[k, j] -= v[k] * p[j] + p[k] * v[j]
        diagonal[k] = A[k, k]
    if n > 1:
        off[n - 2] = A[n - 2, n - 1]


@nb.njit(cache=True, fastmath=SUMS, error_model="numpy")
def _rotate_rows(
    c: FloatArray, s: FloatArray, first: int, last: int, rows: FloatArray
) -> None:  # pragma: no cover
    """Apply rotations i = last − 1 … first of rows i and i + 1, carrying row i along."""
    r0, r1, r2, r3 = rows[last, 0], rows[last, 1], rows[last, 2], rows[last, 3]
    r4, r5, r6, r7 = rows[last, 4], rows[last, 5], rows[last, 6], rows[last, 7]
    for i in range(last - 1, first - 1, -1):
        ci, si, row, below = c[i], s[i], rows[i], rows[i + 1]
        q0, q1, q2, q3 = row[0], row[1], row[2], row[3]
        q4, q5, q6, q7 = row[4], row[5], row[6], row[7]
        below[0], below[1] = si * q0 + ci * r0, si * q1 + ci * r1
        below[2], below[3] = si * q2 + ci * r2, si * q3 + ci * r3
        below[4], below[5] = si * q4 + ci * r4, si * q5 + ci * r5
        below[6], below[7] = si * q6 + ci * r6, si * q7 + ci * r7
        r0, r1, r2, r3 = ci * q0 - si * r0, ci * q1 - si * r1, ci * q2 - si * r2, ci * q3 - si * r3
        r4, r5, r6, r7 = ci * q4 - si * r4, ci * q5 - si * r5, ci * q6 - si * r6, ci * q7 - si * r7
    row = rows[first]
    row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7] = r0, r1, r2, r3, r4, r5, r6, r7


@nb.njit(cache=True, error_model="numpy")
def tridiagonal_levels(
    diagonal: FloatArray, off: FloatArray, n: int, rows: FloatArray
) -> bool:  # pragma: no cover
    """Turn the diagonal into the eigenvalues and row j into the 8-vector of eigenvector j.

    Implicit QL with Wilkinson's shift; returns whether it has converged.
    """
    cosines, sines = np.empty(n), np.empty(n)
    off[n - 1] = 0.0
    for l in range(n):
        converged = False
        for _ in range(60):
            m = l
            while m < n - 1:
                if abs(off[m]) <= EPSILON * (abs(diagonal[m]) + abs(diagonal[m + 1])):
                    break
                m += 1
            if m == l:
                converged = True
                break
            g = (diagonal[l + 1] - diagonal[l]) / (2 * off[l])
            r = np.sqrt(g * g + 1)
            g = diagonal[m] - diagonal[l] + off[l] / (g + np.copysign(r, g))
            s = c = 1.0
            p = 0.0
            stopped = l
            for i in range(m - 1, l - 1, -1):
                f, b = s * off[i], c * off[i]
                r = np.sqrt(f * f + g * g)
                off[i + 1] = r
                if r == 0.0:  # the matrix falls apart here
                    diagonal[i + 1] -= p
                    off[m] = 0.0
                    stopped = i + 1
                    break
                inverse = 1.0 / r
                s, c = f * inverse, g * inverse
                cosines[i], sines[i] = c, s
                g = diagonal[i + 1] - p
                r = (diagonal[i] - g) * s + 2 * c * b
                p = s * r
                diagonal[i + 1] = g + p
                g = c * r - b
            _rotate_rows(cosines, sines, stopped, m, rows)
            if stopped == l:
                diagonal[l] -= p
                off[l] = g
                off[m] = 0.0
        if not converged:
            return False
    return True
