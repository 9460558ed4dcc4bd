"""What the compiled core calculates, of wires and arrays.

`core` is its best variant that this CPU can run, or the one that is asked for (`variants`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.machine import cores
from disorder_landscape.model.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.solver.variants import chosen, variant

if TYPE_CHECKING:
    from disorder_landscape.solver import _core_baseline as core

__all__ = [
    "bare_conductance",
    "core",
    "levels",
    "reflection_determinant",
    "thermal_conductance",
    "threads_at_work",
]

if not TYPE_CHECKING:
    core = variant(chosen())
core.set_threads(cores())

GROWTH_LIMIT: float = core.GROWTH_LIMIT
"""Largest inverse pivot, or product of couplings, (in units of t') up to which elimination without
pivoting is trusted: see core/wire/elimination.hpp."""


@contextmanager
def threads_at_work(count: int) -> Iterator[None]:
    """Use so many threads, then as many as before."""
    before = core.set_threads(count)
    try:
        yield
    finally:
        core.set_threads(before)


def handed_over(wires: Sequence[Nanowire]) -> tuple[FloatArray, FloatArray]:
    """Return V with barriers, (wire, site), and the parameters in the order of the core's Wire.

    The same arrays, with their numbers, are what core/c_interface.h takes.
    """
    V = np.array([w.potential_with_barriers for w in wires])
    parameters = [
        (
            w.hopping,
            w.spin_orbit_hopping,
            w.zeeman_per_tesla,
            w.gamma,
            w.delta0,
            w.lead_mu,
            w.lead_spin_orbit_hopping,
            w.lead_zeeman_per_tesla,
            w.dissipation,
            w.dissipation_of_parent,
        )
        for w in wires
    ]
    return V, np.array(parameters)


def bare_conductance(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    theta: float = 0.0,
    growth_limit: float = GROWTH_LIMIT,
) -> FloatArray:
    """Return the T = 0 conductances at ±ω, ω ≠ Δ₀ of each wire, in a field at the angle θ.

    Returns
    -------
    array, shape (wire, mu, B, omega, 2, 4)
        In e²/h; the last axes are the sign of ω (+, −) and G_LL, G_RR, G_LR, G_RL.
    """
    G: FloatArray = core.conductance(*handed_over(wires), mu, B, omega, theta, growth_limit)
    return G


def reflection_determinant(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    theta: float = 0.0,
    growth_limit: float = GROWTH_LIMIT,
) -> FloatArray:
    """Return det r at ω = 0 of both ends, without dissipation, shape (wire, lead, mu, B)."""
    T: FloatArray = core.reflection_determinant(*handed_over(wires), mu, B, theta, growth_limit)
    return T


def thermal_conductance(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    bias: FloatArray,
    temperature: float,
    tolerance: float | None = None,
    growth_limit: float = GROWTH_LIMIT,
) -> tuple[FloatArray, FloatArray, NDArray[np.int64]]:
    """Return thermal averages, their estimated error and how many energies each set took.

    The biases must be below the gap, and the wires as dissipative as their parents. Nodes are added
    where the error is more than the tolerance in e²/h.

    Returns
    -------
    G : array, shape (wire, mu, B, bias, 4)
        G_LL, G_RR, G_LR, G_RL in e²/h.
    error, energies : array, shape (wire, mu, B)
    """
    limit = core.TOLERANCE if tolerance is None else tolerance
    V, parameters = handed_over(wires)
    kT = BOLTZMANN * temperature
    G, error, energies = core.thermal_conductance(
        V, parameters, mu, B, bias, kT, limit, growth_limit
    )
    return G, error, energies.astype(np.int64)


def levels(
    wires: Sequence[Nanowire], mu: FloatArray, B: FloatArray, count: int, theta: float = 0.0
) -> FloatArray:
    """Return the lowest levels ≥ 0 of wires without leads and dissipation, in meV.

    Returns
    -------
    array, shape (wire, mu, B, level)
        To 1e-12 meV; NaN where there are no more below the gap.
    """
    E: FloatArray = core.levels(*handed_over(wires), mu, B, count, theta)
    return E
