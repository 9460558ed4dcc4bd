"""Where the poles of the wire with its leads are looked for, and which of them count.

Start: the levels near the window with the self-energy that the leads and the far levels make of
them, UᵀΣ(1 − G_bg Σ)⁻¹U = Uᵀ(S − G_bg)⁻¹U at one energy, its strongest mixings rotated away
(`jacobi`). `inverse_iteration` does the rest.

Particle–hole symmetry, G(−ω*) = −C G(ω)* C, pairs a pole z, v with −z*, C v*: only those with
Re z ≥ 0 are worked out.
"""

from __future__ import annotations

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.dressing import ENDS, Leads, Levels
from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.inverse_iteration import FAINT, Batch, Poles, iterate
from disorder_landscape.physics.jacobi import diagonalise_nearly
from disorder_landscape.physics.levels import invert
from disorder_landscape.physics.parameters import FloatArray

NEAR = 1.15
"""Levels up to so many windows are poles."""
INVISIBLE = 1e-10
"""Levels of less coupling t'|u|² (meV) carry no conductance."""
CENTRAL = 1e-7
"""Poles with |Re z| below this (meV) are their own mirror images."""
CENTRE = 1e-3
"""Starting values this near the imaginary axis (meV) may end on it, from either side."""
ASIDE = 0.1
"""Starting values on the axis are moved off it by this part of their width, to either side."""
EQUAL = 1e-4
"""Poles nearer than this part of their width are one, of two vectors."""


@nb.njit(cache=True)
def cubic_at(terms: ComplexArray, z: complex, out: ComplexArray) -> None:  # pragma: no cover
    """Write a cubic of `Leads` at one energy as an 8×8 matrix."""
    out[:] = 0.0
    for end in range(2):
        for i in range(4):
            for j in range(4):
                value = terms[3, end, i, j]
                for power in range(2, -1, -1):
                    value = value * z + terms[power, end, i, j]
                out[ENDS[end, i], ENDS[end, j]] = value


@nb.njit(cache=True, error_model="numpy")
def _near_levels(
    E: FloatArray, weight: FloatArray, limit: float, hop: float
) -> NDArray[np.int64]:  # pragma: no cover
    """Return which levels below the limit carry conductance."""
    near = np.empty(E.size, dtype=np.int64)
    count = 0
    for n in range(E.size):
        coupling = 0.0
        for i in range(weight.shape[1]):
            coupling += weight[n, i] ** 2
        if E[n] < limit and hop * coupling > INVISIBLE:
            near[count] = n
            count += 1
    return near[:count]


@nb.njit(cache=True, error_model="numpy")
def _dressed_leads(
    omega: float,
    G: FloatArray,
    E: FloatArray,
    weight: FloatArray,
    near: NDArray[np.int64],
    leads: Leads,
) -> ComplexArray:  # pragma: no cover
    """Return (S − G_bg)⁻¹ at ω, G_bg what levels other than the near ones leave of G."""
    out = np.empty((8, 8), dtype=np.complex128)
    cubic_at(leads.inverse, complex(omega), out)
    rest = G.copy()
    size = G.shape[0]
    for n in near:
        common = 1.0 / (omega * omega - E[n] ** 2)
        w, even, odd = weight[n], omega * common, E[n] * common
        for i in range(size):
            same, other = (even * w[i], odd * w[i]) if i < 4 else (odd * w[i], even * w[i])
            for j in range(4):
                rest[i, j] -= same * w[j]
                rest[i, 4 + j] -= other * w[4 + j]
    for i in range(size):
        for j in range(size):
            out[i, j] -= rest[i, j]
    invert(out)
    return out


