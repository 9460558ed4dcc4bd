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


@nb.njit(cache=True)
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
    Z = np.empty((8, 2), dtype=np.complex128)
    for k in range(4):
        lead = 0 if k == 0 or k == 3 else 1
        a = 2 * lead + hole
        gamma_a = -2 * sigma[lead, hole].imag
        answer[k] = 0.0
        for b in range(4):
            same_lead, same_charge = b // 2 == lead, b % 2 == hole
            c = 0.0 if same_charge else 2.0
            if not same_lead:
                c = 1.0 if same_charge or k < 2 else -1.0
            elif k >= 2:
                c = 0.0
            gamma_b = -2 * sigma[b // 2, b % 2].imag
            g = np.ascontiguousarray(G[2 * a : 2 * a + 2, 2 * b : 2 * b + 2])
            for i in range(2):
                for j in range(2):
                    T[k, i, 2 * b + j] = 0.0
                    for p in range(2):
                        for q in range(2):
                            weight = c * gamma_a[i, p] * gamma_b[q, j]
                            T[k, i, 2 * b + j] += weight * np.conj(g[p, q])
            for d in range(2):
                slope_a = -2 * slopes[d, lead, hole].imag
                slope_b = -2 * slopes[d, b // 2, b % 2].imag
                for i in range(2):
                    for j in range(2):
                        for p in range(2):
                            for q in range(2):
                                weight = slope_a[i, p] * gamma_b[q, j]
                                weight += gamma_a[i, p] * slope_b[q, j]
                                answer[k, d] += (c * weight * np.conj(g[p, q]) * g[i, j]).real
        for p in range(8):
            for i in range(2):
                total = 0j
                for j in range(8):
                    total += G[p, j] * T[k, i, j]
                Z[p, i] = total
        for p in range(8):
            for q in range(8):
                Y[k, p, q] = Z[p, 0] * G[2 * a, q] + Z[p, 1] * G[2 * a + 1, q]
        for d in range(2):
            for b in range(4):
                for i in range(2):
                    for j in range(2):
                        slope = slopes[d, b // 2, b % 2, j, i]
                        answer[k, d] += 2 * (Y[k, 2 * b + i, 2 * b + j] * slope).real


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
