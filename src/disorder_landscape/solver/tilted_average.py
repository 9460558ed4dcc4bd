"""The conductance at finite temperature in a tilted field, in closed form.

As in core/thermal, but the wire's matrices are neither real nor symmetric: core/tilted finds its
levels and its poles. A probability Tr[Γ_b G_ba Γ_a G_ba†] has the poles of G and their conjugates.
Their thermal averages are trigamma functions (core/thermal/trigamma.hpp). What is left of the true
conductance is smooth, some 1e-6 e²/h; its polynomial through Chebyshev nodes is averaged too, and
compared with the truth at further energies.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.model.hamiltonian import ComplexArray
from disorder_landscape.model.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.solver import compiled, compiled_green
from disorder_landscape.solver.compiled import core

NODES = (10, 16, 24)
"""Numbers of energies for the levels that are tried in turn."""
HEIGHT = 0.25
"""How far above the real axis they lie, in units of the window over their number."""
SMOOTH, CHECKS = 8, 40
"""Real energies for the smooth part, and for its check.  A narrow pole that the model lacks shows
near it alone: of 1,977 odd sets (`make odd-wires`) the error, up to 6e-4, was more than three times
the estimate from 8 checks in 11, from 16 in 5, from 24 in 1, from 40 in none."""
TOLERANCE = 2e-5
"""Estimated error in e²/h above which nodes are added."""
TWOFOLD = 1e-7
"""Up to this V_Z/kT the field is taken as along the wire: it does not count, and every level is
twofold, which the sum over poles does not stand."""


def field_counts(wire: Nanowire, B: FloatArray, temperature: float) -> NDArray[np.bool_]:
    """Return in which fields it counts that they are tilted, shape (B,)."""
    zeeman = max(wire.zeeman_per_tesla, wire.lead_zeeman_per_tesla) * abs(B)
    return np.asarray(zeeman > TWOFOLD * BOLTZMANN * temperature)


def thermal_conductance(
    wire: Nanowire, mu: FloatArray, B: float, bias: FloatArray, temperature: float, theta: float
) -> tuple[FloatArray, FloatArray, NDArray[np.int64]]:
    """Return conductances, their estimated error and how many energies each set took.

    As `compiled.thermal_conductance`, of one wire in one field, which counts, at the angle θ.

    Returns
    -------
    G : array, shape (mu, bias, 4)
        G_LL, G_RR, G_LR, G_RL in e²/h.
    error, energies : array, shape (mu,)
    """
    G, error = np.empty((mu.size, bias.size, 4)), np.full(mu.size, np.inf)
    energies = np.zeros(mu.size, dtype=np.int64)
    average = _Average(wire, B, bias, BOLTZMANN * temperature, theta)
    for nodes in NODES:
        missing = np.flatnonzero(~(error <= TOLERANCE))
        if missing.size:
            energies[missing] += nodes + SMOOTH + CHECKS
            found, estimate = average(mu[missing], nodes)
            better = estimate < error[missing]
            G[missing[better]] = found[better]
            error[missing[better]] = estimate[better]
    return G, error, energies


class _Average:
    """The thermal average of one wire at one field."""

    def __init__(self, wire: Nanowire, B: float, bias: FloatArray, kT: float, theta: float) -> None:
        self.wire, self.B, self.theta = wire, np.array([B]), theta
        self.bias, self.kT = bias, kT
        self.window = window = abs(bias).max() + core.REACH * kT
        at_checks = _nodes(CHECKS, 0.3)
        self.real = window * np.concatenate([_nodes(SMOOTH), at_checks])
        self.smooth = core.thermal_weights(bias, kT, SMOOTH)
        self.check = core.interpolation_weights(np.concatenate([at_checks, -at_checks]), SMOOTH)
        two = window * np.array([-1, 1]) / np.sqrt(2)
        sigma = compiled_green.lead_self_energies(wire, B, two, theta)
        below, above = _on_the_ends(compiled_green.in_rotated_frame(wire, sigma))
        self.slope = (above - below) / (two[1] - two[0])
        self.sigma = below - two[0] * self.slope

    def __call__(self, mu: FloatArray, nodes: int) -> tuple[FloatArray, FloatArray]:
        """Return the conductances, shape (mu, bias, 4), and the estimated error, shape (mu,).

        The error is infinite where there is no model.
        """
        z = _above_axis(self.window, nodes)
        wires, theta = [self.wire], self.theta
        F = compiled_green.isolated_ends(wires, mu, self.B, z, theta)[0, 0]
        bare = compiled.bare_conductance(wires, mu, self.B, self.real, theta)[0, :, 0]
        poles, residues = core.tilted_poles(
            z, F, self.sigma, self.slope, self.wire.rotated_hopping, self.window
        )
        rest = self._beside(poles, residues, bare, slice(None, SMOOTH))
        checked = self._beside(poles, residues, bare, slice(SMOOTH, None))
        G = self._averaged(poles, residues) + self.smooth @ rest
        error = abs(self.check @ rest - checked).max((1, 2)) + core.FLOOR
        return G, np.where(np.isfinite(G).all(axis=(1, 2)), error, np.inf)

    def _beside(
        self, poles: ComplexArray, residues: ComplexArray, bare: FloatArray, which: slice
    ) -> FloatArray:
        """Return what conductances are beside their poles, at ω, then −ω: (mu, 2·energy, 4)."""
        signed = np.concatenate([self.real[which], -self.real[which]])
        at_both = np.concatenate([bare[:, which, 0], bare[:, which, 1]], axis=1)
        of_poles = 2 * (1 / (signed[:, None] - poles[:, None]) @ residues).real
        return np.asarray(at_both - of_poles)

    def _averaged(self, poles: ComplexArray, residues: ComplexArray) -> FloatArray:
        """Return the thermal averages of the poles, shape (mu, bias, 4)."""
        unit = 2 * np.pi * self.kT
        at = 0.5 + 1j * (poles[:, None] - self.bias[:, None]) / unit
        shares = core.trigamma(at.reshape(-1, at.shape[-1])).reshape(at.shape) / (1j * unit)
        return 2 * np.asarray((shares @ residues).real)


def _nodes(count: int, after: float = 0.5) -> FloatArray:
    """Return sin(π(k + after)/2·count): at ½ those of 2·count Chebyshev nodes that are positive."""
    return np.asarray(np.sin(np.pi * (np.arange(count) + after) / (2 * count)))


def _above_axis(window: float, count: int) -> ComplexArray:
    """Return the energies for the levels, shape (count,), in meV."""
    return np.asarray(window * (_nodes(count) + 1j * HEIGHT / count))


def _on_the_ends(sigma: ComplexArray) -> ComplexArray:
    """Return self-energies (energy, lead, charge, 2, 2) as matrices, shape (energy, 8, 8)."""
    whole = np.zeros((len(sigma), 8, 8), dtype=np.complex128)
    for block in range(4):
        at = slice(2 * block, 2 * block + 2)
        whole[:, at, at] = sigma[:, block // 2, block % 2]
    return whole
