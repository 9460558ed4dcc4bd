"""Levels of the isolated wire from its end Green's function at a few energies.

Particle–hole symmetry: all matrices are real, so C = τyσy anticommutes with H. In the basis of
`to_chiral`, C = ±1, the ends see a level ±E through a (C = 1) and b (C = −1), and

    G₊₊ = Σ a aᵀ ω/(ω² − E²),   G₊₋ = Σ a bᵀ E/(ω² − E²),   G₋₋ = Σ b bᵀ ω/(ω² − E²).

So Φ(x) = [[G₊₊/ω, G₊₋], [G₋₊, ωG₋₋]], with x = ω², is Σ w wᵀ/(x − E²) + diag(0, 1), w = (a, Eb),
where the sum runs over all levels of wire and parent superconductor together: with it the
Hamiltonian does not depend on the energy, and Φ is the resolvent of a symmetric operator A ≥ 0,
Φ − diag(0, 1) = Pᵀ(x − A)⁻¹P.

Rayleigh–Ritz: the vectors (x_k − A)⁻¹P at M energies span a space in which A is diagonalised. Their
products need no vectors, only Φ and its slope (a Loewner matrix, Mayo and Antoulas 2007):

    ⟨j|k⟩ = −(Φ_j − Φ_k)/(x_j − x_k),   ⟨j|A|k⟩ = −(x_jΦ_j − x_kΦ_k)/(x_j − x_k),

with derivatives for j = k. So the levels are real and the residues positive by construction, and
the model meets Φ and dΦ/dx at every node. 8M directions from M energies: where a common-denominator
fit (AAA) needs 48 to 64 energies, 8 to 12 do here.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.eigen import reduce_pencil, tridiagonal_levels, tridiagonalise
from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.loewner import independent_directions, resolvents
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.recursion import C_AT, D_AT, E_AT, LANES, SLOPES
from disorder_landscape.physics.vectors import WIDTH

LOW = 1e-3
"""Below this energy in meV completeness tells b of the lowest level better than Eb does."""
ZERO_MODE = 3e-5
"""Below this energy in meV Eb is too small to tell b."""
UNSEEN = 1e-10
"""A low level whose a is less than this (squared) may be one of rounding errors alone: with few
nodes some levels are found at zero that the wire does not have. (Of those that it has, and whose a
was still too small to find E, the least that was seen in 440,000 sets is three times as much.)"""
REMAINDER = 0.1
"""So it is taken to be if all that is left for its b is less than this part of that of a low level
whose a is seen, of which Eb says b with an error."""


@nb.njit(cache=True)
def to_chiral(M: FloatArray | ComplexArray) -> None:  # pragma: no cover
    """Turn an 8×8 matrix of the two ends from (L, R) × (u↑, u↓, −v↓, v↑) to C = + + − −, in place.

    Columns 0–3 are (u↓ − v↓)/√2 and (u↑ − v↑)/√2 of L, then of R; columns 4–7 (u↓ + v↓)/√2 and
    (u↑ + v↑)/√2.
    """
    half = np.sqrt(0.5)
    row = np.empty(8, dtype=M.dtype)
    for _ in range(2):  # MᵀT twice is TᵀMT
        for i in range(8):
            for end in range(2):
                m0, m1, m2, m3 = (
                    M[i, 4 * end],
                    M[i, 4 * end + 1],
                    M[i, 4 * end + 2],
                    M[i, 4 * end + 3],
                )
                row[2 * end], row[2 * end + 1] = half * (m1 + m2), half * (m0 - m3)
                row[4 + 2 * end], row[5 + 2 * end] = half * (m1 - m2), half * (m0 + m3)
            for j in range(8):
                M[i, j] = row[j]
        for i in range(8):
            for j in range(i):
                M[i, j], M[j, i] = M[j, i], M[i, j]


@nb.njit(cache=True, error_model="numpy")
def isolated_end_green_function(
    s: FloatArray, lane: int, hop: float, G: FloatArray, slope: FloatArray
) -> None:  # pragma: no cover
    """Write one lane's G and dG/dω of the isolated wire's ends, chiral basis, 1/meV and 1/meV².

    s is the state that `eliminate_inner_sites_with_slopes` leaves, hop is t' in meV.
    """
    L = LANES
    dM = np.empty((8, 8))
    for first, out in ((0, G), (SLOPES, dM)):
        upper = 0
        for i in range(4):
            for j in range(i, 4):
                e, d = s[(first + E_AT + upper) * L + lane], s[(first + D_AT + upper) * L + lane]
                out[i, j], out[j, i], out[4 + i, 4 + j], out[4 + j, 4 + i] = e, e, d, d
                upper += 1
            for j in range(4):
                c = s[(first + C_AT + 4 * i + j) * L + lane]
                out[i, 4 + j], out[4 + j, i] = c, c
    invert(G)
    product = np.empty((8, 8))
    for i in range(8):
        for j in range(8):
            total = 0.0
            for k in range(8):
                total += G[i, k] * dM[k, j]
            product[i, j] = total
    for i in range(8):
        for j in range(8):
            total = 0.0
            for k in range(8):
                total += product[i, k] * G[k, j]
            slope[i, j] = -total / hop
    for i in range(8):
        for j in range(8):
            G[i, j] /= hop
    to_chiral(G)
    to_chiral(slope)


@nb.njit(cache=True, error_model="numpy")
def invert(M: FloatArray | ComplexArray) -> None:  # pragma: no cover
    """Invert a small matrix in place by Gauss–Jordan elimination with row pivoting."""
    n = M.shape[0]
    order = np.empty(n, dtype=np.int64)
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(M[i, k]) > abs(M[pivot, k]):
                pivot = i
        order[k] = pivot
        for j in range(n):
            M[k, j], M[pivot, j] = M[pivot, j], M[k, j]
        scale = 1.0 / M[k, k]
        M[k, k] = 1.0
        for j in range(n):
            M[k, j] *= scale
        for i in range(n):
            if i != k:
                factor = M[i, k]
                M[i, k] = 0.0
                for j in range(n):
                    M[i, j] -= factor * M[k, j]
    for k in range(n - 1, -1, -1):
        if order[k] != k:
            for i in range(n):
                M[i, k], M[i, order[k]] = M[i, order[k]], M[i, k]


@nb.njit(cache=True, error_model="numpy")
def wire_levels(
    omega: FloatArray,
    G: FloatArray,
    slope: FloatArray,
    drop: float,
    E: FloatArray,
    weight: FloatArray,
) -> int:  # pragma: no cover
    """Find the levels of WIDTH sets from G and dG/dω at the nodes.

    Parameters
    ----------
    omega : array, shape (node,)
        Positive, in meV.
    G, slope : arrays, shape (WIDTH, node, 8, 8)
        From `isolated_end_green_function`.
    drop : float
        Directions of which less than this (squared, relative) is new are left out.
    E : array, shape (WIDTH, 8 · node)
        Written: the levels in meV, unsorted; NaN where the data make no model.
    weight : array, shape (WIDTH, 8 · node, 8)
        Written: a and b of every level.

    Returns
    -------
    int
        How many levels there are; 0 if the data make no model.
    """
    W, n = WIDTH, 8 * omega.size
    phi, norm = np.empty(G.shape), np.empty(G.shape)
    U, K, rows = np.empty(n * n * W), np.empty(n * n * W), np.empty(8 * n * W)
    for l in range(W):
        resolvents(omega, G[l], slope[l], phi[l], norm[l])
    rank = independent_directions(omega, phi, norm, drop, U, K, rows)
    if rank == 0:
        return 0
    A, diagonal, off = np.empty(rank * rank * W), np.empty(rank * W), np.empty(rank * W)
    reduce_pencil(U, K, n, rank, A, rows)
    tridiagonalise(A, rank, rows, diagonal, off)
    if not tridiagonal_levels(diagonal, off, rank, rows):
        return 0
    for l in range(W):
        for j in range(rank):
            square = diagonal[j * W + l]
            E[l, j] = np.sqrt(square) if not square < 0.0 else 0.0
            for c in range(8):
                weight[l, j, c] = rows[(8 * j + c) * W + l]
            if E[l, j] >= ZERO_MODE:
                for c in range(4, 8):
                    weight[l, j, c] /= E[l, j]
        _complete_low_levels(omega[0], G[l, 0], E[l, :rank], weight[l])
    return int(rank)


@nb.njit(cache=True, error_model="numpy")
def _complete_low_levels(
    omega: float, G: FloatArray, E: FloatArray, weight: FloatArray
) -> None:  # pragma: no cover
    """Take b of low levels from what the others leave of ωG₋₋ = Σ b bᵀ ω²/(ω² − E²).

    Of the lowest level, and of all below ZERO_MODE; those that are seen come first.
    """
    below = min(LOW, 0.25 * omega)
    limit, lowest = min(ZERO_MODE, below), _lowest(E, weight, 0.0)
    if lowest < 0 or not E[lowest] < below:
        return
    rest = np.empty((4, 4))
    for i in range(4):
        for k in range(4):
            rest[i, k] = omega * G[4 + i, 4 + k]
    for j in range(E.size):
        if j != lowest and E[j] >= limit:
            _add_square(rest, -_share(omega, E[j]), weight[j])
    seen = _lowest(E, weight, UNSEEN)
    if seen >= 0 and seen != lowest and limit <= E[seen] < below:
        share = _share(omega, E[seen])
        left = np.abs(np.diag(rest)).sum()
        if left < REMAINDER * share * _square(weight[seen, 4:]):
            _add_square(rest, share, weight[seen])
            if E[lowest] >= limit:
                _add_square(rest, -_share(omega, E[lowest]), weight[lowest])
            lowest = seen
    for unseen in range(2):
        for j in range(E.size):
            if (j == lowest or E[j] < limit) and (_square(weight[j, :4]) < UNSEEN) == (unseen == 1):
                share = _share(omega, E[j])
                _take_square(rest, share, weight[j])
                _add_square(rest, -share, weight[j])


@nb.njit(cache=True, error_model="numpy")
def _share(omega: float, E: float) -> float:  # pragma: no cover
    """Return the factor of b bᵀ in ωG₋₋."""
    return omega**2 / (omega**2 - E**2)


@nb.njit(cache=True, error_model="numpy")
def _square(a: FloatArray) -> float:  # pragma: no cover
    total = 0.0
    for i in range(a.size):
        total += a[i] ** 2
    return total


@nb.njit(cache=True, error_model="numpy")
def _lowest(E: FloatArray, weight: FloatArray, least: float) -> int:  # pragma: no cover
    """Return the lowest level of those whose a is no less than this (squared), or −1."""
    lowest, energy = -1, np.inf
    for j in range(E.size):
        if E[j] < energy and _square(weight[j, :4]) >= least:
            lowest, energy = j, E[j]
    return lowest


@nb.njit(cache=True, error_model="numpy")
def _add_square(rest: FloatArray, factor: float, w: FloatArray) -> None:  # pragma: no cover
    """Add factor · b bᵀ, where w is (a, b)."""
    for i in range(4):
        for k in range(4):
            rest[i, k] += factor * w[4 + i] * w[4 + k]


@nb.njit(cache=True, error_model="numpy")
def _take_square(rest: FloatArray, factor: float, w: FloatArray) -> None:  # pragma: no cover
    """Write the b that makes most of rest = factor · b bᵀ, signed as the b or Eb that w has."""
    p = 0
    for i in range(1, 4):
        if rest[i, i] > rest[p, p]:
            p = i
    root, along = np.sqrt(max(rest[p, p], 0.0) * factor), 0.0
    for i in range(4):
        along += w[4 + i] * rest[i, p]
    if along < 0.0:  # the sign of b relative to a is that of the E b that was found
        root = -root
    for i in range(4):
        w[4 + i] = rest[i, p] / root if root != 0.0 else 0.0
