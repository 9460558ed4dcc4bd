"""The wire with its leads: complex poles and residues of the ends' Green's function.

G(z) = T(z)⁻¹, T(z) = G_iso(z)⁻¹ − Σ(z), both sides 8×8: G_iso from the levels (`levels`), Σ of the
leads a cubic in the energy. At a pole T v = 0, and G ≈ v vᵀ/(ω − z) if vᵀT'v = 1.

In the space of the levels this is H(z) = E + UᵀΣ(z)U, with the levels ±E and what the ends see
of them, U. Start: the levels near the window with the self-energy that the leads and the far levels
make of them, UᵀΣ(1 − G_bg Σ)⁻¹U at one energy, its strongest mixings rotated away (`jacobi`).
Then inverse iteration with the symmetric Rayleigh quotient on H(z), all poles together, which
converges cubically: no expansion in the coupling is left.

Particle–hole symmetry, G(−ω*) = −C G(ω)* C, pairs a pole z, v with −z*, C v*: only those with
Re z ≥ 0 are worked out.
"""

from __future__ import annotations

from typing import NamedTuple

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.jacobi import diagonalise_nearly
from disorder_landscape.physics.levels import invert
from disorder_landscape.physics.parameters import FloatArray

POLES = 32
"""Poles that are polished together."""
FASTMATH = {"contract", "nsz", "arcp", "reassoc"}
UPPER = 36
"""Entries of the upper triangle of an 8×8 matrix."""
CUBIC = 4
"""Nodes, and coefficients, of the cubic for Σ(ω)."""
NEAR = 1.15
"""Levels up to so many windows are poles."""
INVISIBLE = 1e-10
"""Levels of less coupling t'|u|² (meV) carry no conductance."""
CENTRAL = 1e-7
"""Poles with |Re z| below this (meV) are their own mirror images."""
FAINT = 1e-9
"""Widths below this (meV) carry no conductance and need no digits."""
CENTRE = 1e-3
"""Starting values this near the imaginary axis (meV) may end on it, from either side."""
ASIDE = 0.1
"""Starting values on the axis are moved off it by this part of their width, to either side."""
PASSES = 12
"""Most iterations per pole."""
CONVERGED = 3e-4
"""A pole that moves by less than this part of its width has converged: cubically, 1e-11 is left."""
EQUAL = 1e-4
"""Poles nearer than this part of their width are one, of two vectors."""


@nb.njit(cache=True, error_model="numpy")
def start_poles(
    omega: float,
    G: FloatArray,
    sigma: ComplexArray,
    window: float,
    hop: float,
    E: FloatArray,
    weight: FloatArray,
    z: ComplexArray,
    up: FloatArray,
    down: FloatArray,
) -> tuple[int, int]:  # pragma: no cover
    """Write approximate poles in the right half plane and close to the imaginary axis.

    With their vectors, see `polish_poles`, for which there is as much room as for z; from G and Σ
    at one energy ω. Returns how many there are, and how many in both half planes.
    """
    near = np.empty(E.size, dtype=np.int64)
    count = 0
    bg, size = G.copy(), G.shape[0]
    for n in range(E.size):
        if E[n] < NEAR * window and hop * np.sum(weight[n] ** 2) > INVISIBLE:
            near[count] = n
            count += 1
            common = 1.0 / (omega * omega - E[n] ** 2)
            for i in range(size):
                for j in range(size):
                    factor = (omega if (i < 4) == (j < 4) else E[n]) * common
                    bg[i, j] -= factor * weight[n, i] * weight[n, j]
    dressing = np.eye(8) - bg.astype(np.complex128) @ sigma
    invert(dressing)
    dressed = sigma @ dressing
    n = 2 * count
    U, energy = np.empty((n, 8)), np.empty(n)
    for k in range(count):
        energy[k], energy[count + k] = E[near[k]], -E[near[k]]
        for i in range(size):
            U[k, i] = np.sqrt(0.5) * weight[near[k], i]
            U[count + k, i] = U[k, i] if i < 4 else -U[k, i]
    # between the chiralities Σ̃(−ω) = Σ̃(ω)*, within them −Σ̃(ω)*: the part without slope
    even = np.empty((8, 8), dtype=np.complex128)
    for i in range(size):
        for j in range(size):
            same = (i < 4) == (j < 4)
            even[i, j] = complex(0.0, dressed[i, j].imag) if same else complex(dressed[i, j].real)
    re, im = U @ even.real.copy() @ U.T, U @ even.imag.copy() @ U.T
    for k in range(n):
        re[k, k] += energy[k]
    rows_re, rows_im = np.eye(n), np.zeros((n, n))
    diagonalise_nearly(re, im, rows_re, rows_im)
    started, centred, most = 0, 0, z.size
    for k in range(n):
        if re[k, k] > -CENTRE:
            z[started] = complex(re[k, k], min(im[k, k], -1e-16))
            if abs(re[k, k]) <= CENTRAL:  # on the axis the iteration would stay on it
                side = 1.0 if centred % 2 == 0 else -1.0
                z[started] += side * ASIDE * abs(im[k, k])
                centred += 1
            for m in range(count):
                up[started, near[m]], up[most + started, near[m]] = rows_re[k, m], rows_im[k, m]
                down[started, near[m]] = rows_re[k, count + m]
                down[most + started, near[m]] = rows_im[k, count + m]
            started += 1
    return started, n


