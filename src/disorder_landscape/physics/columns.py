"""How a wire's end blocks answer to every site: real sweeps from both ends.

M = (ω − H)/t' of `recursion`, reduced to its two end sites, is M' = Xᵀ M X, where X_n = [P_n Q_n]
is the wave at site n that the left or the right end site drives while the other is held at zero.
Eliminating the inner sites from the right, or from the left, D ← A_n − τz D⁻¹ τz, gives

    P_n = −D_n⁻¹ τz P_{n−1} (right sweep),   Q_n = −D_n⁻¹ τz Q_{n+1} (left sweep),

and E and D of M' as the last D of each, C = P_{N−2}ᵀ τz. To first order M' changes by X_nᵀ dA_n X_n
with the onsite block A_n, so a conductance by Tr[S X_nᵀ dA_n X_n], S real symmetric, one for each
conductance and lane (`responses`); `contraction` sums it. All work per site is real.

As in `recursion` D is factored as LΔLᵀ, and the waves never see its inverse, which would lose
digits near the levels of the eliminated piece; the largest |1/Δ|, and |P_n| of one look times |P_n|
of the next, are the measure of it. Sweeps from both ends go on at once: each alone would wait for
its divisions.

A site's record holds L (6) and 1/Δ (4) of its left sweep, then those of its right sweep, which P_n
(16) replaces: 0.5 MB for 300 sites, within the second cache.
"""

from __future__ import annotations

from typing import NamedTuple

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.recursion import C_AT, D_AT, E_AT, LOOK_EVERY
from disorder_landscape.physics.vectors import WIDTH, Vector, everywhere, larger, load, store

RECORD, P_AT = 26, 10
"""Vectors of a site's record, and where its right sweep or P_n starts."""

Block = tuple[Vector, ...]
"""Upper triangle of a symmetric 4×4 block: of electrons, their coupling to holes (4), of holes."""


class Problem(NamedTuple):
    """What the kernel needs, in units of the wire's t' = √(t² + (α/2a)²)."""

    hop: float  # t' in meV
    zeeman_per_tesla: float
    V: FloatArray  # (site,), with barriers
    along: FloatArray  # (site, 2), cos 2φn and sin 2φn
    turns: FloatArray  # (site, 2), tan ½ψ and sin ψ of ψ = π/4 − φn, up to whole turns
    log_hop_slope: float  # d ln t'/dα
    angle_slope: FloatArray  # (site,), d(φn)/dα
    zeeman: FloatArray  # (B,)
    kinetic: FloatArray  # (mu,), 2t − μ
    normal: FloatArray  # (omega,), ω + γω/√(Δ₀²−ω²), 0 ≤ ω < Δ₀
    anomalous: FloatArray  # (omega,), γΔ₀/√(Δ₀²−ω²)
    biases: NDArray[np.int64]  # (omega, 2), which bias +ω and −ω are, −1 if none
    sigma: ComplexArray  # (B, omega, lead, charge, 2, 2), in the rotated frame
    slopes: ComplexArray  # (B, omega, 2, lead, charge, 2, 2), d/dB and d/dα of sigma


@nb.njit(inline="always")
def onsite(w: Vector, a: Vector, q: Vector, x: float, z: float) -> Block:  # pragma: no cover
    """Return the onsite block of normal, anomalous, kinetic with V, and Zeeman terms."""
    zero, spin = everywhere(0.0), everywhere(-x)
    return w - q - z, spin, w - q + z, a, zero, zero, a, w + q - z, spin, w + q + z


@nb.njit(inline="always")
def factor(
    D: Block, records: FloatArray, at: int, A: Block, growth: Vector
) -> tuple[Block, Vector]:  # pragma: no cover
    """Record D = LΔLᵀ; return A − τz D⁻¹ τz and the growth."""
    d00, d01, d11, d02, d03, d12, d13, d22, d23, d33 = D
    r0 = 1.0 / d00
    l10, l20, l30 = d01 * r0, d02 * r0, d03 * r0
    r1 = 1.0 / (d11 - l10 * d01)
    d12, d13 = d12 - l10 * d02, d13 - l10 * d03
    l21, l31 = d12 * r1, d13 * r1
    r2 = 1.0 / (d22 - l20 * d02 - l21 * d12)
    d23 = d23 - l20 * d03 - l21 * d13
    l32 = d23 * r2
    r3 = 1.0 / (d33 - l30 * d03 - l31 * d13 - l32 * d23)
    store(records, at, l10)
    store(records, at + 1, l20)
    store(records, at + 2, l21)
    store(records, at + 3, l30)
    store(records, at + 4, l31)
    store(records, at + 5, l32)
    store(records, at + 6, r0)
    store(records, at + 7, r1)
    store(records, at + 8, r2)
    store(records, at + 9, r3)
    growth = larger(r3, larger(r2, larger(r1, larger(r0, growth))))
    m20, m31 = l21 * l10 - l20, l32 * l21 - l31
    m30 = l31 * l10 - l30 - l32 * m20
    x23, x13, x03 = -(r3 * l32), r3 * m31, r3 * m30
    y12, y02, y01 = -(r2 * l21), r2 * m20, -(r1 * l10)
    x22, x12, x02 = r2 - x23 * l32, y12 - x13 * l32, y02 - x03 * l32
    x11, x01 = r1 - y12 * l21 + x13 * m31, y01 - y02 * l21 + x03 * m31
    x00 = r0 - y01 * l10 + y02 * m20 + x03 * m30
    a00, a01, a11, a02, a03, a12, a13, a22, a23, a33 = A
    electrons, holes = (a00 - x00, a01 - x01, a11 - x11), (a22 - x22, a23 - x23, a33 - r3)
    return (*electrons, a02 + x02, a03 + x03, a12 + x12, a13 + x13, *holes), growth


