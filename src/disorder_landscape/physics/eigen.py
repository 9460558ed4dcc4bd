"""Real symmetric eigenproblems of small pencils, of WIDTH sets at once.

A wire's levels come from the pencil K y = e N y with b = (the ends' 8 rows of the basis). What is
wanted are the e and the 8-vectors yᵀb, never the eigenvectors themselves. So: N = UᵀU (`loewner`);
A = U⁻ᵀ K U⁻¹; Householder tridiagonalisation; implicit QL (Golub and Van Loan, Matrix Computations,
4.2, 8.3), with the same orthogonal steps applied to U⁻ᵀ b.

The sets of a vector go through the same steps; where one set is done before the others its steps
are multiplications by one. Layout as in `loewner`.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.loewner import subtract_rows
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.vectors import (
    WIDTH,
    everywhere,
    read,
    roots,
    sizes,
    where_greater,
    write,
)

EPSILON = 2.3e-16
SWEEPS = 60
"""Most QL sweeps for one level."""


@nb.njit(cache=True, error_model="numpy")
def _scale_row(M: FloatArray, first: int, last: int, share: FloatArray) -> None:  # pragma: no cover
    """Multiply entries `first` to `last` of M by each set's share."""
    factor = read(share, 0)
    for j in range(first * WIDTH, last * WIDTH, WIDTH):
        write(M, j, read(M, j) * factor)


@nb.njit(cache=True, error_model="numpy")
def reduce_pencil(
    U: FloatArray, K: FloatArray, stride: int, n: int, A: FloatArray, rows: FloatArray
) -> None:  # pragma: no cover
    """Write the upper triangle of A = U⁻ᵀKU⁻¹ and turn the rows b into U⁻ᵀb.

    Parameters
    ----------
    U, K : arrays
        Lower triangles of Uᵀ and K in rows of `stride` entries, see `loewner`.
    n : int
        How many rows.
    A : array, shape (n · n · WIDTH,)
    rows : array, shape (n · 8 · WIDTH,) or longer
    """
    W = WIDTH
    Y, share = np.empty(n * n * W), np.empty(W)
    for k in range(n):
        for j in range(n):
            low, high = min(k, j), max(k, j)
            write(Y, (k * n + j) * W, read(K, (high * stride + low) * W))
    for k in range(n):
        factors = U[k * stride * W :]
        write(share, 0, everywhere(1.0) / read(factors, k * W))
        subtract_rows(Y, k, 0, n, factors, k)
        subtract_rows(rows, k, 0, 8, factors, k)
        _scale_row(Y, k * n, (k + 1) * n, share)
        _scale_row(rows, 8 * k, 8 * k + 8, share)
    for k in range(n):
        factors = U[k * stride * W :]
        write(share, 0, everywhere(1.0) / read(factors, k * W))
        for j in range(k, n):
            write(A, (k * n + j) * W, read(Y, (j * n + k) * W))
        subtract_rows(A, k, k, n, factors, k)
        _scale_row(A, k * n + k, (k + 1) * n, share)


@nb.njit(cache=True, error_model="numpy")
def _reflector(
    A: FloatArray, k: int, n: int, new: FloatArray, off: FloatArray, beta: FloatArray
) -> None:  # pragma: no cover
    """Write the reflection 1 − β new newᵀ that leaves row k one entry beside the diagonal.

    Where no other is left β = 0: then sets of smaller rank are untouched by the others.
    """
    W = WIDTH
    zero, one, head = everywhere(0.0), everywhere(1.0), read(A, (k * n + k + 1) * W)
    tail = zero
    for j in range(k + 2, n):
        entry = read(A, (k * n + j) * W)
        tail = tail + entry * entry
        write(new, j * W, entry)
    norm = roots(tail + head * head)
    alpha = where_greater(head, zero, zero - norm, norm)
    alpha = where_greater(tail, zero, alpha, head)
    write(off, k * W, alpha)
    write(new, (k + 1) * W, head - alpha)
    write(beta, 0, where_greater(tail, zero, one / (norm * (norm + sizes(head))), zero))


