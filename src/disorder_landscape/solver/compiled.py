"""What the compiled core calculates, of wires and arrays.

`core` is its best variant that this CPU can run, or the one that is asked for (`variants`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.machine import cores
from disorder_landscape.model.hamiltonian import ComplexArray
from disorder_landscape.model.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.solver.variants import chosen, variant

if TYPE_CHECKING:
    from disorder_landscape.solver import _core_baseline as core

__all__ = [
    "bare_conductance",
    "conductance_gradient",
    "core",
    "in_rotated_frame",
    "isolated_ends",
    "lead_self_energies",
    "levels",
    "local_green",
    "reflection_determinant",
    "thermal_conductance",
    "thermal_gradient",
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


def conductance_gradient(
    wire: Nanowire,
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    biases: NDArray[np.int64],
    lead_slopes: NDArray[np.complex128],
    growth_limit: float = GROWTH_LIMIT,
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
    by_V, others = core.conductance_gradient(
        *handed_over([wire]),
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
    """Derivatives by what core/derivatives/shifted_averages.hpp lists, (mu, B, bias, 4, 10)."""
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
) -> ThermalGradient:
    """Return thermal averages and their derivatives, of a window as for `thermal_conductance`.

    Parameters
    ----------
    energies : array, shape (4,)
        In meV, within the window.
    lead_slopes : array, shape (B, energy, 2, lead, charge, 2, 2)
        What `lead_slopes.rotated_lead_slopes` returns for them.
    """
    kT = BOLTZMANN * temperature
    G, error, solved, by_V, others, off = core.thermal_conductance_gradient(
        *handed_over([wire]),
        mu,
        B,
        bias,
        kT,
        energies,
        lead_slopes,
        1 / (2 * wire.lattice),
        core.TOLERANCE,
        GROWTH_LIMIT,
    )
    return ThermalGradient(
        G, error, solved.astype(np.int64), by_V, others, off[..., 0], off[..., 1]
    )


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
    G: ComplexArray = core.isolated_ends(*handed_over(wires), mu, B, x, y, theta)
    return G


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
    G, growth = core.local_green(*handed_over([wire]), mu, B, x, y, turned, theta)
    return G, growth


def lead_self_energies(
    wire: Nanowire, B: float, omega: FloatArray, theta: float = 0.0
) -> ComplexArray:
    """Return Σ of the leads, shape (energy, lead, charge, 2, 2), in meV, spin not rotated."""
    sigma: ComplexArray = core.lead_self_energies(*handed_over([wire]), B, omega, theta)
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
