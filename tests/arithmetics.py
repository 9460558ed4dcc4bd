"""Conductances in an arithmetic that the solver would not choose, to compare them."""

import numpy as np

from disorder_landscape.solver import compiled
from disorder_landscape.solver.compiled import GROWTH_LIMIT, handed_over


def complex_conductance(wires, mu, B, omega, growth_limit=GROWTH_LIMIT):
    """Return the bare conductances in complex numbers at all energies."""
    internals = compiled.core.internals
    arrays = (np.ascontiguousarray(x, dtype=float) for x in (mu, B, omega))
    return internals.complex_conductance(*handed_over(wires), *arrays, 0.0, growth_limit)


def tilted_conductance(wires, mu, B, omega, theta, growth_limit=GROWTH_LIMIT):
    """Return the bare conductances as in a tilted field, at whatever angle."""
    internals = compiled.core.internals
    arrays = (np.ascontiguousarray(x, dtype=float) for x in (mu, B, omega))
    return internals.tilted_conductance(*handed_over(wires), *arrays, theta, growth_limit)
