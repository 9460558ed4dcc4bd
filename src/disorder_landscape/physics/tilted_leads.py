"""Self-energies of the normal leads in a field that is tilted by θ against the wire.

How they follow from the leads' modes is in core/leads/tilted.hpp.
"""

from __future__ import annotations

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray, Nanowire
from disorder_landscape.solver import compiled


def tilted_lead_self_energies(
    wire: Nanowire, B: float, omega: FloatArray, theta: float
) -> ComplexArray:
    """Return the self-energies of the leads.

    Parameters
    ----------
    wire : Nanowire
    B : float
        Field in T.
    omega : array, shape (energy,)
        Energies in meV.
    theta : float
        Angle of the field in radians.

    Returns
    -------
    array, shape (energy, lead, charge, 2, 2)
        In meV; lead = L, R, charge = electron, hole, then spin.
    """
    return compiled.lead_self_energies(wire, B, omega, theta)
