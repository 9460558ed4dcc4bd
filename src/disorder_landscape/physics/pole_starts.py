"""Where the poles of the wire with its leads are looked for.

The levels near the window with the self-energy that the leads and the far levels make of them,
UᵀΣ(1 − G_bg Σ)⁻¹U = Uᵀ(S − G_bg)⁻¹U at one energy, its strongest mixings rotated away (`jacobi`).
Only poles with Re z ≥ 0 are wanted, see `resonances`.
"""

from __future__ import annotations

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.dressing import ENDS, Leads
from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.inverse_iteration import Poles
from disorder_landscape.physics.jacobi import diagonalise_nearly
from disorder_landscape.physics.levels import invert
from disorder_landscape.physics.parameters import FloatArray

NEAR = 1.15
"""Levels up to so many windows are poles."""
INVISIBLE = 1e-10
"""Levels of less coupling t'|u|² (meV) carry no conductance."""
ON_AXIS = 1e-7
"""Starting values with |Re z| below this (meV) would stay on the imaginary axis."""
CENTRE = 1e-3
"""Starting values this near the imaginary axis (meV) may end on it, from either side."""
ASIDE = 0.1
"""Starting values on the axis are moved off it by this part of their width, to either side."""


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
            if abs(re[k, k]) <= ON_AXIS:  # on the axis the iteration would stay on it
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
