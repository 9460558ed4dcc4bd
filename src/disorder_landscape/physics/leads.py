"""Self-energies of the normal leads in closed form.

A lead's electron block is H(k) = ε(k) + V_Zσx + 2s sin k σy with ε = 2t − μ_lead − 2t cos k and
s = α/2a. At energy E its modes λ = e^{ik} follow from a quadratic equation in c = cos k,

    m² = V_Z² + 4s²(1 − c²),   m = E' + 2tc,   E' = E − 2t + μ_lead,

with spinor (m, V_Z + w) or, the same, (V_Z − w, m), w = 2is sin k. Without V_Z the spin turns with
the site and Σ is −√(t²+s²) λ for either spin, with the λ of a lead of hopping √(t²+s²).

Near a band edge, or where spins are all but degenerate, differences such as 1 − c and E' + 2tc lose
all digits. So with x = 1 − c, y = 1 + c, E₁ = E + μ_lead, E₂ = E₁ − 4t, t'² = t² + s² and
r² = s²(4s² − E₁E₂) + t'²V_Z²

    x± = (tE₁ + 2s² ± r)/2t'²,    x₊x₋ = (E₁² − V_Z²)/4t'²,
    y∓ = (2s² − tE₂ ∓ r)/2t'²,    y₊y₋ = (E₂² − V_Z²)/4t'²,
    m± = (s²E' ∓ tr)/t'²,         m₊m₋ = (s²E₁E₂ − t²V_Z²)/t'²,

where of two numbers that r sets apart the larger follows from the sum and the other one from the
product, and sin²k = xy. Of each pair λ, 1/λ the outgoing one is taken: the decaying one, or the one
whose group velocity sin k (2t + 4s²c/m) = ∓2 sin k r/m points outwards. With F = Σ λ |u⟩⟨ũ| the
right lead's self-energy is (hopping)·F. The rest is symmetry:

- mirror: the left lead's self-energy is σx Σ σx;
- particle–hole: the hole block at E is −σy Σ(−E)* σy, where Σ is the electron block.

Each block is complex symmetric, as the lead's Hamiltonian is real.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray, Nanowire


@nb.njit(cache=True, error_model="numpy")
def _apart(
    middle: float, r: complex, product: float
) -> tuple[complex, complex]:  # pragma: no cover
    """Return middle + r and middle − r, whose product is given, r ≥ 0 or imaginary."""
    plus, minus = middle + r, middle - r
    if r.imag == 0.0 and r.real > 0.0:
        if middle > 0.0:
            minus = complex(product / plus.real)
        elif middle < 0.0:
            plus = complex(product / minus.real)
    return plus, minus


@nb.njit(cache=True, error_model="numpy")
def _outgoing(
    x: complex, y: complex, forwards: bool
) -> tuple[complex, complex]:  # pragma: no cover
    """Return λ and 2i sin k of the outgoing mode with cos k = 1 − x = y − 1.

    `forwards` tells whether of two propagating modes the one with sin k > 0 is outgoing.
    """
    c = 1.0 - x if abs(x) < abs(y) else y - 1.0
    i_sin = 1j * np.sqrt(x * y)
    if x.imag == 0.0 and x.real >= 0.0 and y.real >= 0.0:
        i_sin = 1j * np.sqrt(x.real * y.real)
        if not forwards:
            i_sin = -i_sin
        return c + i_sin, 2 * i_sin
    if abs(c + i_sin) < abs(c - i_sin):
        return 1.0 / (c - i_sin), 2 * i_sin
    return 1.0 / (c + i_sin), -2 * i_sin


@nb.njit(cache=True, error_model="numpy")
def outgoing_without_field(
    E: float, t: float, s: float, lead_mu: float
) -> complex:  # pragma: no cover
    """Return the right lead's self-energy at V_Z = 0, that of either spin, in meV."""
    hop = np.sqrt(t * t + s * s)
    below = (E + lead_mu + 2 * (hop - t)) / (2 * hop)  # 1 − cos k
    above = (4 * t - E - lead_mu + 2 * (hop - t)) / (2 * hop)
    sigma: complex = -hop * _outgoing(complex(below), complex(above), True)[0]
    return sigma