@nb.njit(cache=True, inline="always")
def upper_index(i: int, j: int) -> int:  # pragma: no cover
    """Return the place of entry (i, j) in the upper triangle."""
    a, b = min(i, j), max(i, j)
    return a * 8 - a * (a - 1) // 2 + b - a


class Levels(NamedTuple):
    """The levels and the products of their weights, as the matrix products here take them."""

    E: FloatArray  # (level,)
    a: FloatArray  # (level, 4), weights with C = +1, over √2
    b: FloatArray  # (level, 4), with C = −1
    aT: FloatArray  # (4, level)
    bT: FloatArray  # (4, level)
    same: FloatArray  # (level, 20): entries of w wᵀ within a chirality, in order
    other: FloatArray  # (level, 16): entries between the two


@nb.njit(cache=True)
def level_products(E: FloatArray, weight: FloatArray) -> Levels:  # pragma: no cover
    """Return what the passes need of the levels."""
    n, size = weight.shape
    same, other = np.empty((n, 20)), np.empty((n, 16))
    for k in range(n):
        within, between = 0, 0
        for i in range(size):
            for j in range(i, size):
                product = weight[k, i] * weight[k, j]
                if i < 4 <= j:
                    other[k, between] = product
                    between += 1
                else:
                    same[k, within] = product
                    within += 1
    half = np.sqrt(0.5) * weight
    a, b = half[:, :4].copy(), half[:, 4:].copy()
    return Levels(E, a, b, a.T.copy(), b.T.copy(), same, other)


@nb.njit(cache=True, fastmath=FASTMATH, error_model="numpy")
def _reciprocals(
    z: ComplexArray, E: FloatArray, plus: FloatArray, minus: FloatArray
) -> None:  # pragma: no cover
    """Write 1/(z − E) and 1/(z + E), shape (2 · pole, level): real parts, then imaginary parts."""
    for k in range(z.size):
        zr, zi = z[k].real, z[k].imag
        pr, pi, mr, mi = plus[k], plus[z.size + k], minus[k], minus[z.size + k]
        for n in range(E.size):
            d = zr - E[n]
            norm = 1.0 / (d * d + zi * zi)
            pr[n], pi[n] = d * norm, -zi * norm
            d = zr + E[n]
            norm = 1.0 / (d * d + zi * zi)
            mr[n], mi[n] = d * norm, -zi * norm


