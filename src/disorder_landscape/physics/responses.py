"""How the conductances answer to a change at the ends: of the wire's end blocks, and of the leads.

With G = (M' − Σ)⁻¹ of the end sites, m = Γ_b G_ab† Γ_a and dG = −G (dM' − dΣ) G, the probability
p_ab = Tr[G_ab m] from one channel set to another (`ends`) changes by

    dp = −2 Re Tr[Y (dM' − dΣ)] + Tr[dΓ_a G_ab Γ_b G_ab†] + Tr[Γ_a G_ab dΓ_b G_ab†],

Y = G_·b m G_a·. For real dM' that is Tr[S dM'], S the symmetric part of −2 Re Y. The conductances
at both signs of ω are sums of six such probabilities.
"""

from __future__ import annotations

import numba as nb

from disorder_landscape.physics.contraction import PAIRS
from disorder_landscape.physics.ends import CHANNELS, CONDUCTANCE_WEIGHTS
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.recursion import C_AT, D_AT, E_AT
from disorder_landscape.physics.vectors import WIDTH, everywhere, load, store, vectors

LEAD_ENTRIES = 72
"""Per lane: 4 channel sets × entries 00, 01, 11 × (re, im) of Σ, dΣ/dB and dΣ/dα."""


@nb.njit(cache=True, error_model="numpy")
def end_green_functions(
    state: FloatArray, leads: FloatArray, re: FloatArray, im: FloatArray
) -> None:  # pragma: no cover
    """Write −G of the two end sites to re and im, as `ends` does, from its 36 real entries."""
    upper = 0
    for i in range(4):
        for j in range(4):
            if j >= i:
                store(re, 8 * i + j, load(state, E_AT + upper))
                store(re, 8 * i + j + 36, load(state, D_AT + upper))
                upper += 1
            store(re, 8 * i + j + 4, load(state, C_AT + 4 * i + j))
    im[:] = 0.0
    for c in range(4):
        for entry in range(3):
            at, of = 18 * c + 8 * (entry // 2) + (entry + 1) // 2, 2 * (9 * c + entry)
            store(re, at, load(re, at) - load(leads, of))
            store(im, at, -load(leads, of + 1))
    row_re, row_im = vectors(8), vectors(8)
    for k in range(8):
        x, y = load(re, 9 * k), load(im, 9 * k)
        norm = 1.0 / (x * x + y * y)
        x, y = x * norm, -(y * norm)
        for i in range(8):  # the row of the pivot, and divided by it
            at = 8 * min(i, k) + max(i, k)
            u, v = load(re, at), load(im, at)
            store(row_re, i, u)
            store(row_im, i, v)
            store(re, at, u * x - v * y)
            store(im, at, u * y + v * x)
        for i in range(8):
            if i != k:
                at = 8 * min(i, k) + max(i, k)
                u, v = load(re, at), load(im, at)
                for j in range(i, 8):
                    if j != k:
                        r, s, to = load(row_re, j), load(row_im, j), 8 * i + j
                        store(re, to, load(re, to) - u * r + v * s)
                        store(im, to, load(im, to) - u * s - v * r)
        store(re, 9 * k, -x)
        store(im, 9 * k, -y)


@nb.njit(cache=True, error_model="numpy")
def end_responses(
    re: FloatArray, im: FloatArray, leads: FloatArray, S: FloatArray, ends: FloatArray
) -> None:  # pragma: no cover
    """Write S of the six probabilities, and what the leads contribute.

    Parameters
    ----------
    re, im : array of 64 vectors
        −G of the two end sites, upper triangle.
    leads : array of LEAD_ENTRIES vectors
        [(3·which + entry)·2 + part], with `which` counting Σ, dΣ/dB, dΣ/dα of each channel set.
    S : array of 36·6 vectors
        On return entry (i, j) of `PAIRS` for probability k at 6·entry + k, twice S where i ≠ j.
    ends : array of 12 vectors
        On return the derivatives with respect to B and α through the leads alone, at 2·k.
    """
    R, J = vectors(64), vectors(64)  # G
    for i in range(8):
        for j in range(8):
            at = 8 * min(i, j) + max(i, j)
            store(R, 8 * i + j, -load(re, at))
            store(J, 8 * i + j, -load(im, at))
    gamma = vectors(48)  # Γ and its two derivatives, all four entries, of the four channel sets
    for block in range(12):
        for i in range(2):
            for j in range(2):
                store(gamma, 4 * block + 2 * i + j, -2.0 * load(leads, 6 * block + 2 * (i + j) + 1))
    t, m, U, Y = vectors(8), vectors(8), vectors(32), vectors(128)
    for k in range(6):
        a, b = 2 * CHANNELS[k, 0], 2 * CHANNELS[k, 1]
        A, B = 6 * a, 6 * b  # where Γ of the sets starts: 3·4 entries for each
        for q in range(2):
            for p in range(2):  # t = Γ_b G_ab†
                g, h = load(gamma, B + 2 * q), load(gamma, B + 2 * q + 1)
                at = 8 * (a + p) + b
                store(t, 2 * q + p, g * load(R, at) + h * load(R, at + 1))
                store(t, 4 + 2 * q + p, -(g * load(J, at) + h * load(J, at + 1)))
        for q in range(2):
            for p in range(2):
                g, h = load(gamma, A + p), load(gamma, A + 2 + p)
                for part in (0, 4):
                    at = part + 2 * q
                    store(m, at + p, load(t, at) * g + load(t, at + 1) * h)
        for i in range(8):
            x, y, X, Y_ = (
                load(R, 8 * i + b),
                load(R, 8 * i + b + 1),
                load(J, 8 * i + b),
                load(J, 8 * i + b + 1),
            )
            for p in range(2):
                u, v, U_, V = load(m, p), load(m, 2 + p), load(m, 4 + p), load(m, 6 + p)
                store(U, 4 * i + p, x * u + y * v - X * U_ - Y_ * V)
                store(U, 4 * i + 2 + p, x * U_ + y * V + X * u + Y_ * v)
        for i in range(8):
            x, y, X, Y_ = load(U, 4 * i), load(U, 4 * i + 1), load(U, 4 * i + 2), load(U, 4 * i + 3)
            for j in range(8):
                at = 8 * a + j
                u, v, U_, V = load(R, at), load(R, at + 8), load(J, at), load(J, at + 8)
                store(Y, 8 * i + j, x * u + y * v - X * U_ - Y_ * V)
                store(Y, 64 + 8 * i + j, x * U_ + y * V + X * u + Y_ * v)
        for entry in range(36):
            i, j = PAIRS[entry]
            symmetric = load(Y, 8 * i + j) + load(Y, 8 * j + i)
            store(S, 6 * entry + k, (-1.0 if i == j else -2.0) * symmetric)
        for by in range(1, 3):
            answer = everywhere(0.0)
            for c in range(4):
                for i in range(2):
                    for j in range(2):
                        at, of = 8 * (2 * c + i) + 2 * c + j, 6 * (3 * c + by) + 2 * (i + j)
                        answer = answer + 2.0 * (
                            load(Y, at) * load(leads, of) - load(Y, 64 + at) * load(leads, of + 1)
                        )
            for p in range(2):
                for o in range(2):
                    for q in range(2):
                        at = 8 * (a + p) + b + q
                        weight = load(R, at) * load(t, 2 * q + o) - load(J, at) * load(
                            t, 4 + 2 * q + o
                        )
                        answer = answer + load(gamma, A + 4 * by + 2 * o + p) * weight
                        n = 8 * (a + o) + b  # G_ab† Γ_a G_ab
                        g = load(gamma, A + 2 * p + o)
                        for r in range(2):
                            weight = load(R, at) * load(R, n + r) + load(J, at) * load(J, n + r)
                            answer = answer + load(gamma, B + 4 * by + 2 * r + q) * g * weight
            store(ends, 2 * k + by - 1, answer)


@nb.njit(cache=True)
def pick_sign(
    S: FloatArray, ends: FloatArray, signs: FloatArray, picked: FloatArray, picked_ends: FloatArray
) -> None:  # pragma: no cover
    """Add up the conductances of one sign of ω a lane; signs holds 0 or 1."""
    weight = vectors(1)
    picked[:], picked_ends[:] = 0.0, 0.0
    for k in range(4):
        for q in range(6):
            plus, minus = CONDUCTANCE_WEIGHTS[0, k, q], CONDUCTANCE_WEIGHTS[1, k, q]
            if plus == 0 and minus == 0:
                continue
            for l in range(WIDTH):
                weight[l] = minus if signs[l] else plus
            w = load(weight, 0)
            for entry in range(36):
                at = 4 * entry + k
                store(picked, at, load(picked, at) + w * load(S, 6 * entry + q))
            for by in range(2):
                at = 2 * k + by
                store(picked_ends, at, load(picked_ends, at) + w * load(ends, 2 * q + by))
