"""How the conductances answer to a change at the ends: of the wire's end blocks, and of the leads.

With G = (M' − Σ)⁻¹ and p_ab = Tr[Γ_a G_ab Γ_b G_ab†] (`ends`), F = Σ_b c_b p_ab is any of the four
conductances for one channel set a of incident particles. As dG = −G (dM' − dΣ) G,

    dF = −2 Re Tr[Y (dM' − dΣ)] + Σ_b c_b (Tr[dΓ_a G_ab Γ_b G_ab†] + Tr[Γ_a G_ab dΓ_b G_ab†]),

Y = G Wᵀ G with W = c_b Γ_a G_ab* Γ_b in the rows a. For real dM' that is Tr[S dM'], S the symmetric
part of −2 Re Y.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.hamiltonian import PAULI, ComplexArray
from disorder_landscape.physics.parameters import FloatArray, Nanowire

_options = {"cache": True, "fastmath": {"contract", "nsz", "reassoc"}, "error_model": "numpy"}


@nb.njit(**_options)
def _share(k: int, same_lead: bool, same_charge: bool) -> float:  # pragma: no cover
    """Return c_b of conductance k for the channel set b that compares so with the incident one."""
    if same_lead:
        return 2.0 if k < 2 and not same_charge else 0.0
    return 1.0 if k < 2 or same_charge else -1.0


@nb.njit(**_options)
def end_responses(
    G: ComplexArray,
    sigma: ComplexArray,
    slopes: ComplexArray,
    hole: int,
    T: ComplexArray,
    Y: ComplexArray,
    answer: FloatArray,
) -> None:  # pragma: no cover
    """Write W and Y of G_LL, G_RR, G_LR, G_RL, and what the leads contribute.

    Parameters
    ----------
    G : array, shape (8, 8)
        Green's function of the two end sites.
    sigma : array, shape (lead, charge, 2, 2)
        Self-energies of the leads.
    slopes : array, shape (2, lead, charge, 2, 2)
        Derivatives of sigma with respect to two parameters.
    hole : int
        1 if holes come in (negative bias), 0 if electrons do.
    T : array, shape (4, 2, 8)
        The rows a of W.
    Y : array, shape (4, 8, 8)
    answer : array, shape (4, 2)
        Derivatives of the four conductances with respect to the two, through the leads alone.
    """
    U, Z = np.empty((2, 8), dtype=np.complex128), np.empty((2, 8), dtype=np.complex128)
    for k in range(4):
        lead = 0 if k == 0 or k == 3 else 1
        a = 2 * (2 * lead + hole)
        by_first, by_second = 0.0, 0.0
        for b in range(4):
            c = _share(k, b // 2 == lead, b % 2 == hole)
            gamma, first = sigma[b // 2, b % 2], slopes[0, b // 2, b % 2]
            second = slopes[1, b // 2, b % 2]
            for j in range(2 * b, 2 * b + 2):
                for i in range(2):
                    U[i, j], Z[i, j] = 0.0, 0.0
                    for q in range(2):
                        U[i, j] -= 2 * c * gamma[q, j % 2].imag * np.conj(G[a + i, 2 * b + q])
                        Z[i, j] -= 2 * c * sigma[lead, hole, i, q].imag * np.conj(G[a + q, j])
            for i in range(2):
                for j in range(2):
                    for q in range(2):
                        weight = (Z[i, 2 * b + q] * G[a + i, 2 * b + j]).real
                        by_first -= 2 * first[q, j].imag * weight
                        by_second -= 2 * second[q, j].imag * weight
        for i in range(2):
            for q in range(2):
                total = 0.0
                for j in range(8):
                    total += (G[a + i, j] * U[q, j]).real
                by_first -= 2 * slopes[0, lead, hole, q, i].imag * total
                by_second -= 2 * slopes[1, lead, hole, q, i].imag * total
        for i in range(2):
            for j in range(8):
                Z[i, j] = 0.0
                T[k, i, j] = 0.0
                for q in range(2):
                    T[k, i, j] -= 2 * sigma[lead, hole, i, q].imag * U[q, j]
        for j in range(8):
            for p in range(8):
                Z[0, p] += T[k, 0, j] * G[j, p]
                Z[1, p] += T[k, 1, j] * G[j, p]
        for p in range(8):
            for q in range(8):
                Y[k, p, q] = Z[0, p] * G[a, q] + Z[1, p] * G[a + 1, q]
        for b in range(4):
            for i in range(2):
                for j in range(2):
                    response = 2 * Y[k, 2 * b + i, 2 * b + j]
                    by_first += (response * slopes[0, b // 2, b % 2, j, i]).real
                    by_second += (response * slopes[1, b // 2, b % 2, j, i]).real
        answer[k, 0], answer[k, 1] = by_first, by_second


def lead_slopes(wire: Nanowire, B: float, omega: FloatArray, sigma: ComplexArray) -> ComplexArray:
    """Return the derivatives of the leads' self-energies with respect to B and to the wire's α.

    Σ = h g hᵀ with g = (E − H₀ − Σ)⁻¹, h the hopping towards the wire and H₀ the onsite term of the
    lead, so dΣ − K dΣ Kᵀ = dh g hᵀ + h g dhᵀ + K dH₀ Kᵀ with K = h g: four linear equations.

    Parameters
    ----------
    wire : Nanowire
    B : float
        Field in T.
    omega : array, shape (energy,)
        Energies in meV.
    sigma : array, shape (energy, lead, charge, 2, 2)
        What `leads.lead_self_energies` gives for them, in meV.

    Returns
    -------
    array, shape (energy, 2, lead, charge, 2, 2)
        In meV/T and 1/nm. Zero for α if the leads have their own, `lead_alpha`.
    """
    t, s = wire.hopping, wire.lead_spin_orbit_hopping
    ds = 1 / (2 * wire.lattice) if wire.lead_alpha is None else 0.0
    unit, sigma_x, i_sigma_y = np.eye(2), PAULI["x"].real, (1j * PAULI["y"]).real
    slopes = np.empty((omega.size, 2, 2, 2, 2, 2), dtype=np.complex128)
    for charge, sign in enumerate((1, -1)):
        h, dh = -sign * (t * unit + s * i_sigma_y), -sign * ds * i_sigma_y
        onsite = sign * (2 * t - wire.lead_mu) * unit + wire.lead_zeeman_per_tesla * B * sigma_x
        right = sigma[:, 1, charge]
        K = h @ np.linalg.inv(omega[:, None, None] * unit - onsite - right)
        transposed = K.swapaxes(1, 2)
        by_B = wire.lead_zeeman_per_tesla * K @ sigma_x @ transposed
        by_alpha = dh @ transposed + K @ dh.T
        kron = np.einsum("nij,nkl->nikjl", K, K).reshape(-1, 4, 4)
        sources = np.stack([by_B.reshape(-1, 4), by_alpha.reshape(-1, 4)], axis=-1)
        solved = np.linalg.solve(np.eye(4) - kron, sources).swapaxes(1, 2).reshape(-1, 2, 2, 2)
        slopes[:, :, 1, charge] = solved
        slopes[:, :, 0, charge] = solved[..., ::-1, ::-1]  # σx Σ σx, the mirror image
    return slopes
