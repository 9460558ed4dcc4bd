"""How the leads' self-energies change with their Zeeman energy and with α."""

from __future__ import annotations

import numpy as np

from disorder_landscape.model.hamiltonian import PAULI, ComplexArray
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.solver.compiled_green import in_rotated_frame, lead_self_energies


def lead_slopes(
    wire: Nanowire, B: FloatArray, omega: FloatArray, sigma: ComplexArray
) -> ComplexArray:
    """Return the derivatives of the leads' self-energies by their V_Z and by the wire's α.

    Σ = h g hᵀ with g = (E − H₀ − Σ)⁻¹, h the hopping towards the wire and H₀ the onsite term of the
    lead, so dΣ − K dΣ Kᵀ = dh g hᵀ + h g dhᵀ + K dH₀ Kᵀ with K = h g: four linear equations.

    Parameters
    ----------
    wire : Nanowire
    B : array, shape (B,)
        Fields in T.
    omega : array, shape (energy,)
        Energies in meV.
    sigma : array, shape (B, energy, lead, charge, 2, 2)
        What `compiled_green.lead_self_energies` gives for them, in meV.

    Returns
    -------
    array, shape (B, energy, 2, lead, charge, 2, 2)
        Without a unit and in 1/nm. Zero for α if the leads have their own, `lead_alpha`.
    """
    t, s = wire.hopping, wire.lead_spin_orbit_hopping
    ds = 1 / (2 * wire.lattice) if wire.lead_alpha is None else 0.0
    unit, sigma_x, i_sigma_y = np.eye(2), PAULI["x"].real, (1j * PAULI["y"]).real
    zeeman = wire.lead_zeeman_per_tesla * B[:, None, None, None] * sigma_x
    shape = B.size, omega.size
    slopes = np.empty((*shape, 2, 2, 2, 2, 2), dtype=np.complex128)
    for charge, sign in enumerate((1, -1)):
        h, dh = -sign * (t * unit + s * i_sigma_y), -sign * ds * i_sigma_y
        onsite = sign * (2 * t - wire.lead_mu) * unit + zeeman
        right = sigma[:, :, 1, charge]
        K = h @ np.linalg.inv(omega[:, None, None] * unit - onsite - right)
        transposed = K.swapaxes(2, 3)
        by_zeeman = K @ sigma_x @ transposed
        by_alpha = dh @ transposed + K @ dh.T
        kron = np.einsum("...ij,...kl->...ikjl", K, K).reshape(*shape, 4, 4)
        sources = np.stack([by_zeeman.reshape(*shape, 4), by_alpha.reshape(*shape, 4)], axis=-1)
        solved = np.linalg.solve(np.eye(4) - kron, sources).swapaxes(2, 3)
        slopes[:, :, :, 1, charge] = solved.reshape(*shape, 2, 2, 2)
        slopes[:, :, :, 0, charge] = slopes[:, :, :, 1, charge, ::-1, ::-1]  # σx Σ σx, the mirror
    return slopes


def rotated_lead_slopes(wire: Nanowire, B: FloatArray, omega: FloatArray) -> ComplexArray:
    """Return the derivatives of Σ/t' in the wire's rotated frame (core/wire/elimination.hpp).

    There the right lead's spin is turned by φ(N − 1), tan φ = s/t, s = α/2a, and α changes the turn
    and t' = √(t² + s²), too.

    Returns
    -------
    array, shape (B, omega, 2, lead, charge, 2, 2)
        With respect to the leads' V_Z and to α, in 1/meV and 1/(meV nm).
    """
    t, s, ds = wire.hopping, wire.spin_orbit_hopping, 1 / (2 * wire.lattice)
    hop, end = wire.rotated_hopping, wire.sites - 1
    sigma = np.array([lead_self_energies(wire, field, omega) for field in B])
    slopes = lead_slopes(wire, B, omega, sigma)
    i_sigma_y = np.array([[0.0, 1.0], [-1.0, 0.0]])
    sigma, slopes = in_rotated_frame(wire, sigma), in_rotated_frame(wire, slopes)
    turned = i_sigma_y @ sigma[:, :, 1] - sigma[:, :, 1] @ i_sigma_y
    slopes[:, :, 1, 1] += t * ds / hop**2 * end * turned
    slopes[:, :, 1] -= s * ds / hop**2 * sigma
    slopes /= hop
    return slopes
