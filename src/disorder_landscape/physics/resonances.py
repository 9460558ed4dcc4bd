"""The wire with its leads: complex poles and residues of the ends' Green's function.

G(z) = T(z)⁻¹, T(z) = G_iso(z)⁻¹ − Σ(z), both sides 8×8: G_iso from the levels (`levels`), Σ of the
leads a cubic in the energy. At a pole T v = 0, and G ≈ v vᵀ/(ω − z) if vᵀT'v = 1.

Start: the levels ±E near the window with the self-energy that the leads and the far levels make of
them, H = E + UᵀΣ̃U, Σ̃ = Σ(1 − G_bg Σ)⁻¹ at one energy, its strongest mixings rotated away (`jacobi`).
Then inverse iteration with the symmetric Rayleigh functional on T itself (Schwetlick and Schreiber
2012), which converges cubically: no expansion in the coupling is left. LANES poles go together.

Particle–hole symmetry, G(−ω*) = −C G(ω)* C, pairs a pole z, v with −z*, C v*: only those with
Re z ≥ 0 are worked out.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.jacobi import diagonalise_nearly
from disorder_landscape.physics.levels import invert
from disorder_landscape.physics.parameters import FloatArray

POLES = 8
"""Poles that are polished together."""
UPPER = 36
"""Entries of the upper triangle of an 8×8 matrix."""
CUBIC = 4
"""Nodes, and coefficients, of the cubic for Σ(ω)."""
NEAR = 1.35
"""Levels up to so many windows are poles."""
INVISIBLE = 1e-10
"""Levels of less coupling t'|u|² (meV) carry no conductance."""
CENTRAL = 1e-7
"""Poles with |Re z| below this (meV) are their own mirror images."""
FAINT = 1e-9
"""Widths below this (meV) carry no conductance and need no digits."""
CENTRE = 1e-3
"""Starting values this near the imaginary axis (meV) may end on it, from either side."""
PASSES = 12
"""Most iterations per pole."""
CONVERGED = 1e-5
"""A pole that moves by less than this part of its width has converged: cubically, 1e-14 is left."""
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
    x: ComplexArray,
) -> tuple[int, int]:  # pragma: no cover
    """Write approximate poles in the right half plane and close to the imaginary axis.

    With their vectors x over the levels +E, then −E, shape (pole, 2 · level), from G and Σ at one
    energy ω. Returns how many there are, and how many in both half planes.
    """
    near = np.empty(E.size, dtype=np.int64)
    count = 0
    bg = G.copy()
    for n in range(E.size):
        if E[n] < NEAR * window and hop * np.sum(weight[n] ** 2) > INVISIBLE:
            near[count] = n
            count += 1
            common = 1.0 / (omega * omega - E[n] ** 2)
            for i in range(8):
                for j in range(8):
                    factor = (omega if (i < 4) == (j < 4) else E[n]) * common
                    bg[i, j] -= factor * weight[n, i] * weight[n, j]
    dressing = np.eye(8) - bg.astype(np.complex128) @ sigma
    invert(dressing)
    dressed = sigma @ dressing
    n = 2 * count
    U, energy = np.empty((n, 8)), np.empty(n)
    for k in range(count):
        energy[k], energy[count + k] = E[near[k]], -E[near[k]]
        for i in range(8):
            U[k, i] = np.sqrt(0.5) * weight[near[k], i]
            U[count + k, i] = U[k, i] if i < 4 else -U[k, i]
    # between the chiralities Σ̃(−ω) = Σ̃(ω)*, within them −Σ̃(ω)*: the part without slope
    even = np.empty((8, 8), dtype=np.complex128)
    for i in range(8):
        for j in range(8):
            same = (i < 4) == (j < 4)
            even[i, j] = complex(0.0, dressed[i, j].imag) if same else complex(dressed[i, j].real)
    re, im = U @ even.real.copy() @ U.T, U @ even.imag.copy() @ U.T
    for k in range(n):
        re[k, k] += energy[k]
    rows_re, rows_im = np.eye(n), np.zeros((n, n))
    diagonalise_nearly(re, im, rows_re, rows_im)
    started = 0
    for k in range(n):
        if re[k, k] > -CENTRE:
            z[started] = complex(re[k, k], min(im[k, k], -1e-16))
            x[started] = 0.0
            for m in range(count):
                x[started, near[m]] = complex(rows_re[k, m], rows_im[k, m])
                x[started, E.size + near[m]] = complex(rows_re[k, count + m], rows_im[k, count + m])
            started += 1
    return started, n


