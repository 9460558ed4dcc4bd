"""The Loewner pencil of WIDTH sets at once, and which of its directions are independent.

See `levels` for the mathematics: N = ⟨j|k⟩ and K = ⟨j|A|k⟩ between the 8M directions of M nodes.
Directions that depend on the others are left out by Cholesky's factorisation of N with pivots. Each
set chooses its own, so only the rows that it chooses are ever worked out.

Layout: entry k of set l at [k·WIDTH + l]; a matrix is one flat array, row after row.
"""

from __future__ import annotations

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.vectors import WIDTH, everywhere, read, where_greater, write


@nb.njit(cache=True, error_model="numpy")
def resolvents(
    omega: FloatArray, G: FloatArray, slope: FloatArray, phi: FloatArray, norm: FloatArray
) -> None:  # pragma: no cover
    """Turn a set's G and dG/dω at the nodes into Φ − diag(0, 1) and −dΦ/dx; all (node, 8, 8)."""
    for k in range(omega.size):
        w, over, half = omega[k], 1.0 / omega[k], -0.5 / omega[k]
        for i in range(4):
            for j in range(4):
                value = G[k, i, j] * over
                phi[k, i, j], norm[k, i, j] = value, (slope[k, i, j] - value) * over * half
                value = G[k, i, 4 + j]
                phi[k, i, 4 + j], norm[k, i, 4 + j] = value, slope[k, i, 4 + j] * half
                value = G[k, 4 + i, j]
                phi[k, 4 + i, j], norm[k, 4 + i, j] = value, slope[k, 4 + i, j] * half
                value = G[k, 4 + i, 4 + j]
                norm[k, 4 + i, 4 + j] = (slope[k, 4 + i, 4 + j] * w + value) * half
                phi[k, 4 + i, 4 + j] = value * w - (1.0 if i == j else 0.0)


@nb.njit(cache=True, error_model="numpy")
def _pencil_rows(
    omega: FloatArray,
    phi: FloatArray,
    norm: FloatArray,
    scale: FloatArray,
    chosen: NDArray[np.int64],
    work: FloatArray,
    N: FloatArray,
    K: FloatArray,
) -> None:  # pragma: no cover
    """Write each set's row `chosen` of N and of K, shape (8M · WIDTH,); zeros where that is −1.

    work: shape ((8M + 10) · WIDTH,).
    """
    W, nodes = WIDTH, omega.size
    at_own, at_x, at_scale = 8 * nodes * W, (8 * nodes + 8) * W, (8 * nodes + 9) * W
    for l in range(W):
        direction = max(chosen[l], 0)
        node, i = direction // 8, direction % 8
        for k in range(nodes):
            there = phi[l, k, i]
            for j in range(8):
                work[(8 * k + j) * W + l] = there[j]
        own = phi[l, node, i]
        for j in range(8):
            work[at_own + j * W + l] = own[j]
        work[at_x + l] = omega[node] ** 2
        work[at_scale + l] = scale[direction * W + l] if chosen[l] >= 0 else 0.0
    x, own_scale = read(work, at_x), read(work, at_scale)
    for k in range(nodes):
        over = everywhere(1.0) / (everywhere(omega[k] ** 2) - x)
        for j in range(8):
            at = (8 * k + j) * W
            other = read(work, at)
            product = (read(work, at_own + j * W) - other) * over
            factor = own_scale * read(scale, at)
            write(N, at, product * factor)
            write(K, at, (x * product - other) * factor)
    for l in range(W):  # with itself, where 0/0 stands
        direction = max(chosen[l], 0)
        node, i = direction // 8, direction % 8
        for j in range(8):
            at, product = (8 * node + j) * W + l, norm[l, node, i, j]
            factor = work[at_scale + l] * scale[at]
            N[at] = product * factor
            K[at] = (omega[node] ** 2 * product - phi[l, node, i, j]) * factor


