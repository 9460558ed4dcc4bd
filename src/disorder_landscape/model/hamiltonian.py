"""The Bogoliubov–de Gennes Hamiltonian of the wire, Eq. S1 on a lattice.

Conventions, stated here once
-----------------------------
Basis: (u↑, u↓, −v↓, v↑) on every site, so matrices are τ ⊗ σ with index 2·τ + σ.
Onsite:   (2t − μ + V_i) τz + V_Z (σx cos θ + σy sin θ) + Σ(ω),  Σ(ω) = −γ(ω + Δ₀τx)/√(Δ₀² − ω²).
Hopping from site i+1 to site i:  −t τz − (iα/2a) σy τz.
Particle–hole symmetry: C H(ω)* C = −H(−ω) with C = τy σy.
Charge: electrons have τz = +1; the leads conserve it.
Field:    θ in radians, from the wire (x, θ = 0) to the spin–orbit field (y, θ = π/2), the same in
          wire and leads; θ → π − θ (a rotation by σy) changes nothing, θ → −θ transposes all
          matrices, and with x → −x it is a symmetry (σx).
At θ = 0 all matrices are real for |ω| < Δ₀, the energies of the paper.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.model.parameters import FloatArray, Nanowire

ComplexArray = NDArray[np.complex128]

PAULI: dict[str, ComplexArray] = {
    "0": np.eye(2, dtype=complex),
    "x": np.array([[0, 1], [1, 0]], dtype=complex),
    "y": np.array([[0, -1j], [1j, 0]], dtype=complex),
    "z": np.array([[1, 0], [0, -1]], dtype=complex),
}


BANDS = 7
"""Of the whole matrix on either side of its diagonal."""
FULL_TURN = 2 * np.pi
"""Largest angle θ that is accepted, in radians."""


def tau_sigma(tau: str, sigma: str) -> ComplexArray:
    """Return τ ⊗ σ for two of "0xyz", shape (4, 4)."""
    return np.kron(PAULI[tau], PAULI[sigma]).astype(np.complex128)


TAU_Z = tau_sigma("z", "0")
TAU_X = tau_sigma("x", "0")
SIGMA_X = tau_sigma("0", "x")
SIGMA_Y = tau_sigma("0", "y")
TAU_Z_SIGMA_Y = tau_sigma("z", "y")
PARTICLE_HOLE = tau_sigma("y", "y")


def self_energy(wire: Nanowire, omega: complex) -> ComplexArray:
    """Return Σ(ω) of the parent superconductor, shape (4, 4), in meV.

    |ω| < Δ₀, or Im ω > 0.
    """
    factor = wire.gamma / np.sqrt(wire.delta0**2 - np.asarray(omega) ** 2)
    return np.asarray(-factor * (omega * np.eye(4) + wire.delta0 * TAU_X))


def zeeman(V_Z: float, theta: float) -> ComplexArray:
    """Return V_Z (σx cos θ + σy sin θ), shape (4, 4), in the units of V_Z."""
    return np.asarray(V_Z * (np.cos(theta) * SIGMA_X + np.sin(theta) * SIGMA_Y))


def onsite(
    wire: Nanowire, V: FloatArray, mu: float, B: float, omega: complex, theta: float = 0.0
) -> ComplexArray:
    """Return the onsite terms of sites with the given potentials, shape (site, 4, 4), in meV."""
    kinetic = (2 * wire.hopping - mu + np.asarray(V))[:, None, None] * TAU_Z
    uniform = zeeman(wire.zeeman_per_tesla * B, theta) + self_energy(
        wire, omega + 1j * wire.dissipation_of_parent
    )
    return np.asarray(kinetic + uniform - 1j * wire.dissipation * np.eye(4))


def hopping(wire: Nanowire) -> ComplexArray:
    """Return the hopping from site i+1 to site i, shape (4, 4), in meV."""
    return np.asarray(-wire.hopping * TAU_Z - 1j * wire.spin_orbit_hopping * TAU_Z_SIGMA_Y)


def lead_onsite(wire: Nanowire, B: float, theta: float = 0.0) -> ComplexArray:
    """Return the onsite term of the leads, which have no pairing, shape (4, 4), in meV."""
    kinetic = (2 * wire.hopping - wire.lead_mu) * TAU_Z
    return np.asarray(kinetic + zeeman(wire.lead_zeeman_per_tesla * B, theta))


def lead_hopping(wire: Nanowire) -> ComplexArray:
    """Return the hopping from cell i+1 to cell i of the leads, shape (4, 4), in meV."""
    return np.asarray(-wire.hopping * TAU_Z - 1j * wire.lead_spin_orbit_hopping * TAU_Z_SIGMA_Y)


def wire_hamiltonian(
    wire: Nanowire, mu: float, B: float, omega: complex, theta: float = 0.0
) -> ComplexArray:
    """Return the whole matrix of the isolated wire, shape (4·site, 4·site), for checks."""
    n = wire.sites
    H = np.zeros((n, 4, n, 4), dtype=complex)
    sites = np.arange(n)
    H[sites, :, sites, :] = onsite(wire, wire.potential_with_barriers, mu, B, omega, theta)
    H[sites[:-1], :, sites[1:], :] = hopping(wire)
    H[sites[1:], :, sites[:-1], :] = hopping(wire).conj().T
    return H.reshape(4 * n, 4 * n)


def banded(blocks: ComplexArray, coupling: ComplexArray) -> ComplexArray:
    """Return a block-tridiagonal matrix as solve_banded takes it, shape (2·BANDS + 1, 4·site).

    Parameters
    ----------
    blocks : array, shape (site, 4, 4)
        On the diagonal.
    coupling : array, shape (4, 4)
        From site i+1 to site i; its adjoint couples the other way.
    """
    n = len(blocks)
    band = np.zeros((2 * BANDS + 1, 4 * n), dtype=complex)
    for i in range(4):
        for j in range(4):
            band[BANDS + i - j, j::4] = blocks[:, i, j]
            band[BANDS + i - j - 4, 4 + j :: 4] = coupling[i, j]
            band[BANDS + i - j + 4, j : 4 * (n - 1) : 4] = coupling.conj().T[i, j]
    return band
