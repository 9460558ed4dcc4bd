"""At which energies a set is solved, and what follows from them for all sets alike."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.physics.dressing import CUBIC
from disorder_landscape.physics.parameters import FloatArray, Nanowire
from disorder_landscape.physics.thermal_poles import (
    REACH,
    chebyshev_nodes,
    interpolation_weights,
    thermal_node_weights,
)

CHECKS = 4
"""Energies, the same for all sets, at which the model is compared with the solver."""
SOUGHT = 2
"""Further ones, each set's own: where its levels are densest (`dense_levels`)."""
COMPARED = CHECKS + SOUGHT
LOWEST = 0.2
"""The lowest of them, where the nodes are at k + ½ and zero is 0: below all nodes, where levels lie
that the nodes hardly see. (Without it 13 of 96,000 sets were off by more than 10⁻⁴ e²/h.)"""


class EnergyPlan(NamedTuple):
    """What the kernels need to know of the energies."""

    nodes: int
    window: float  # W in meV
    omega: FloatArray  # (node + CHECKS,) in meV
    signed: FloatArray  # nodes, −nodes, checks, −checks
    picks: NDArray[np.int64]  # (CUBIC,) nodes through which Σ is interpolated
    cubic: FloatArray  # (CUBIC, CUBIC), inverse of their Vandermonde matrix
    weights: FloatArray  # (bias, 2 · node), of the smooth part's values at ω_k, then −ω_k
    at_checks: FloatArray  # (2 · CHECKS, 2 · node), of the same for its values at the checks
    bias: FloatArray  # (bias,)
    kT: float
    slopes: FloatArray  # (wire, 2, node + CHECKS): of the normal and anomalous terms
    hop: FloatArray  # (wire,)
    parent: FloatArray  # (wire, 2), γ and Δ₀ in meV
    leads: FloatArray  # (wire, 4), hopping, α/2a, V_Z/B and μ of the leads
    turn: FloatArray  # (wire,), by which the rotated frame is turned at the right end
    B: FloatArray  # (B,)


def energy_plan(
    wires: Sequence[Nanowire], B: FloatArray, bias: FloatArray, kT: float, nodes: int
) -> EnergyPlan:
    """Plan the energies for these wires and biases with `nodes` nodes and CHECKS checks."""
    window = abs(bias).max() + REACH * kT
    between = np.append(LOWEST, np.arange(1, CHECKS) * (nodes - 1) // CHECKS)
    theta = np.pi * between / (2 * nodes)
    omega = np.concatenate([chebyshev_nodes(window, nodes), window * np.sin(theta)])
    at_nodes, checks = omega[:nodes], omega[nodes:]
    signed = np.concatenate([at_nodes, -at_nodes, checks, -checks])
    picks = ((np.arange(CUBIC) + 0.5) * nodes / CUBIC).astype(np.int64)
    slopes = np.empty((len(wires), 2, omega.size))
    hop = np.array([w.rotated_hopping for w in wires])
    for wire, slope, t in zip(wires, slopes, hop, strict=True):
        root = np.sqrt(wire.delta0**2 - omega**2)
        slope[0] = (1 + wire.gamma / root + wire.gamma * omega**2 / root**3) / t
        slope[1] = wire.gamma * wire.delta0 * omega / root**3 / t
    return EnergyPlan(
        nodes=nodes,
        window=window,
        omega=omega,
        signed=signed,
        picks=picks,
        cubic=np.linalg.inv(np.vander(omega[picks], CUBIC, increasing=True)),
        weights=thermal_node_weights(bias, kT, window, nodes),
        at_checks=interpolation_weights(signed[2 * nodes :] / window, nodes),
        bias=bias,
        kT=kT,
        slopes=slopes,
        hop=hop,
        parent=np.array([(w.gamma, w.delta0) for w in wires]),
        leads=np.array(
            [
                (w.hopping, w.lead_spin_orbit_hopping, w.lead_zeeman_per_tesla, w.lead_mu)
                for w in wires
            ]
        ),
        turn=np.array([np.arctan2(w.spin_orbit_hopping, w.hopping) * (w.sites - 1) for w in wires]),
        B=B,
    )
