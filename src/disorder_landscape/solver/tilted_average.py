"""The conductance at finite temperature in a tilted field, in closed form.

As in core/thermal, but for one set (wire, μ, B) after the other and with dense matrices: at
θ ≠ 0 nothing is real or symmetric. With H = iA of the isolated wire (`tilted_levels`) and the
leads' self-energies, linear in energy, iΣ₀ + zΣ₁, the ends' Green's function is

    G(z) = u (zN − iK)⁻¹ uᵀ = Σ_n a_n b_n†/(z − z_n),   N = 1 − uᵀΣ₁u,   K = A + uᵀΣ₀u,

with N and K real in the basis of `tilted_levels` by particle–hole symmetry, and z_n = −z_m* in
pairs. A probability Tr[Γ_b G_ba Γ_a G_ba†] then has the poles z_n with the residues
b_n†Γ_a G_ba(z_n*)†Γ_b a_n, and their conjugates. Their thermal averages are trigamma functions
(core/thermal/trigamma.hpp). What is left of the true conductance is smooth, some 1e-6 e²/h; its
polynomial through Chebyshev nodes is averaged too, and compared with the truth at further energies.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import ThreadpoolController

from disorder_landscape.model.hamiltonian import ComplexArray
from disorder_landscape.model.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.solver import compiled
from disorder_landscape.solver.compiled import core
from disorder_landscape.solver.tilted_levels import BASIS, isolated_wire

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
FAR = 4.0
"""Poles further from zero than so many windows are left to the smooth part: through 16 nodes what
they give is interpolated to 1e-14 of itself. Nor are they all poles of the wire: there the leads'
self-energies, taken as linear, may feed it, and residues of 1e15 would cancel in the sum."""
TWOFOLD = 1e-7
"""Up to this V_Z/kT the field is taken as along the wire: it does not count, and every level is
twofold, which the sum over poles does not stand."""
FEEDS = 1e-9
"""A nearer pole further above the real axis, in units of the window, makes no model."""

LEFT_ELECTRON, LEFT_HOLE, RIGHT_ELECTRON, RIGHT_HOLE = (slice(2 * i, 2 * i + 2) for i in range(4))
PROBABILITIES = [
    (LEFT_HOLE, LEFT_ELECTRON),
    (RIGHT_ELECTRON, LEFT_ELECTRON),
    (RIGHT_HOLE, LEFT_ELECTRON),
    (RIGHT_HOLE, RIGHT_ELECTRON),
    (LEFT_ELECTRON, RIGHT_ELECTRON),
    (LEFT_HOLE, RIGHT_ELECTRON),
]
"""Out of which entries, and into which: below the gap these give all conductances."""
WEIGHTS = np.array(
    [[2, 1, 1, 0, 0, 0], [0, 0, 0, 2, 1, 1], [0, 0, 0, 0, 1, -1], [0, 1, -1, 0, 0, 0]]
)
"""G_LL, G_RR, G_LR, G_RL as sums of the probabilities."""


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
            # the matrices are too small to be shared
            with _controller().limit(limits=1, user_api="blas"):
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
        sigma = compiled.lead_self_energies(wire, B, two, theta)
        below, above = _on_the_ends(compiled.in_rotated_frame(wire, sigma))
        self.slope = (above - below) / (two[1] - two[0])
        self.sigma = below - two[0] * self.slope

    def __call__(self, mu: FloatArray, nodes: int) -> tuple[FloatArray, FloatArray]:
        """Return the conductances, shape (mu, bias, 4), and the estimated error, shape (mu,)."""
        x = self.window * _nodes(nodes)
        z = x + 1j * HEIGHT * self.window / nodes
        wires, theta = [self.wire], self.theta
        F = compiled.isolated_ends(wires, mu, self.B, z, theta)[0, 0]
        bare = compiled.bare_conductance(wires, mu, self.B, self.real, theta)[0, :, 0]
        some = [self._of_set(z, F[m], bare[m]) for m in range(mu.size)]
        G, error = (np.array(part) for part in zip(*some, strict=True))
        return G, np.where(np.isfinite(G).all(axis=(1, 2)), error, np.inf)

    def _of_set(
        self, z: ComplexArray, F: ComplexArray, bare: FloatArray
    ) -> tuple[FloatArray, float]:
        """Return G(V), shape (bias, 4), and its estimated error; infinite where there is no model.

        So it is where poles of few sites without a parent coincide and share their eigenvector.
        """
        try:
            return self._of_wire(*isolated_wire(z, F), bare)
        except np.linalg.LinAlgError:
            return np.full((self.bias.size, 4), np.nan), np.inf

    def _of_wire(self, A: FloatArray, u: FloatArray, bare: FloatArray) -> tuple[FloatArray, float]:
        """Return G(V), shape (bias, 4), and its estimated error; bare: (real, 2, 4)."""
        z, residues = self._poles(A, u)
        if np.isnan(z).any():
            return np.full((self.bias.size, 4), np.nan), np.inf
        signed = np.concatenate([self.real[:SMOOTH], -self.real[:SMOOTH]])
        checks = np.concatenate([self.real[SMOOTH:], -self.real[SMOOTH:]])
        rest = [
            np.concatenate([some[:, 0], some[:, 1]]) - 2 * (1 / (at[:, None] - z) @ residues).real
            for at, some in ((signed, bare[:SMOOTH]), (checks, bare[SMOOTH:]))
        ]
        error = abs(self.check @ rest[0] - rest[1]).max() + core.FLOOR
        unit = 2 * np.pi * self.kT
        shares = core.trigamma(0.5 + 1j * (z - self.bias[:, None]) / unit) / (1j * unit)
        return 2 * (shares @ residues).real + self.smooth @ rest[0], float(error)

    def _poles(self, A: FloatArray, u: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return the near poles of the wire with its leads and their residues, shape (pole, 4).

        NaN if the data make no model.
        """
        sigma, slope = (BASIS.conj().T @ s @ BASIS for s in (self.sigma, self.slope))
        N = np.eye(len(A)) - u.T @ slope.real @ u
        K = A + u.T @ sigma.imag @ u
        eigenvalues, V = np.linalg.eig(np.linalg.solve(N, K))
        # A level that the leads do not reach has no width but what rounding gives, or none at all.
        width = np.finfo(np.float64).eps * abs(eigenvalues).max()
        near, decay = abs(eigenvalues) < FAR * self.window, eigenvalues.real
        if (decay[near] > FEEDS * self.window).any():
            return np.full(1, np.nan + 0j), np.zeros((1, 4), dtype=np.complex128)
        z = -eigenvalues.imag + 1j * np.where(near, np.minimum(decay, -width), decay)
        a = (BASIS @ (u @ V)).T  # (pole, 8)
        b = np.linalg.solve(V, np.linalg.solve(N, u.T)) @ BASIS.conj().T
        products = (a[:, :, None] * b[:, None, :]).reshape(-1, 64)
        z, every, a, b = z[near], z, a[near], b[near]
        G = (1 / (z.conj()[:, None] - every) @ products).reshape(-1, 8, 8).conj()  # G(z*)*
        gamma = [1j * (s - s.conj().T) for s in (self.sigma, self.slope)]
        at_poles = gamma[0] + z[:, None, None] * gamma[1]
        left = np.einsum("nij,nj->ni", at_poles, a)
        right = np.einsum("ni,nij->nj", b, at_poles)
        found = [
            np.einsum("ni,nj,nij->n", left[:, out], right[:, into], G[:, out, into])
            for out, into in PROBABILITIES
        ]
        return z, np.asarray(np.array(found).T @ WEIGHTS.T)


def _nodes(count: int, after: float = 0.5) -> FloatArray:
    """Return sin(π(k + after)/2·count): at ½ those of 2·count Chebyshev nodes that are positive."""
    return np.asarray(np.sin(np.pi * (np.arange(count) + after) / (2 * count)))


@cache
def _controller() -> ThreadpoolController:
    """Return what knows the process's libraries: to look for them takes milliseconds."""
    return ThreadpoolController()


def _on_the_ends(sigma: ComplexArray) -> ComplexArray:
    """Return self-energies (energy, lead, charge, 2, 2) as matrices, shape (energy, 8, 8)."""
    whole = np.zeros((len(sigma), 8, 8), dtype=np.complex128)
    for block in range(4):
        at = slice(2 * block, 2 * block + 2)
        whole[:, at, at] = sigma[:, block // 2, block % 2]
    return whole
