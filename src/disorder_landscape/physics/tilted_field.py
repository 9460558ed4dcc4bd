"""Conductances and T_IV in a field that is tilted by θ against the wire, at any energy.

The σy term makes M complex: its transpose is M at −θ, so neither M nor the leads' self-energies are
symmetric, and probabilities from one end to the other and back differ. Particle–hole symmetry holds
at any θ. θ is in radians; the compiled core
(core/wire/elimination.hpp, core/leads/tilted.hpp) does the work.
"""

from __future__ import annotations

from collections.abc import Sequence

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray, Nanowire
from disorder_landscape.solver import compiled
from disorder_landscape.solver.compiled import GROWTH_LIMIT


def bare_conductance(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    theta: float,
    growth_limit: float = GROWTH_LIMIT,
) -> FloatArray:
    """Return the T = 0 conductances at ±ω, shape (wire, mu, B, omega, 2, 4), in e²/h.

    As `compiled.complex_conductance`, ω ≠ ±Δ₀, in a field at the angle θ.
    """
    return compiled.tilted_conductance(wires, mu, B, omega, theta, growth_limit)


def reflection_determinant(
    wires: Sequence[Nanowire], mu: FloatArray, B: FloatArray, theta: float
) -> FloatArray:
    """Return det r at ω = 0 of both ends, shape (wire, lead, mu, B), as in `compiled`."""
    return compiled.tilted_determinant(wires, mu, B, theta)


def isolated_green_functions(
    wires: Sequence[Nanowire], mu: FloatArray, B: FloatArray, z: ComplexArray, theta: float
) -> ComplexArray:
    """Return G of the ends of the wires without leads, shape (wire, B, mu, z, 8, 8), in 1/meV.

    In the rotated frame, left end first, at energies z with |Re z| < Δ₀ and Im z > 0, where no
    pivot can vanish.
    """
    return compiled.tilted_isolated_ends(wires, mu, B, z, theta)