@nb.njit(cache=True, error_model="numpy")
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
    W = WIDTH
    for j in range(first * W, n * W, W):
        write(product, j, everywhere(0.0))
    for i in range(first, n):
        vi, pi, ni = read(v, i * W), read(p, i * W), read(new, i * W)
        at = i * n * W
        diagonal = read(A, at + i * W) - vi * pi - vi * pi
        write(A, at + i * W, diagonal)
        total = read(product, i * W) + diagonal * ni
        for j in range((i + 1) * W, n * W, W):
            entry = read(A, at + j) - vi * read(p, j) - pi * read(v, j)
            write(A, at + j, entry)
            total = total + entry * read(new, j)
            write(product, j, read(product, j) + entry * ni)
        write(product, i * W, total)


@nb.njit(cache=True, error_model="numpy")
def _reflect_rows(
    rows: FloatArray, first: int, n: int, new: FloatArray, beta: FloatArray
) -> None:  # pragma: no cover
    """Apply the reflection to the 8 columns of rows."""
    W = WIDTH
    for c in range(0, 8 * W, W):
        total = everywhere(0.0)
        for j in range(first, n):
            total = total + read(new, j * W) * read(rows, 8 * j * W + c)
        total = total * read(beta, 0)
        for j in range(first, n):
            at = 8 * j * W + c
            write(rows, at, read(rows, at) - read(new, j * W) * total)


@nb.njit(cache=True, error_model="numpy")
def tridiagonalise(
    A: FloatArray, n: int, rows: FloatArray, diagonal: FloatArray, off: FloatArray
) -> None:  # pragma: no cover
    """Bring A (n×n, upper triangle, destroyed) to tridiagonal form by Householder reflections."""
    W = WIDTH
    v, p, new, product = np.zeros(n * W), np.zeros(n * W), np.zeros(n * W), np.empty(n * W)
    beta = np.empty(W)
    for k in range(n):
        vk, pk = read(v, k * W), read(p, k * W)
        for j in range(k, n):  # the previous reflection, of row k
            at = (k * n + j) * W
            write(A, at, read(A, at) - vk * read(p, j * W) - pk * read(v, j * W))
        write(diagonal, k * W, read(A, (k * n + k) * W))
        if k == n - 1:
            break
        _reflector(A, k, n, new, off, beta)
        _update_and_multiply(A, k + 1, n, v, p, new, product)
        overlap, share = everywhere(0.0), read(beta, 0)
        for j in range((k + 1) * W, n * W, W):
            entry = read(product, j) * share
            write(product, j, entry)
            overlap = overlap + entry * read(new, j)
        overlap = overlap * share * everywhere(0.5)
        for j in range((k + 1) * W, n * W, W):
            entry = read(new, j)
            write(v, j, entry)
            write(p, j, read(product, j) - overlap * entry)
        _reflect_rows(rows, k + 1, n, new, beta)


@nb.njit(cache=True, error_model="numpy")
def _split(
    diagonal: FloatArray, off: FloatArray, first: int, n: int, end: FloatArray
) -> int:  # pragma: no cover
    """Write where each set's matrix first falls apart from `first` on; return the last of them."""
    W = WIDTH
    at, tiny = everywhere(float(n - 1)), everywhere(EPSILON)
    for k in range(n - 2, first - 1, -1):
        around = sizes(read(diagonal, k * W)) + sizes(read(diagonal, (k + 1) * W))
        at = where_greater(sizes(read(off, k * W)), tiny * around, at, everywhere(float(k)))
    write(end, 0, at)
    last = first
    for l in range(W):
        last = max(last, int(end[l]))
    return last


