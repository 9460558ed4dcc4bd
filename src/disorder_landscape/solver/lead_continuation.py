"""The leads' self-energies at complex energies, where closed forms of their modes do not serve."""

from __future__ import annotations

import numpy as np

from disorder_landscape.model.hamiltonian import ComplexArray, lead_hopping, lead_onsite
from disorder_landscape.model.parameters import Nanowire

HALVINGS = 60
"""Decimation doubles the length of the lead so often at most; 2⁶⁰ cells suffice for any Im z."""


def continued_self_energies(
    wire: Nanowire, B: float, z: ComplexArray, theta: float = 0.0
) -> ComplexArray:
    """Return Σ of both leads at energies z with Im z > 0, shape (z, lead, charge, 2, 2), in meV.

    By decimation (Lopez Sancho, Lopez Sancho and Rubio 1985): every second cell is eliminated until
    what couples the rest has died out, as it does off the real axis.
    """
    sigma = np.empty((z.size, 2, 2, 2, 2), dtype=complex)
    energy = z[:, None, None] * np.eye(2)
    for charge in range(2):
        own = slice(2 * charge, 2 * charge + 2)
        onsite, hopping = (of[own, own] for of in (lead_onsite(wire, B, theta), lead_hopping(wire)))
        for lead, outward in enumerate((hopping.conj().T, hopping)):  # to the next cell of the lead
            away = np.broadcast_to(outward, energy.shape)
            back = np.broadcast_to(outward.conj().T, energy.shape)
            surface = bulk = energy - onsite
            for _ in range(HALVINGS):
                through, through_back = np.linalg.solve(bulk, away), np.linalg.solve(bulk, back)
                surface = surface - away @ through_back
                bulk = bulk - away @ through_back - back @ through
                away, back = away @ through, back @ through_back
                if abs(away).max() < np.finfo(float).eps * abs(outward).max():
                    break
            sigma[:, lead, charge] = outward @ np.linalg.solve(surface, outward.conj().T[None])
    return sigma