@nb.njit(cache=True, error_model="numpy")
def electron_self_energy(
    E: float, t: float, s: float, zeeman: float, lead_mu: float, out: ComplexArray
) -> None:  # pragma: no cover
    """Write the right lead's electron block at energy E into out, shape (2, 2), in meV."""
    if zeeman == 0.0:
        out[:] = 0.0
        out[0, 0] = out[1, 1] = outgoing_without_field(E, t, s, lead_mu)
        return
    t2, s2 = t * t, s * s
    hop2 = t2 + s2
    low = E + lead_mu
    high = low - 4 * t
    r = np.sqrt(complex(s2 * (4 * s2 - low * high) + hop2 * zeeman * zeeman))
    around = hop2 * (low - zeeman) * (low + zeeman), hop2 * (high - zeeman) * (high + zeeman)
    x_plus, x_minus = _apart(t * low + 2 * s2, r, around[0])
    y_plus, y_minus = _apart(2 * s2 - t * high, r, around[1])
    product = hop2 * (s2 * low * high - t2 * zeeman * zeeman)
    m_minus, m_plus = _apart(s2 * (low - 2 * t), t * r, product)
    u, d, lam = (
        np.empty(2, dtype=np.complex128),
        np.empty(2, dtype=np.complex128),
        np.empty(2, dtype=np.complex128),
    )
    for k in range(2):
        x, y, m = (x_plus, y_minus, m_plus) if k == 0 else (x_minus, y_plus, m_minus)
        m = m / hop2
        forwards = (m.real < 0.0) == (k == 0)
        lam[k], two_i_sin = _outgoing(x / (2 * hop2), y / (2 * hop2), forwards)
        w = s * two_i_sin
        if abs(zeeman + w) > abs(zeeman - w):
            u[k], d[k] = m, zeeman + w
        else:
            u[k], d[k] = zeeman - w, m
    det = u[0] * d[1] - u[1] * d[0]
    f00 = (lam[0] * u[0] * d[1] - lam[1] * u[1] * d[0]) / det
    f01 = (lam[1] - lam[0]) * u[0] * u[1] / det
    f10 = (lam[0] - lam[1]) * d[0] * d[1] / det
    f11 = (lam[1] * u[0] * d[1] - lam[0] * u[1] * d[0]) / det
    # the hopping −t − is σy is the real matrix [[−t, −s], [s, −t]]
    out[0, 0], out[0, 1] = -t * f00 - s * f10, -t * f01 - s * f11
    out[1, 0], out[1, 1] = s * f00 - t * f10, s * f01 - t * f11


@nb.njit(cache=True)
def fill_self_energies(
    omega: FloatArray, t: float, s: float, zeeman: float, lead_mu: float, out: ComplexArray
) -> None:  # pragma: no cover
    """Write the blocks of both leads into out, shape (energy, lead, charge, 2, 2), in meV."""
    hole = np.empty((2, 2), dtype=np.complex128)
    for k in range(omega.size):
        electron = out[k, 1, 0]
        electron_self_energy(omega[k], t, s, zeeman, lead_mu, electron)
        electron_self_energy(-omega[k], t, s, zeeman, lead_mu, hole)
        for i in range(2):
            for j in range(2):
                sign = -1.0 if i == j else 1.0  # −σy M σy = [[−M11, M10], [M01, −M00]]
                out[k, 1, 1, i, j] = sign * np.conj(hole[1 - i, 1 - j])
        for charge in range(2):
            for i in range(2):
                for j in range(2):
                    out[k, 0, charge, i, j] = out[k, 1, charge, 1 - i, 1 - j]


@nb.njit(cache=True)
def rotate_spin(sigma: ComplexArray, angle: float) -> None:  # pragma: no cover
    """Replace the right lead's blocks by U†ΣU, U = exp(−iσy·angle), in place.

    sigma has shape (energy, lead, charge, 2, 2). In the wire's rotated frame (see `recursion`)
    site n has the angle nφ: 0 where the left lead is attached.
    """
    c, s = np.cos(angle), np.sin(angle)
    for k in range(sigma.shape[0]):
        for charge in range(2):
            b = sigma[k, 1, charge]
            m00, m01 = b[0, 0] * c + b[0, 1] * s, b[0, 1] * c - b[0, 0] * s
            m10, m11 = b[1, 0] * c + b[1, 1] * s, b[1, 1] * c - b[1, 0] * s
            b[0, 0], b[0, 1] = c * m00 + s * m10, c * m01 + s * m11
            b[1, 0], b[1, 1] = c * m10 - s * m00, c * m11 - s * m01


def lead_self_energies(wire: Nanowire, B: float, omega: FloatArray) -> ComplexArray:
    """Return the self-energies of the leads.

    Parameters
    ----------
    wire : Nanowire
    B : float
        Field in T.
    omega : array, shape (energy,)
        Energies in meV.

    Returns
    -------
    array, shape (energy, lead, charge, 2, 2)
        In meV; lead = L, R, charge = electron, hole, then spin.
    """
    out = np.empty((omega.size, 2, 2, 2, 2), dtype=np.complex128)
    fill_self_energies(
        omega,
        wire.hopping,
        wire.lead_spin_orbit_hopping,
        wire.lead_zeeman_per_tesla * B,
        wire.lead_mu,
        out,
    )
    return out