@nb.njit(cache=True, error_model="numpy")
def upper_products(weight: FloatArray) -> FloatArray:  # pragma: no cover
    """Return the upper triangles of w wᵀ, shape (level, UPPER)."""
    out = np.empty((weight.shape[0], UPPER))
    for n in range(weight.shape[0]):
        at = 0
        for i in range(8):
            for j in range(i, 8):
                out[n, at] = weight[n, i] * weight[n, j]
                at += 1
    return out


@nb.njit(cache=True, fastmath={"contract", "nsz"}, error_model="numpy")
def _isolated(
    zr: FloatArray, zi: FloatArray, E: FloatArray, products: FloatArray, re: FloatArray, im: FloatArray
) -> None:  # pragma: no cover
    """Write the upper triangle of G_iso(z) of each lane, entry e of lane l at [e·POLES + l]."""
    L = POLES
    same_re, same_im = np.empty(L), np.empty(L)
    other_re, other_im = np.empty(L), np.empty(L)
    re[:], im[:] = 0.0, 0.0
    for n in range(E.size):
        for l in range(L):
            xr, xi = zr[l] * zr[l] - zi[l] * zi[l] - E[n] * E[n], 2 * zr[l] * zi[l]
            norm = 1.0 / (xr * xr + xi * xi)
            xr, xi = xr * norm, -xi * norm
            same_re[l], same_im[l] = zr[l] * xr - zi[l] * xi, zr[l] * xi + zi[l] * xr
            other_re[l], other_im[l] = E[n] * xr, E[n] * xi
        at = 0
        for i in range(8):
            for j in range(i, 8):
                p = products[n, at]
                if i < 4 <= j:
                    for l in range(L):
                        re[at * L + l] += p * other_re[l]
                        im[at * L + l] += p * other_im[l]
                else:
                    for l in range(L):
                        re[at * L + l] += p * same_re[l]
                        im[at * L + l] += p * same_im[l]
                at += 1


@nb.njit(cache=True, inline="always")
def upper_index(i: int, j: int) -> int:  # pragma: no cover
    """Return the place of entry (i, j) in the upper triangle."""
    a, b = min(i, j), max(i, j)
    return a * 8 - a * (a - 1) // 2 + b - a


@nb.njit(cache=True, fastmath={"contract", "nsz"}, error_model="numpy")
def _negative_inverse(re: FloatArray, im: FloatArray) -> None:  # pragma: no cover
    """Replace each lane's complex symmetric matrix by minus its inverse, by sweeps."""
    L = POLES
    pr, pi = np.empty(8 * L), np.empty(8 * L)
    for k in range(8):
        d = upper_index(k, k) * L
        for l in range(L):
            norm = 1.0 / (re[d + l] ** 2 + im[d + l] ** 2)
            re[d + l], im[d + l] = re[d + l] * norm, -im[d + l] * norm
        for i in range(8):
            if i != k:
                e = upper_index(i, k) * L
                for l in range(L):
                    pr[i * L + l] = re[e + l] * re[d + l] - im[e + l] * im[d + l]
                    pi[i * L + l] = re[e + l] * im[d + l] + im[e + l] * re[d + l]
        for i in range(8):
            for j in range(i, 8):
                if i != k and j != k:
                    e, kj = upper_index(i, j) * L, upper_index(k, j) * L
                    for l in range(L):
                        re[e + l] -= pr[i * L + l] * re[kj + l] - pi[i * L + l] * im[kj + l]
                        im[e + l] -= pr[i * L + l] * im[kj + l] + pi[i * L + l] * re[kj + l]
        for i in range(8):
            if i != k:
                e = upper_index(i, k) * L
                for l in range(L):
                    re[e + l], im[e + l] = pr[i * L + l], pi[i * L + l]
        for l in range(L):
            re[d + l], im[d + l] = -re[d + l], -im[d + l]


