"""Self-energies of the normal leads in closed form.

A lead's electron block is H(k) = ε(k) + V_Zσx + 2s sin k σy with ε = 2t − μ_lead − 2t cos k and
s = α/2a. At energy E its modes λ = e^{ik} follow from a quadratic equation in c = cos k,

    (E' + 2tc)² = V_Z² + 4s²(1 − c²),   E' = E − 2t + μ_lead,

with spinor (m, V_Z + 2is sin k), m = E' + 2tc. Of each pair λ, 1/λ the outgoing one is taken: the
decaying one, or the one whose group velocity sin k (2t + 4s²c/m) points outwards. With
F = Σ λ |u⟩⟨ũ| the right lead's self-energy is (hopping)·F. The rest is symmetry:

- mirror: the left lead's self-energy is σx Σ σx;
- particle–hole: the hole block at E is −σy Σ(−E)* σy, where Σ is the electron block.

Each block is complex symmetric, as the lead's Hamiltonian is real.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray, Nanowire


@nb.njit(cache=True)
def _outgoing_mode(
    c: complex, E: float, t: float, s: float, zeeman: float, branch: float
) -> tuple[complex, complex, complex]:  # pragma: no cover
    """Return λ and the spinor of the outgoing mode with cos k = c on the given spin branch."""
    m = E + 2 * t * c
    if abs(m) < 1e-9 * t:  # a spin-degenerate point: the branch has to be told
        m = branch * np.sqrt(zeeman**2 + 4 * s**2 * (1 - c**2) + 0j)
    root = np.sqrt(c * c - 1)
    if abs(c.imag) < 1e-14 and abs(c.real) < 1:
        velocity = 2 * t + (4 * s**2 * c.real / m.real if m != 0 else 0.0)
        lam = complex(c.real, np.copysign(np.sqrt(1 - c.real**2), velocity))
    else:
        lam = c + root if abs(c + root) < abs(c - root) else c - root
    two_i_sin = lam - 1 / lam
    up, down = m, zeeman + s * two_i_sin
    if abs(up) + abs(down) < 1e-13 * t:  # no field and no spin–orbit coupling: any spin will do
        up, down = (1 + 0j, 0j) if branch > 0 else (0j, 1 + 0j)
    return lam, up, down


@nb.njit(cache=True)
def electron_self_energy(
    E: float, t: float, s: float, zeeman: float, lead_mu: float, out: ComplexArray
) -> None:  # pragma: no cover
    """Write the right lead's electron block at energy E into out, shape (2, 2), in meV."""
    shifted = E - 2 * t + lead_mu
    quadratic, linear = 4 * (t**2 + s**2), 4 * t * shifted
    constant = shifted**2 - zeeman**2 - 4 * s**2
    discriminant = linear**2 - 4 * quadratic * constant
    if abs(discriminant) < 1e-13 * linear**2:  # rounding alone would make the two roots complex
        discriminant = 0.0
    root = np.sqrt(complex(discriminant))
    c_minus, c_plus = (-linear - root) / (2 * quadratic), (-linear + root) / (2 * quadratic)
    l0, u0, d0 = _outgoing_mode(c_minus, shifted, t, s, zeeman, -1.0)
    l1, u1, d1 = _outgoing_mode(c_plus, shifted, t, s, zeeman, 1.0)
    det = u0 * d1 - u1 * d0
    f00, f01 = (l0 * u0 * d1 - l1 * u1 * d0) / det, (l1 - l0) * u0 * u1 / det
    f10, f11 = (l0 - l1) * d0 * d1 / det, (l1 * u0 * d1 - l0 * u1 * d0) / det
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