@nb.njit(cache=True, error_model="numpy")
def subtract_rows(
    M: FloatArray, k: int, first: int, columns: int, factors: FloatArray, count: int
) -> None:  # pragma: no cover
    """Subtract factors[i] times row i of M from its row k, for i < count, from column `first` on.

    Four rows at a time: most of the time goes into moving them.
    """
    W = WIDTH
    at, stride, i = k * columns * W, columns * W, 0
    while i + 4 <= count:
        a, b = i * stride, (i + 1) * stride
        c, d = (i + 2) * stride, (i + 3) * stride
        e, f = read(factors, i * W), read(factors, (i + 1) * W)
        g, h = read(factors, (i + 2) * W), read(factors, (i + 3) * W)
        for j in range(first * W, stride, W):
            total = read(M, at + j) - e * read(M, a + j) - f * read(M, b + j)
            write(M, at + j, total - g * read(M, c + j) - h * read(M, d + j))
        i += 4
    while i < count:
        a, e = i * stride, read(factors, i * W)
        for j in range(first * W, stride, W):
            write(M, at + j, read(M, at + j) - e * read(M, a + j))
        i += 1


@nb.njit(cache=True, error_model="numpy")
def independent_directions(
    omega: FloatArray,
    phi: FloatArray,
    norm: FloatArray,
    drop: float,
    U: FloatArray,
    K: FloatArray,
    b: FloatArray,
) -> int:  # pragma: no cover
    """Factor N = UᵀU with the largest remaining pivot first, down to pivots of `drop`.

    Parameters
    ----------
    omega : array, shape (node,)
    phi, norm : arrays, shape (WIDTH, node, 8, 8)
        From `resolvents`.
    drop : float
        Smallest pivot; the largest is 1.
    U, K : arrays, shape (8M · 8M · WIDTH,)
        Written: Uᵀ and ⟨j|A|k⟩ of the chosen directions, lower triangles.
    b : array, shape (8M · 8 · WIDTH,)
        Written: what the ends see of the chosen directions.

    Returns
    -------
    int
        The largest rank. A set of smaller rank gets directions at x = 1, far away, that the ends
        do not see.
    """
    W, n = WIDTH, 8 * omega.size
    pivots, root, best = np.ones(n * W), np.empty(W), np.empty(W)
    work, scale = np.empty((n + 10) * W), np.empty(n * W)
    R, row, energy = np.empty(n * n * W), np.empty(n * W), np.empty(n * W)
    chosen, order = np.empty(W, dtype=np.int64), np.empty(n * W, dtype=np.int64)
    for l in range(W):
        for i in range(n):
            scale[i * W + l] = 1.0 / np.sqrt(norm[l, i // 8, i % 8, i % 8])
    for k in range(n):
        top, at = everywhere(drop), everywhere(-1.0)
        for i in range(n):
            pivot, here = read(pivots, i * W), everywhere(float(i))
            at = where_greater(pivot, top, here, at)
            top = where_greater(pivot, top, pivot, top)
        write(best, 0, at)
        most = -1
        for l in range(W):
            chosen[l] = int(best[l])
            order[k * W + l] = max(chosen[l], 0)
            most = max(most, chosen[l])
        if most < 0:
            return k
        _pencil_rows(omega, phi, norm, scale, chosen, work, row, energy)
        first = k * n * W
        for l in range(W):
            direction = order[k * W + l]
            for i in range(k):
                U[first + i * W + l] = R[(i * n + direction) * W + l]
                K[first + i * W + l] = energy[order[i * W + l] * W + l]
            if chosen[l] < 0:
                for i in range(k):
                    U[first + i * W + l] = K[first + i * W + l] = 0.0
            K[first + k * W + l] = energy[direction * W + l] if chosen[l] >= 0 else 1.0
            factor = work[(n + 9) * W + l]
            for c in range(8):
                b[(8 * k + c) * W + l] = factor * phi[l, direction // 8, direction % 8, c]
        for j in range(0, n * W, W):
            write(R, first + j, read(row, j))
        subtract_rows(R, k, 0, n, U[first:], k)
        for l in range(W):
            pivot = np.sqrt(R[first + order[k * W + l] * W + l]) if chosen[l] >= 0 else 1.0
            U[first + k * W + l] = pivot
            root[l] = 1.0 / pivot
        share = read(root, 0)
        for j in range(0, n * W, W):
            entry = read(R, first + j) * share
            write(R, first + j, entry)
            write(pivots, j, read(pivots, j) - entry * entry)
        for l in range(W):
            if chosen[l] >= 0:
                pivots[chosen[l] * W + l] = -1.0
    return n