@nb.njit(cache=True, fastmath=FASTMATH)
def _sum_and_difference(
    p: FloatArray, q: FloatArray, factor: float
) -> tuple[FloatArray, FloatArray]:  # pragma: no cover
    """Return factor·(p + q) and factor·(p − q)."""
    plus, minus = np.empty(p.shape), np.empty(p.shape)
    for k in range(p.shape[0]):
        a, b, c, d = p[k], q[k], plus[k], minus[k]
        for n in range(a.size):
            c[n], d[n] = factor * (a[n] + b[n]), factor * (a[n] - b[n])
    return plus, minus


@nb.njit(cache=True, fastmath=FASTMATH, error_model="numpy")
def _negative_inverse(re: FloatArray, im: FloatArray) -> None:  # pragma: no cover
    """Replace each lane's complex symmetric matrix, (UPPER, POLES), by minus its inverse."""
    pr, pi = np.empty((8, POLES)), np.empty((8, POLES))
    size = re.shape[0] // 4 - 1  # 8, but not for the compiler: it would unroll everything
    for k in range(size):
        dr, di = re[upper_index(k, k)], im[upper_index(k, k)]
        for l in range(POLES):
            norm = 1.0 / (dr[l] * dr[l] + di[l] * di[l])
            dr[l], di[l] = dr[l] * norm, -di[l] * norm
        for i in range(size):
            if i != k:
                er, ei = re[upper_index(i, k)], im[upper_index(i, k)]
                qr, qi = pr[i], pi[i]
                for l in range(POLES):
                    qr[l] = er[l] * dr[l] - ei[l] * di[l]
                    qi[l] = er[l] * di[l] + ei[l] * dr[l]
        for i in range(size):
            if i != k:
                qr, qi = pr[i], pi[i]
                for j in range(i, size):
                    if j != k:
                        er, ei = re[upper_index(i, j)], im[upper_index(i, j)]
                        fr, fi = re[upper_index(k, j)], im[upper_index(k, j)]
                        for l in range(POLES):
                            er[l] -= qr[l] * fr[l] - qi[l] * fi[l]
                            ei[l] -= qr[l] * fi[l] + qi[l] * fr[l]
        for i in range(size):
            if i != k:
                er, ei, qr, qi = re[upper_index(i, k)], im[upper_index(i, k)], pr[i], pi[i]
                for l in range(POLES):
                    er[l], ei[l] = qr[l], qi[l]
        for l in range(POLES):
            dr[l], di[l] = -dr[l], -di[l]


@nb.njit(cache=True, fastmath=FASTMATH, error_model="numpy")
def dressed_green_functions(
    z: ComplexArray,
    plus: FloatArray,
    minus: FloatArray,
    levels: Levels,
    terms: ComplexArray,
    sigma: ComplexArray,
    G: ComplexArray,
) -> None:  # pragma: no cover
    """Write Σ(z) and G(z), shapes (pole, 8, 8), chiral basis.

    plus, minus: from `_reciprocals`; terms: coefficients of Σ, shape (CUBIC, UPPER).
    """
    count, size = z.size, G.shape[1]
    even, odd = _sum_and_difference(plus, minus, 0.5)
    within, between = np.dot(even, levels.same), np.dot(odd, levels.other)
    re, im = np.empty((UPPER, POLES)), np.empty((UPPER, POLES))
    sr, si = np.empty((UPPER, POLES)), np.empty((UPPER, POLES))
    zr, zi = np.empty(POLES), np.empty(POLES)
    for first in range(0, count, POLES):
        for l in range(POLES):
            k = min(first + l, count - 1)
            zr[l], zi[l] = z[k].real, z[k].imag
            e, p, q = 0, 0, 0
            for i in range(size):
                for j in range(i, size):
                    if i < 4 <= j:
                        re[e, l], im[e, l] = between[k, q], between[count + k, q]
                        q += 1
                    else:
                        re[e, l], im[e, l] = within[k, p], within[count + k, p]
                        p += 1
                    e += 1
        _negative_inverse(re, im)
        for e in range(re.shape[0]):
            er, ei, fr, fi = re[e], im[e], sr[e], si[e]
            c3, c2, c1, c0 = terms[3, e], terms[2, e], terms[1, e], terms[0, e]
            for l in range(POLES):
                ar = c3.real * zr[l] - c3.imag * zi[l] + c2.real
                ai = c3.real * zi[l] + c3.imag * zr[l] + c2.imag
                br, bi = ar * zr[l] - ai * zi[l] + c1.real, ar * zi[l] + ai * zr[l] + c1.imag
                fr[l], fi[l] = br * zr[l] - bi * zi[l] + c0.real, br * zi[l] + bi * zr[l] + c0.imag
                er[l] += fr[l]
                ei[l] += fi[l]
        _negative_inverse(re, im)  # of −T: this is +G
        for l in range(min(POLES, count - first)):
            for i in range(size):
                for j in range(size):
                    e = upper_index(i, j)
                    G[first + l, i, j] = complex(re[e, l], im[e, l])
                    sigma[first + l, i, j] = complex(sr[e, l], si[e, l])


