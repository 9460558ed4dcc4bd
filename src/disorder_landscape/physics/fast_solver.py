"""What the kernels at finite temperature need to know of all wires, fields and pairs (μ, ω)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numba as nb
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.hamiltonian import ComplexArray, pairing_factors
from disorder_landscape.physics.leads import lead_self_energies, rotate_spin
from disorder_landscape.physics.parameters import FloatArray, Nanowire
from disorder_landscape.physics.recursion import (
    ANOMALOUS,
    KINETIC,
    LANES,
    NORMAL,
)

GROWTH_LIMIT = 1e7
"""Largest inverse pivot, or product of couplings, (in units of t') up to which real elimination is
trusted: see `recursion.LOOK_EVERY`."""


PairingFactors = Callable[[Nanowire, Any], tuple[Any, Any]]
"""What `hamiltonian.pairing_factors` is, real or complex."""
LeadSelfEnergies = Callable[[Nanowire, float, Any], ComplexArray]
"""What `leads.lead_self_energies` is, at any angle of the field."""


class Problem(NamedTuple):
    """What the kernels need, in units of each wire's t' = √(t² + (α/2a)²)."""

    V: FloatArray  # (wire, site), with barriers
    zeeman_x: FloatArray  # (wire, B, site), V_Z cos 2φn
    zeeman_z: FloatArray  # (wire, B, site), V_Z sin 2φn
    kinetic: FloatArray  # (wire, mu), 2t − μ
    normal: FloatArray | ComplexArray  # (wire, omega), ω + γω/√(Δ₀²−ω²), real below the gap
    anomalous: FloatArray | ComplexArray  # (wire, omega), γΔ₀/√(Δ₀²−ω²)
    sigma: ComplexArray  # (wire, B, omega, lead, charge, 2, 2), in the rotated frame


def prepare(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray | ComplexArray,
    factors: PairingFactors = pairing_factors,
    leads: LeadSelfEnergies = lead_self_energies,
) -> Problem:
    """Return the terms of all wires, with Σ(ω) of the parent superconductor from `factors`."""
    sites = wires[0].sites
    hop = np.array([w.rotated_hopping for w in wires])
    angle = np.array([np.arctan2(w.spin_orbit_hopping, w.hopping) for w in wires])
    zeeman = np.outer([w.zeeman_per_tesla for w in wires] / hop, B)[:, :, None]
    phases = 2 * angle[:, None, None] * np.arange(sites)
    pairing = np.array([factors(w, omega) for w in wires])
    sigma = np.array([[leads(w, field, omega) for field in B] for w in wires])
    for of_wire, phi in zip(sigma, angle, strict=True):
        for of_field in of_wire:
            rotate_spin(of_field, phi * (sites - 1))
    return Problem(
        V=np.array([w.potential_with_barriers for w in wires]) / hop[:, None],
        zeeman_x=zeeman * np.cos(phases),
        zeeman_z=zeeman * np.sin(phases),
        kinetic=(2 * np.array([[w.hopping] for w in wires]) - mu) / hop[:, None],
        normal=(omega + pairing[:, 0]) / hop[:, None],
        anomalous=pairing[:, 1] / hop[:, None],
        sigma=sigma / hop.reshape(-1, *[1] * 6),
    )


@nb.njit(cache=True)
def load_lanes(
    p: Problem, w: int, mu: NDArray[np.int64], energy: NDArray[np.int64], s: FloatArray
) -> None:  # pragma: no cover
    """Write the terms of wire w for the lanes' pairs (μ, ω), given by their indices."""
    for l in range(LANES):
        s[KINETIC * LANES + l] = p.kinetic[w, mu[l]]
        s[NORMAL * LANES + l] = p.normal[w, energy[l]]
        s[ANOMALOUS * LANES + l] = p.anomalous[w, energy[l]]