@nb.njit(cache=True, error_model="numpy")
def _mix_near_levels(
    E: FloatArray,
    weight: FloatArray,
    near: NDArray[np.int64],
    dressed: ComplexArray,
    re: FloatArray,
    im: FloatArray,
) -> None:  # pragma: no cover
    """Write the Hamiltonian of the near levels +E, then −E, with the part of Σ̃ without slope.

    Between the chiralities Σ̃(−ω) = Σ̃(ω)*, within them −Σ̃(ω)*: the real part of the one and the
    imaginary part of the other have no slope at ω = 0.
    """
    count = near.size
    columns, pushed = np.empty((8, count)), np.empty((8, count))
    for k in range(count):
        for i in range(8):
            columns[i, k] = np.sqrt(0.5) * weight[near[k], i]
    within, between = np.zeros((2, count)), np.zeros((2, count))
    for k in range(count):
        for i in range(8):  # within: rows 0–3 of C = +, 4–7 of C = −
            pushed[i, k] = 0.0
            for j in range(4):
                at = j if i < 4 else 4 + j
                pushed[i, k] += dressed[i, at].imag * columns[at, k]
    for k in range(count):
        within[:] = 0.0
        between[:] = 0.0
        for i in range(4):
            first, second = pushed[i, k], pushed[4 + i, k]
            for m in range(count):
                within[0, m] += first * columns[i, m]
                within[1, m] += second * columns[4 + i, m]
        for j in range(4):
            first = second = 0.0  # aᵀ_k Z and (Z b_k)ᵀ
            for i in range(4):
                first += columns[i, k] * dressed[i, 4 + j].real
                second += dressed[j, 4 + i].real * columns[4 + i, k]
            for m in range(count):
                between[0, m] += first * columns[4 + j, m]
                between[1, m] += second * columns[j, m]
        for m in range(count):
            even, odd = within[0, m] + within[1, m], within[0, m] - within[1, m]
            im[k, m], im[count + k, count + m] = even, even
            im[k, count + m], im[count + k, m] = odd, odd
            even, odd = between[0, m] + between[1, m], between[1, m] - between[0, m]
            re[k, m], re[count + k, count + m] = even, -even
            re[k, count + m], re[count + k, m] = odd, -odd
        re[k, k] += E[near[k]]
        re[count + k, count + k] -= E[near[k]]


@nb.njit(cache=True, error_model="numpy")
def start_poles(
    omega: float,
    G: FloatArray,
    window: float,
    hop: float,
    E: FloatArray,
    weight: FloatArray,
    leads: Leads,
) -> tuple[Poles, int]:  # pragma: no cover
    """Return approximate poles in the right half plane and close to the imaginary axis.

    From G of the isolated wire at one energy ω. Also returns how many there are in both halves.
    """
    near = _near_levels(E, weight, NEAR * window, hop)
    count, n = near.size, 2 * near.size
    re, im = np.empty((n, n)), np.empty((n, n))
    _mix_near_levels(E, weight, near, _dressed_leads(omega, G, E, weight, near, leads), re, im)
    rows_re, rows_im = np.zeros((n, n)), np.zeros((n, n))
    for k in range(n):
        rows_re[k, k] = 1.0
    diagonalise_nearly(re, im, rows_re, rows_im)
    z, started, centred = np.empty(n, dtype=np.complex128), 0, 0
    chosen = np.empty(n, dtype=np.int64)
    for k in range(n):
        if re[k, k] > -CENTRE:
            z[started] = complex(re[k, k], min(im[k, k], -1e-16))
            if abs(re[k, k]) <= CENTRAL:  # on the axis the iteration would stay on it
                side = 1.0 if centred % 2 == 0 else -1.0
                z[started] += side * ASIDE * abs(im[k, k])
                centred += 1
            chosen[started] = k
            started += 1
    x = np.zeros((started, 4, E.size))
    for p in range(started):
        k = chosen[p]
        for m in range(count):
            x[p, 0, near[m]], x[p, 1, near[m]] = rows_re[k, m], rows_im[k, m]
            x[p, 2, near[m]], x[p, 3, near[m]] = rows_re[k, count + m], rows_im[k, count + m]
    t = np.zeros((started, 8), dtype=np.complex128)
    return Poles(z[:started], x, t, np.ones(started, dtype=np.complex128)), n


@nb.njit(cache=True)
def _product(poles: Poles, leads: Leads, k: int, m: int) -> complex:  # pragma: no cover
    """Return x_kᵀ(1 − H')x_m."""
    x, y = poles.x[k], poles.x[m]
    re = im = 0.0
    for n in range(x.shape[1]):
        re += x[0, n] * y[0, n] - x[1, n] * y[1, n] + x[2, n] * y[2, n] - x[3, n] * y[3, n]
        im += x[0, n] * y[1, n] + x[1, n] * y[0, n] + x[2, n] * y[3, n] + x[3, n] * y[2, n]
    total, z = complex(re, im), poles.z[k]
    for end in range(2):
        for i in range(4):
            for j in range(4):
                slope = leads.inverse[1, end, i, j] + z * (
                    2 * leads.inverse[2, end, i, j] + 3 * z * leads.inverse[3, end, i, j]
                )
                total += poles.t[k, ENDS[end, i]] * slope * poles.t[m, ENDS[end, j]]
    return total