@nb.njit(cache=True, fastmath={"contract", "nsz"}, error_model="numpy")
def _self_energy(
    zr: FloatArray, zi: FloatArray, terms: ComplexArray, re: FloatArray, im: FloatArray
) -> None:  # pragma: no cover
    """Write Σ(z), terms of shape (CUBIC, UPPER), in every lane."""
    L = POLES
    for e in range(UPPER):
        c3, c2, c1, c0 = terms[3, e], terms[2, e], terms[1, e], terms[0, e]
        for l in range(L):
            ar, ai = c3.real * zr[l] - c3.imag * zi[l] + c2.real, c3.real * zi[l] + c3.imag * zr[l] + c2.imag
            ar, ai = ar * zr[l] - ai * zi[l] + c1.real, ar * zi[l] + ai * zr[l] + c1.imag
            re[e * L + l], im[e * L + l] = ar * zr[l] - ai * zi[l] + c0.real, ar * zi[l] + ai * zr[l] + c0.imag


@nb.njit(cache=True, error_model="numpy")
def dressed_green_functions(
    z: ComplexArray,
    E: FloatArray,
    products: FloatArray,
    terms: ComplexArray,
    sigma: ComplexArray,
    G: ComplexArray,
) -> None:  # pragma: no cover
    """Write Σ(z) and G(z) for up to POLES energies z; shapes (energy, 8, 8), chiral basis."""
    L = POLES
    zr, zi = np.empty(L), np.empty(L)
    for l in range(L):
        zl = z[min(l, z.size - 1)]
        zr[l], zi[l] = zl.real, zl.imag
    re, im = np.empty(UPPER * L), np.empty(UPPER * L)
    sr, si = np.empty(UPPER * L), np.empty(UPPER * L)
    _isolated(zr, zi, E, products, re, im)
    _negative_inverse(re, im)
    _self_energy(zr, zi, terms, sr, si)
    for k in range(UPPER * L):
        re[k] += sr[k]
        im[k] += si[k]
    _negative_inverse(re, im)  # of −T: this is +G
    for l in range(z.size):
        for i in range(8):
            for j in range(8):
                at = upper_index(i, j) * L + l
                G[l, i, j], sigma[l, i, j] = complex(re[at], im[at]), complex(sr[at], si[at])


@nb.njit(cache=True, error_model="numpy")
def end_vector(x: ComplexArray, weight: FloatArray, out: ComplexArray) -> None:  # pragma: no cover
    """Write U x, shape (8,): what the ends see of a vector over the levels +E, then −E."""
    n = weight.shape[0]
    out[:] = 0j
    for k in range(n):
        a, b = np.sqrt(0.5) * (x[k] + x[n + k]), np.sqrt(0.5) * (x[k] - x[n + k])
        for i in range(4):
            out[i] += a * weight[k, i]
            out[4 + i] += b * weight[k, 4 + i]