@nb.njit(cache=True)
def green_functions_at(
    z: ComplexArray, levels: Levels, terms: ComplexArray
) -> ComplexArray:  # pragma: no cover
    """Return G(z), shape (energy, 8, 8), chiral basis."""
    shape = (2 * z.size, levels.E.size)
    plus, minus = np.empty(shape), np.empty(shape)
    sigma = np.empty((z.size, 8, 8), dtype=np.complex128)
    G = np.empty((z.size, 8, 8), dtype=np.complex128)
    _reciprocals(z, levels.E, plus, minus)
    dressed_green_functions(z, plus, minus, levels, terms, sigma, G)
    return G


@nb.njit(cache=True, fastmath=FASTMATH)
def _multiply(x: FloatArray, r: FloatArray) -> None:  # pragma: no cover
    """Multiply x by r in place; both (2 · pole, level): real parts, then imaginary parts."""
    count = x.shape[0] // 2
    for k in range(count):
        xr, xi, rr, ri = x[k], x[count + k], r[k], r[count + k]
        for n in range(xr.size):
            a, b = xr[n], xi[n]
            xr[n], xi[n] = a * rr[n] - b * ri[n], a * ri[n] + b * rr[n]


@nb.njit(cache=True)
def _end_vectors(
    up: FloatArray, down: FloatArray, levels: Levels
) -> ComplexArray:  # pragma: no cover
    """Return U x, shape (pole, 8): what the ends see of vectors over the levels +E and −E."""
    count = up.shape[0] // 2
    total, difference = _sum_and_difference(up, down, 1.0)
    a, b = np.dot(total, levels.a), np.dot(difference, levels.b)
    y = np.empty((count, 8), dtype=np.complex128)
    for k in range(count):
        for i in range(4):
            y[k, i] = complex(a[k, i], a[count + k, i])
            y[k, 4 + i] = complex(b[k, i], b[count + k, i])
    return y


@nb.njit(cache=True, fastmath=FASTMATH)
def _pushed(
    y: ComplexArray, sigma: ComplexArray, G: ComplexArray, a: FloatArray, b: FloatArray
) -> None:  # pragma: no cover
    """Write (Σ + ΣGΣ)y: a and b, shape (2 · pole, 4), its parts of C = ±1 as real, imaginary."""
    count, size = y.shape
    t, u = np.empty(size, dtype=np.complex128), np.empty(size, dtype=np.complex128)
    for k in range(count):
        S, g = sigma[k], G[k]
        for i in range(size):
            total = 0j
            for j in range(size):
                total += S[i, j] * y[k, j]
            t[i] = total
        for i in range(size):
            total = y[k, i]
            for j in range(size):
                total += g[i, j] * t[j]
            u[i] = total
        for i in range(size):
            total = 0j
            for j in range(size):
                total += S[i, j] * u[j]
            if i < 4:
                a[k, i], a[count + k, i] = total.real, total.imag
            else:
                b[k, i - 4], b[count + k, i - 4] = total.real, total.imag