@nb.njit(cache=True)
def _orthogonalise(poles: Poles, leads: Leads, k: int, at: int) -> float:  # pragma: no cover
    """Take vector `at` out of vector k; return how much of it is left, as a share of its square."""
    overlap = _product(poles, leads, k, at) / poles.norm[at]
    before = after = 0.0
    x, y = poles.x[k], poles.x[at]
    for part in range(0, 4, 2):
        for m in range(x.shape[1]):
            own = complex(x[part, m], x[part + 1, m])
            new = own - overlap * complex(y[part, m], y[part + 1, m])
            before += own.real**2 + own.imag**2
            after += new.real**2 + new.imag**2
            x[part, m], x[part + 1, m] = new.real, new.imag
    for i in range(8):
        poles.t[k, i] -= overlap * poles.t[at, i]
    poles.norm[k] = _product(poles, leads, k, k)
    return after / before


@nb.njit(cache=True)
def _reflect(poles: Poles, k: int) -> None:  # pragma: no cover
    """Replace a pole by its mirror image −z*, of C v*: ±E change places, and t turns to −C t*."""
    poles.z[k] = -np.conj(poles.z[k])
    poles.norm[k] = np.conj(poles.norm[k])
    x = poles.x[k]
    for n in range(x.shape[1]):
        x[0, n], x[2, n] = x[2, n], x[0, n]
        x[1, n], x[3, n] = -x[3, n], -x[1, n]
    for i in range(4):
        poles.t[k, i] = -np.conj(poles.t[k, i])
        poles.t[k, 4 + i] = np.conj(poles.t[k, 4 + i])


@nb.njit(cache=True, error_model="numpy")
def right_half(
    poles: Poles, leads: Leads
) -> tuple[NDArray[np.int64], int, int, int]:  # pragma: no cover
    """Return the poles with mirror images, then those that are their own; and how many of the first.

    A pole in the left half stands for its mirror image; one that did not converge is left out: near
    the axis another's image may stand for it. Vectors of equal poles (Kramers pairs at
    B = 0) are made orthogonal; one that is not new is left out: of these also returns the last
    central one, and which it equals, or −1.
    """
    z = poles.z
    order = np.empty(z.size, dtype=np.int64)
    found, paired, again, twin = 0, 0, -1, -1
    for central in range(2):
        for k in range(z.size):
            if (abs(z[k].real) <= CENTRAL) != (central == 1) or np.isnan(poles.norm[k]):
                continue
            if z[k].real < -CENTRAL:
                _reflect(poles, k)
            kept = 1.0
            for m in range(found):
                at = order[m]
                faint = abs(z[k].imag) < FAINT  # it may stand twice: it carries nothing
                if not faint and abs(z[at] - z[k]) < EQUAL * abs(z[k].imag):
                    kept = min(kept, _orthogonalise(poles, leads, k, at))
                    if central == 1 and not kept > 0.1:
                        again, twin = k, at
            if kept > 0.1:
                order[found] = k
                found += 1
        if central == 0:
            paired = found
    return order[:found], paired, again, twin


@nb.njit(cache=True, error_model="numpy")
def find_poles(
    start: Poles, both: int, levels: Levels, leads: Leads, b: Batch
) -> tuple[Poles, NDArray[np.int64], int]:  # pragma: no cover
    """Iterate the poles of `start_poles`; return them, their order, and how many have images.

    Where two starts have ended at one pole of the imaginary axis, the other one is looked for on
    either side of it. The order is empty if a pole was lost, or met twice.
    """
    poles = Poles(start.z.copy(), start.x.copy(), start.t, start.norm)
    iterate(poles, np.arange(start.z.size), levels, leads, b)
    order, paired, again, twin = right_half(poles, leads)
    for side in (1.0 - ASIDE, 1.0 + ASIDE):
        if again >= 0 and paired + order.size == both - 1:
            poles.z[again] = poles.z[twin] * side
            poles.x[again], poles.t[again] = start.x[again], 0.0
            _orthogonalise(poles, leads, again, twin)
            iterate(poles, np.full(1, again), levels, leads, b)
            order, paired, again, twin = right_half(poles, leads)
    if paired + order.size != both:
        return poles, order[:0], 0
    return poles, order, paired