@nb.njit(cache=True, error_model="numpy")
def _sweep(
    diagonal: FloatArray,
    off: FloatArray,
    first: int,
    last: int,
    end: FloatArray,
    shifted: FloatArray,
    rows: FloatArray,
) -> None:  # pragma: no cover
    """Chase each set's bulge from its end to `first`, carrying the row that turns next along."""
    W = WIDTH
    zero, one, until = everywhere(0.0), everywhere(1.0), read(end, 0)
    s, c, p, g = one, one, zero, read(shifted, 0)
    at = 8 * last * W
    r0, r1, r2, r3 = (
        read(rows, at),
        read(rows, at + W),
        read(rows, at + 2 * W),
        read(rows, at + 3 * W),
    )
    r4, r5, r6, r7 = (
        read(rows, at + 4 * W),
        read(rows, at + 5 * W),
        read(rows, at + 6 * W),
        read(rows, at + 7 * W),
    )
    for i in range(last - 1, first - 1, -1):
        here = everywhere(float(i))
        entry, d, below = read(off, i * W), read(diagonal, i * W), read(diagonal, (i + 1) * W)
        f, b = s * entry, c * entry
        square = f * f + g * g
        r = roots(square)
        inverse = where_greater(square, zero, one / r, zero)
        sine = f * inverse
        cosine = where_greater(square, zero, g * inverse, one)
        h = below - p
        x = (d - h) * sine + (b + b) * cosine
        q = sine * x
        write(off, (i + 1) * W, where_greater(until, here, r, read(off, (i + 1) * W)))
        write(diagonal, (i + 1) * W, where_greater(until, here, h + q, below))
        g = where_greater(until, here, cosine * x - b, g)
        p = where_greater(until, here, q, p)
        s, c = where_greater(until, here, sine, s), where_greater(until, here, cosine, c)
        sine, cosine = where_greater(until, here, sine, zero), where_greater(until, here, c, one)
        at = 8 * i * W
        q0, q1, q2, q3 = (
            read(rows, at),
            read(rows, at + W),
            read(rows, at + 2 * W),
            read(rows, at + 3 * W),
        )
        q4, q5, q6, q7 = (
            read(rows, at + 4 * W),
            read(rows, at + 5 * W),
            read(rows, at + 6 * W),
            read(rows, at + 7 * W),
        )
        write(rows, at + 8 * W, sine * q0 + cosine * r0)
        write(rows, at + 9 * W, sine * q1 + cosine * r1)
        write(rows, at + 10 * W, sine * q2 + cosine * r2)
        write(rows, at + 11 * W, sine * q3 + cosine * r3)
        write(rows, at + 12 * W, sine * q4 + cosine * r4)
        write(rows, at + 13 * W, sine * q5 + cosine * r5)
        write(rows, at + 14 * W, sine * q6 + cosine * r6)
        write(rows, at + 15 * W, sine * q7 + cosine * r7)
        r0, r1 = cosine * q0 - sine * r0, cosine * q1 - sine * r1
        r2, r3 = cosine * q2 - sine * r2, cosine * q3 - sine * r3
        r4, r5 = cosine * q4 - sine * r4, cosine * q5 - sine * r5
        r6, r7 = cosine * q6 - sine * r6, cosine * q7 - sine * r7
    at = 8 * first * W
    write(rows, at, r0)
    write(rows, at + W, r1)
    write(rows, at + 2 * W, r2)
    write(rows, at + 3 * W, r3)
    write(rows, at + 4 * W, r4)
    write(rows, at + 5 * W, r5)
    write(rows, at + 6 * W, r6)
    write(rows, at + 7 * W, r7)
    here, at = everywhere(float(first)), first * W
    write(diagonal, at, read(diagonal, at) - p)  # p = 0 where nothing was to do
    write(off, at, where_greater(until, here, g, read(off, at)))


@nb.njit(cache=True, error_model="numpy")
def tridiagonal_levels(
    diagonal: FloatArray, off: FloatArray, n: int, rows: FloatArray
) -> bool:  # pragma: no cover
    """Turn the diagonal into the eigenvalues and row j into the 8-vector of eigenvector j.

    Implicit QL with Wilkinson's shift; returns whether it has converged. NaN stays with its set.
    """
    W = WIDTH
    end, shifted = np.empty(W), np.empty(W)
    write(off, (n - 1) * W, everywhere(0.0))
    for first in range(n):
        for sweep in range(SWEEPS + 1):
            last = _split(diagonal, off, first, n, end)
            if last == first:
                break
            if sweep == SWEEPS:
                return False
            for l in range(W):
                m, at = int(end[l]), first * W + l
                shifted[l] = 0.0
                if m > first:
                    h = (diagonal[at + W] - diagonal[at]) / (2 * off[at])
                    r = np.sqrt(h * h + 1)
                    shifted[l] = off[at] / (h + np.copysign(r, h))
                    shifted[l] += diagonal[m * W + l] - diagonal[at]
            _sweep(diagonal, off, first, last, end, shifted, rows)
            for l in range(W):
                if int(end[l]) > first:
                    off[int(end[l]) * W + l] = 0.0
    return True
