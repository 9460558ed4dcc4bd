"""The parent superconductor at any energy, and dissipation: −iΓ on each site.

Above the gap √(Δ₀²−ω²) becomes −i sgn(ω)√(ω²−Δ₀²), the retarded branch.
"""

from __future__ import annotations

import numpy as np

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray, Nanowire


def retarded_pairing_factors(
    wire: Nanowire, omega: FloatArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return γω/√(Δ₀²−ω²) + iΓ and γΔ₀/√(Δ₀²−ω²) in meV, ω ≠ ±Δ₀, on the retarded branch."""
    root = np.sqrt(abs(wire.delta0**2 - omega**2)).astype(np.complex128)
    root[abs(omega) > wire.delta0] *= -1j
    root[omega < -wire.delta0] *= -1
    return wire.gamma * omega / root + 1j * wire.dissipation, wire.gamma * wire.delta0 / root