@nb.njit(inline="always")
def write(D: Block, block: FloatArray, at: int) -> None:  # pragma: no cover
    """Write the upper triangle row by row."""
    store(block, at, D[0])
    store(block, at + 1, D[1])
    store(block, at + 2, D[3])
    store(block, at + 3, D[4])
    store(block, at + 4, D[2])
    store(block, at + 5, D[5])
    store(block, at + 6, D[6])
    store(block, at + 7, D[7])
    store(block, at + 8, D[8])
    store(block, at + 9, D[9])


@nb.njit(cache=True, error_model="numpy")
def carry(
    records: FloatArray, at: int, source: FloatArray, first: int, target: FloatArray, to: int
) -> None:  # pragma: no cover
    """Write −D⁻¹ τz times the 4×4 block `source` to `target`, with the factors recorded."""
    l10, l20, l21 = load(records, at), load(records, at + 1), load(records, at + 2)
    l30, l31, l32 = load(records, at + 3), load(records, at + 4), load(records, at + 5)
    r0, r1 = load(records, at + 6), load(records, at + 7)
    r2, r3 = load(records, at + 8), load(records, at + 9)
    for c in range(4):
        e, f = -load(source, first + c), -load(source, first + c + 4)
        g, h = load(source, first + c + 8), load(source, first + c + 12)
        f = f - l10 * e
        g = g - l20 * e - l21 * f
        h = (h - l30 * e - l31 * f - l32 * g) * r3
        g = g * r2 - l32 * h
        f = f * r1 - l21 * g - l31 * h
        store(target, to + c, e * r0 - l10 * f - l20 * g - l30 * h)
        store(target, to + c + 4, f)
        store(target, to + c + 8, g)
        store(target, to + c + 12, h)


@nb.njit(cache=True)
def write_unit(block: FloatArray, at: int, size: float) -> None:  # pragma: no cover
    """Write the unit 4×4 block times a number."""
    for k in range(16 * WIDTH):
        block[at * WIDTH + k] = size if k // WIDTH % 5 == 0 else 0.0


@nb.njit(cache=True, error_model="numpy")
def sweep(
    terms: FloatArray, records: FloatArray, p: Problem, zeeman: float, state: FloatArray
) -> None:  # pragma: no cover
    """Fill the sites' records, and E, C and D of M' into state as `eliminate_inner_sites` does.

    terms holds the kinetic, normal and anomalous terms, then the growth: the largest of what
    `columns` says and of the squared entries of M', which cancel against large X_n.
    """
    last = p.V.size - 1
    kinetic, w, a = load(terms, 0), load(terms, 1), load(terms, 2)
    x, z, growth = zeeman * p.along[:, 0], zeeman * p.along[:, 1], everywhere(0.0)
    left = onsite(w, a, kinetic + p.V[1], x[1], z[1])
    n = last - 1
    right = onsite(w, a, kinetic + p.V[n], x[n], z[n])
    for site in range(1, last):  # both sweeps at once: each waits for its divisions
        n = site + 1
        A = onsite(w, a, kinetic + p.V[n], x[n], z[n])
        left, growth = factor(left, records, RECORD * site, A, growth)
        n = last - site - 1
        A = onsite(w, a, kinetic + p.V[n], x[n], z[n])
        right, growth = factor(right, records, RECORD * (n + 1) + P_AT, A, growth)
    write_unit(records, P_AT, 1.0)
    write_unit(records, RECORD * last + P_AT, 0.0)
    before = everywhere(1.0)
    for n in range(1, last):
        at = RECORD * n + P_AT
        carry(records, at, records, at - RECORD, records, at)
        if n % LOOK_EVERY == 0:
            now = everywhere(0.0)
            for k in range(16):
                now = larger(load(records, at + k), now)
            growth, before = larger(before * now, growth), now
    write(right, state, E_AT)
    write(left, state, D_AT)
    for i in range(4):
        for j in range(4):
            entry = load(records, RECORD * (last - 1) + P_AT + 4 * j + i)
            store(state, C_AT + 4 * i + j, entry if j < 2 else -entry)
    for k in range(36):
        entry = load(state, k)
        growth = larger(entry * entry, growth)
    store(terms, 3, growth)
