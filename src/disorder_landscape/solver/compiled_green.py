"""Green's functions and self-energies that the compiled core calculates, of wires and arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from disorder_landscape.model.hamiltonian import ComplexArray
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.solver import compiled


def isolated_ends(
    wires: Sequence[Nanowire], mu: FloatArray, B: FloatArray, z: ComplexArray, theta: float
) -> ComplexArray:
    """Return G of the ends of the wires without leads in a field at the angle θ, in 1/meV.

    In the rotated frame, left end first, at energies z with |Re z| < Δ₀ and Im z > 0; without
    the wires' dissipation.

    Returns
    -------
    array, shape (wire, B, mu, z, 8, 8)
    """
    x, y = np.ascontiguousarray(z.real), np.ascontiguousarray(z.imag)
    G: ComplexArray = compiled.core.isolated_ends(*compiled.handed_over(wires), mu, B, x, y, theta)
    return G


def local_green(
    wire: Nanowire,
    mu: FloatArray,
    B: FloatArray,
    z: ComplexArray,
    sigma: ComplexArray,
    theta: float = 0.0,
) -> tuple[ComplexArray, FloatArray]:
    """Return the Green's function of a wire with leads on each site, summed over the spin.

    Parameters
    ----------
    wire : Nanowire
    mu, B : array
    z : array, shape (z,)
        Energies with Im z ≥ 0, none of them ±Δ₀, in meV.
    sigma : array, shape (B, z, lead, charge, 2, 2)
        Self-energies of the leads, spin not rotated, in meV.
    theta : float

    Returns
    -------
    array, shape (mu, B, z, site, 2)
        Traces over the spin of electrons and of holes, in 1/meV.
    array, shape (mu, B, z)
        The largest inverse pivot, in units of 1/t': about as many ulps are lost.
    """
    x, y = np.ascontiguousarray(z.real), np.ascontiguousarray(z.imag)
    turned = np.ascontiguousarray(in_rotated_frame(wire, sigma) / wire.rotated_hopping)
    G, growth = compiled.core.local_green(*compiled.handed_over([wire]), mu, B, x, y, turned, theta)
    return G, growth


def lead_self_energies(
    wire: Nanowire, B: float, omega: FloatArray, theta: float = 0.0
) -> ComplexArray:
    """Return Σ of the leads, shape (energy, lead, charge, 2, 2), in meV, spin not rotated."""
    sigma: ComplexArray = compiled.core.lead_self_energies(
        *compiled.handed_over([wire]), B, omega, theta
    )
    return sigma


def in_rotated_frame(wire: Nanowire, sigma: ComplexArray) -> ComplexArray:
    """Return self-energies of the leads as the core attaches them, (..., lead, charge, 2, 2).

    There the spin turns from site to site, by U_n = exp(−iσyφn), tan φ = α/2at
    (core/wire/elimination.hpp): the left lead's is as it was, the right lead's becomes U†ΣU.
    """
    angle = np.arctan2(wire.spin_orbit_hopping, wire.hopping) * (wire.sites - 1)
    U = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turned = sigma.copy()
    turned[..., 1, :, :, :] = U.T @ sigma[..., 1, :, :, :] @ U
    return turned