@nb.njit(cache=True, fastmath=FASTMATH)
def _products(x: FloatArray, y: FloatArray, k: int, m: int) -> complex:  # pragma: no cover
    """Return xᵀy of vectors k and m, without conjugation."""
    count = x.shape[0] // 2
    xr, xi, yr, yi = x[k], x[count + k], y[m], y[count + m]
    re = im = 0.0
    for n in range(xr.size):
        re += xr[n] * yr[n] - xi[n] * yi[n]
        im += xr[n] * yi[n] + xi[n] * yr[n]
    return complex(re, im)


@nb.njit(cache=True, fastmath=FASTMATH)
def _scale(x: FloatArray, k: int, factor: complex) -> None:  # pragma: no cover
    """Multiply vector k by a number."""
    count = x.shape[0] // 2
    xr, xi, fr, fi = x[k], x[count + k], factor.real, factor.imag
    for n in range(xr.size):
        a, b = xr[n], xi[n]
        xr[n], xi[n] = a * fr - b * fi, a * fi + b * fr


@nb.njit(cache=True)
def _add(x: FloatArray, y: FloatArray) -> None:  # pragma: no cover
    """Add y to x."""
    for k in range(x.shape[0]):
        a, b = x[k], y[k]
        for n in range(a.size):
            a[n] += b[n]