@nb.njit(cache=True, error_model="numpy")
def _inverse_iteration(
    z: complex,
    x: ComplexArray,
    E: FloatArray,
    weight: FloatArray,
    sigma: ComplexArray,
    G: ComplexArray,
    slope: ComplexArray,
) -> complex:  # pragma: no cover
    """Replace x by (z − H)⁻¹x, normalised to xᵀ(1 − H')x = 1, and return the better z.

    (z − H)⁻¹ = R + R Uᵀ(Σ + ΣGΣ)U R with R = (z − E)⁻¹: never more than 8×8 is inverted.
    """
    n = E.size
    y, q, t = (np.empty(8, dtype=np.complex128), np.empty(8, dtype=np.complex128), np.empty(8, dtype=np.complex128))
    old = x.copy()
    for k in range(n):
        x[k] = old[k] / (z - E[k])
        x[n + k] = old[n + k] / (z + E[k])
    end_vector(x, weight, y)
    for i in range(8):
        q[i] = 0j
        for j in range(8):
            q[i] += sigma[i, j] * y[j]
    for i in range(8):
        t[i] = y[i]
        for j in range(8):
            t[i] += G[i, j] * q[j]
    for i in range(8):
        q[i] = 0j
        for j in range(8):
            q[i] += sigma[i, j] * t[j]
    largest = 0.0
    for k in range(n):
        a, b = 0j, 0j
        for i in range(4):
            a += weight[k, i] * q[i]
            b += weight[k, 4 + i] * q[4 + i]
        x[k] += np.sqrt(0.5) * (a + b) / (z - E[k])
        x[n + k] += np.sqrt(0.5) * (a - b) / (z + E[k])
        largest = max(largest, abs(x[k].real), abs(x[k].imag), abs(x[n + k].real), abs(x[n + k].imag))
    scale = 1.0 / largest
    form, norm = 0j, 0j
    for k in range(2 * n):
        x[k] *= scale
        form += x[k] * old[k]
        norm += x[k] * x[k]
    end_vector(x, weight, y)
    for i in range(8):
        for j in range(8):
            norm -= y[i] * slope[i, j] * y[j]
    root = 1.0 / np.sqrt(norm)
    for k in range(2 * n):
        x[k] *= root
    return z - form * scale / norm


@nb.njit(cache=True, error_model="numpy")
def polish_poles(
    z: ComplexArray,
    x: ComplexArray,
    E: FloatArray,
    weight: FloatArray,
    products: FloatArray,
    terms: ComplexArray,
) -> None:  # pragma: no cover
    """Iterate poles and vectors, shapes (pole,) and (pole, 2 · level), to convergence, in place."""
    sigma = np.empty((POLES, 8, 8), dtype=np.complex128)
    G = np.empty((POLES, 8, 8), dtype=np.complex128)
    slope = np.empty((8, 8), dtype=np.complex128)
    for first in range(0, z.size, POLES):
        last = min(first + POLES, z.size)
        for _ in range(PASSES):
            moved = 0.0
            dressed_green_functions(z[first:last], E, products, terms, sigma, G)
            for k in range(first, last):
                for i in range(8):
                    for j in range(8):
                        at = upper_index(i, j)
                        slope[i, j] = terms[1, at] + z[k] * (2 * terms[2, at] + 3 * z[k] * terms[3, at])
                S, g = sigma[k - first], G[k - first]
                new = _inverse_iteration(z[k], x[k], E, weight, S, g, slope)
                moved = max(moved, abs(new - z[k]) / (abs(new.imag) + FAINT))
                z[k] = complex(new.real, min(new.imag, -1e-16))
            if moved < CONVERGED:
                break


@nb.njit(cache=True, error_model="numpy")
def right_half(z: ComplexArray, x: ComplexArray) -> tuple[int, int]:  # pragma: no cover
    """Put the poles with mirror images first, then those that are their own; drop the others.

    Vectors of equal poles (Kramers pairs at B = 0) are made orthogonal; a vector that is not new is
    dropped. Returns how many there are of each kind.
    """
    n = z.size
    old_z, old_x = z.copy(), x.copy()
    found = 0
    paired = 0
    for central in range(2):
        for k in range(n):
            mine = abs(old_z[k].real) <= CENTRAL if central else old_z[k].real > CENTRAL
            if not mine:
                continue
            z[found], x[found] = old_z[k], old_x[k]
            before = np.sum(np.abs(x[found]) ** 2)
            for m in range(found):
                if abs(z[m] - z[found]) < EQUAL * (abs(z[m].imag) + FAINT):
                    overlap = np.sum(x[m] * x[found]) / np.sum(x[m] * x[m])
                    x[found] -= overlap * x[m]
            after = np.sum(np.abs(x[found]) ** 2)
            if after < 0.1 * before:
                continue
            if after != before:
                x[found] /= np.sqrt(np.sum(x[found] * x[found]))
            found += 1
        if not central:
            paired = found
    return paired, found - paired
