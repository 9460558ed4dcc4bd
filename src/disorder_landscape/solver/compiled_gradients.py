"""Derivatives that the compiled core calculates, of a wire and arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.model.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.solver import compiled


def conductance_gradient(
    wire: Nanowire,
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    biases: NDArray[np.int64],
    lead_slopes: NDArray[np.complex128],
    growth_limit: float = compiled.GROWTH_LIMIT,
) -> tuple[FloatArray, FloatArray]:
    """Return the derivatives of the T = 0 conductances below the gap, without dissipation.

    Parameters
    ----------
    wire : Nanowire
    mu, B, omega : array
        0 ≤ ω < Δ₀.
    biases : array, shape (omega, 2)
        Which bias +ω and −ω are, −1 if none.
    lead_slopes : array, shape (B, omega, 2, lead, charge, 2, 2)
        With respect to B and α: what `lead_slopes.rotated_lead_slopes` returns, the first times
        the leads' V_Z/B.
    growth_limit : float

    Returns
    -------
    array, shape (4, mu, B, bias, site)
        Of G_LL, G_RR, G_LR, G_RL with respect to every site's V, in e²/h per meV.
    array, shape (4, 3, mu, B, bias)
        With respect to μ, B and α, in e²/h per meV, T and meV nm.
    """
    by_V, others = compiled.core.conductance_gradient(
        *compiled.handed_over([wire]),
        mu,
        B,
        omega,
        biases,
        biases.max() + 1,
        lead_slopes,
        1 / (2 * wire.lattice),
        growth_limit,
    )
    return by_V, others


class ThermalGradient(NamedTuple):
    """What `thermal_gradient` returns."""

    conductance: FloatArray
    """Shape (mu, B, bias, 4): G_LL, G_RR, G_LR, G_RL in e²/h."""
    error: FloatArray
    """Estimated error of the largest of them, shape (mu, B), in e²/h."""
    energies: NDArray[np.int64]
    """Energies solved for them, shape (mu, B)."""
    by_V: FloatArray
    """Derivatives by every site's V, shape (mu, B, bias, 4, site), in e²/h per meV."""
    others: FloatArray
    """Derivatives by what core/derivatives/shifted_averages.hpp lists, (mu, B, bias, 4, 10); rough
    ones by nothing, (…, 0)."""
    difference: FloatArray
    """How far two ways to the derivative by the bias are apart, (mu, B), in e²/h per kT;
    infinite, and the derivatives NaN, where there is no model."""
    at_gap: FloatArray
    """By how much those by Δ₀ and V_Z may be off besides, where levels next to the gap are too
    many to be told apart, (mu, B), in e²/h per kT."""


def thermal_gradient(
    wire: Nanowire,
    mu: FloatArray,
    B: FloatArray,
    bias: FloatArray,
    temperature: float,
    energies: FloatArray,
    lead_slopes: NDArray[np.complex128],
    roughly: bool = False,
) -> ThermalGradient:
    """Return thermal averages and their derivatives, of a window as for `thermal_conductance`.

    Parameters
    ----------
    energies : array, shape (4,)
        In meV, within the window.
    lead_slopes : array, shape (B, energy, 2, lead, charge, 2, 2)
        What `lead_slopes.rotated_lead_slopes` returns for them.
    roughly : bool
        Find the derivatives by V alone, in half of the time and within a few percent. How wrong
        they are is not estimated, and stands as zero.
    """
    kT = BOLTZMANN * temperature
    G, error, solved, by_V, others, off = compiled.core.thermal_conductance_gradient(
        *compiled.handed_over([wire]),
        mu,
        B,
        bias,
        kT,
        energies,
        lead_slopes,
        1 / (2 * wire.lattice),
        compiled.core.TOLERANCE,
        compiled.GROWTH_LIMIT,
        roughly,
    )
    return ThermalGradient(
        G, error, solved.astype(np.int64), by_V, others, off[..., 0], off[..., 1]
    )