@nb.njit(cache=True, error_model="numpy")
def _one_pass(
    z: ComplexArray, up: FloatArray, down: FloatArray, levels: Levels, terms: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:  # pragma: no cover
    """Replace every x by (z − H)⁻¹x with xᵀ(1 − H')x = 1; return the better z and U x.

    (z − H)⁻¹ = R + R Uᵀ(Σ + ΣGΣ)U R with R = (z − E)⁻¹: never more than 8×8 is inverted.
    """
    count = z.size
    shape = (2 * count, levels.E.size)
    plus, minus = np.empty(shape), np.empty(shape)
    sigma = np.empty((count, 8, 8), dtype=np.complex128)
    G = np.empty((count, 8, 8), dtype=np.complex128)
    _reciprocals(z, levels.E, plus, minus)
    dressed_green_functions(z, plus, minus, levels, terms, sigma, G)
    old_up, old_down = up.copy(), down.copy()
    _multiply(up, plus)
    _multiply(down, minus)
    a, b = np.empty((2 * count, 4)), np.empty((2 * count, 4))
    _pushed(_end_vectors(up, down, levels), sigma, G, a, b)
    back_up, back_down = _sum_and_difference(np.dot(a, levels.aT), np.dot(b, levels.bT), 1.0)
    _multiply(back_up, plus)
    _multiply(back_down, minus)
    _add(up, back_up)
    _add(down, back_down)
    y = _end_vectors(up, down, levels)
    better = np.empty(count, dtype=np.complex128)
    size = y.shape[1]
    for k in range(count):
        norm = _products(up, up, k, k) + _products(down, down, k, k)
        for i in range(size):
            for j in range(i, size):
                e = upper_index(i, j)
                slope = terms[1, e] + z[k] * (2 * terms[2, e] + 3 * z[k] * terms[3, e])
                norm -= (1.0 if i == j else 2.0) * y[k, i] * slope * y[k, j]
        new = z[k] - (_products(up, old_up, k, k) + _products(down, old_down, k, k)) / norm
        better[k] = complex(new.real, min(new.imag, -1e-16))
        root = 1.0 / np.sqrt(norm)
        for i in range(size):
            y[k, i] *= root
        _scale(up, k, root)
        _scale(down, k, root)
    return better, y


@nb.njit(cache=True)
def chosen_vectors(
    x: FloatArray, chosen: NDArray[np.int64], n: int
) -> FloatArray:  # pragma: no cover
    """Return the vectors `chosen` of n."""
    count = chosen.size
    out = np.empty((2 * count, x.shape[1]))
    for k in range(count):
        for m in range(x.shape[1]):
            out[k, m], out[count + k, m] = x[chosen[k], m], x[n + chosen[k], m]
    return out


@nb.njit(cache=True, error_model="numpy")
def polish_poles(
    z: ComplexArray, up: FloatArray, down: FloatArray, levels: Levels, terms: ComplexArray
) -> ComplexArray:  # pragma: no cover
    """Iterate poles and vectors to convergence, in place; return U x, shape (pole, 8).

    up, down: the vectors over the levels +E and −E, shape (2 · pole, level): real parts, then
    imaginary parts.
    """
    n = z.size
    v = np.empty((n, 8), dtype=np.complex128)
    active = np.arange(n)
    for _ in range(PASSES):
        count = active.size
        some_z = np.empty(count, dtype=np.complex128)
        for k in range(count):
            some_z[k] = z[active[k]]
        some_up, some_down = chosen_vectors(up, active, n), chosen_vectors(down, active, n)
        better, y = _one_pass(some_z, some_up, some_down, levels, terms)
        still = np.empty(count, dtype=np.int64)
        left = 0
        for k in range(count):
            at = active[k]
            if abs(better[k] - z[at]) > CONVERGED * (abs(better[k].imag) + FAINT):
                still[left] = at
                left += 1
            z[at] = better[k]
            for i in range(8):
                v[at, i] = y[k, i]
            for m in range(up.shape[1]):
                up[at, m], up[n + at, m] = some_up[k, m], some_up[count + k, m]
                down[at, m], down[n + at, m] = some_down[k, m], some_down[count + k, m]
        if left == 0:
            break
        active = still[:left].copy()
    return v


@nb.njit(cache=True)
def _orthogonalise(
    k: int, at: int, v: ComplexArray, up: FloatArray, down: FloatArray
) -> float:  # pragma: no cover
    """Take vector `at` out of vector k; return how much of it is left, as a share of its square."""
    n = up.shape[0] // 2
    overlap = _products(up, up, at, at) + _products(down, down, at, at)
    overlap = (_products(up, up, k, at) + _products(down, down, k, at)) / overlap
    before = after = 0.0
    for x in (up, down):
        for m in range(x.shape[1]):
            own, other = complex(x[k, m], x[n + k, m]), complex(x[at, m], x[n + at, m])
            new = own - overlap * other
            before += abs(own) ** 2
            after += abs(new) ** 2
            x[k, m], x[n + k, m] = new.real, new.imag
    root = 1.0 / np.sqrt(_products(up, up, k, k) + _products(down, down, k, k))
    _scale(up, k, root)
    _scale(down, k, root)
    for i in range(v.shape[1]):
        v[k, i] = (v[k, i] - overlap * v[at, i]) * root
    return after / before


@nb.njit(cache=True, error_model="numpy")
def right_half(
    z: ComplexArray, v: ComplexArray, up: FloatArray, down: FloatArray
) -> tuple[int, int]:  # pragma: no cover
    """Put the poles with mirror images first, then those that are their own; drop the others.

    Vectors of equal poles (Kramers pairs at B = 0) are made orthogonal; one that is not new is
    dropped. Returns how many there are of each kind.
    """
    n = z.size
    order = np.empty(n, dtype=np.int64)
    found, paired = 0, 0
    for central in range(2):
        for k in range(n):
            mine = abs(z[k].real) <= CENTRAL if central else z[k].real > CENTRAL
            if not mine:
                continue
            kept = 1.0
            for m in range(found):
                at = order[m]
                faint = abs(z[k].imag) < FAINT  # it may stand twice: it carries nothing
                if not faint and abs(z[at] - z[k]) < EQUAL * abs(z[k].imag):
                    kept = min(kept, _orthogonalise(k, at, v, up, down))
            if kept > 0.1:
                order[found] = k
                found += 1
        if central == 0:
            paired = found
    old_z, old_v = z.copy(), v.copy()
    for k in range(found):
        z[k] = old_z[order[k]]
        for i in range(v.shape[1]):
            v[k, i] = old_v[order[k], i]
    return paired, found - paired
