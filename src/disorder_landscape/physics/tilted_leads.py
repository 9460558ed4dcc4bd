"""Self-energies of the normal leads in a field that is tilted by θ against the wire.

With h = V_Z cos θ and w = V_Z sin θ + 2s sin k the electron block of `leads` is ε(k) + hσx + wσy,
and its modes λ = e^{ik} at energy E solve m² = h² + w², m = E' + t(λ + 1/λ), E' = E − 2t + μ_lead:

    (t²+s²)(λ⁴ + 1) + 2(tE' + isv)λ³ + 2(tE' − isv)λ + (E'² + 2t² − 2s² − v² − h²)λ² = 0,

v = V_Z sin θ. The roots come in pairs λ, 1/λ*, of which one is outgoing to the right: it decays, or
its group velocity 2t sin k + 2sw cos k/m points there. With spinors u in the columns of U, the
right lead's self-energy is (hopping) U λ U⁻¹, the left lead's, from the other two, (hopping)† U λ⁻¹
U⁻¹. The hole block at E is −σy Σ(−E)* σy as for θ = 0.

Where spins are all but degenerate, the spinors lose all digits. So F = U λ U⁻¹ is only the start
of Newton's iteration for T F² − (E − H₀) F + T† = 0, T the hopping, of which each step is linear in
the entries of F; and where V_Z is small, compared with what it takes to make an outgoing mode meet
an incoming one, the start is F without a field (`leads`).
"""

from __future__ import annotations

import numpy as np

from disorder_landscape.physics.hamiltonian import PAULI, ComplexArray
from disorder_landscape.physics.leads import (
    electron_self_energy,
    lead_self_energies,
    outgoing_without_field,
)
from disorder_landscape.physics.parameters import FloatArray, Nanowire

ON_THE_CIRCLE = 1e-7
"""How close to 1 |λ| is taken for that of a propagating mode."""
SMALL = 0.02
"""By up to this part of the distance between outgoing and incoming modes, of any spin, the field
may move them for the iteration to start without it."""
NEGLIGIBLE = 1e-8
"""V_Z/t' up to which the field is left out where incoming and outgoing modes of two spins cross:
there rounding moves the modes, all but twofold roots, by as much."""
STEPS = 6
"""Steps of Newton's iteration: from 0.02 it takes four."""


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
    zeeman = wire.lead_zeeman_per_tesla * B
    if zeeman == 0:  # any angle is the same
        return lead_self_energies(wire, B, omega)
    sigma = np.empty((omega.size, 2, 2, 2, 2), dtype=np.complex128)
    along, across = zeeman * np.cos(theta), zeeman * np.sin(theta)
    sigma[:, :, 0] = _electron_self_energies(wire, along, across, omega)
    hole = _electron_self_energies(wire, along, across, -omega).conj()
    signs = np.array([[-1, 1], [1, -1]])  # −σy M σy = [[−M11, M10], [M01, −M00]]
    sigma[:, :, 1] = signs * hole[..., ::-1, ::-1]
    return sigma


def _electron_self_energies(
    wire: Nanowire, along: float, across: float, E: FloatArray
) -> ComplexArray:
    """Return the electron blocks, shape (energy, lead, 2, 2)."""
    t, s = wire.hopping, wire.lead_spin_orbit_hopping
    if s == 0:
        return _without_spin_orbit(wire, along, across, E)
    shifted = (E - 2 * t + wire.lead_mu)[:, None]
    lam = _roots(t, s, shifted[:, 0], along, across)  # (energy, mode)
    m = shifted + t * (lam + 1 / lam)
    w = across - 1j * s * (lam - 1 / lam)
    # of the columns of (m + hσx + wσy) the one that cannot vanish
    up = np.array([m, along + 1j * w])
    down = np.array([along - 1j * w, m])
    spinor = np.where((abs(up) ** 2).sum(0) > (abs(down) ** 2).sum(0), up, down)
    spinor = np.moveaxis(spinor / np.sqrt((abs(spinor) ** 2).sum(0)), 0, 1)
    slope = np.where(m == 0, 0.0, w / np.where(m == 0, 1.0, m)).real
    velocity = 2 * t * lam.imag + 2 * s * slope * lam.real
    propagating = abs(abs(lam) - 1) < ON_THE_CIRCLE
    inwards = np.where(propagating, -np.sign(velocity), np.log(abs(lam)))
    order = np.argsort(np.where(propagating, ON_THE_CIRCLE * inwards, inwards), axis=1)
    hop = np.array([[-t, -s], [s, -t]], dtype=np.complex128)
    H0 = along * PAULI["x"] + across * PAULI["y"] - shifted[:, None] * np.eye(2)  # and −E
    free = np.array([outgoing_without_field(e, t, s, wire.lead_mu) for e in E])
    size, hopping = np.hypot(along, across), np.hypot(t, s)
    cosine = -shifted[:, 0] / (2 * hopping) + 0j  # of k without field, but for ±atan(s/t)
    sine = np.sqrt(1 - cosine**2)
    apart = abs(
        np.array([sine, (sine * t + cosine * s) / hopping, (sine * t - cosine * s) / hopping])
    )
    small = size < 4 * SMALL * hopping * abs(sine) * apart.min(axis=0)
    lost = ~small & (size < NEGLIGIBLE * hopping)
    sigma = np.empty((E.size, 2, 2, 2), dtype=np.complex128)
    for lead, power, coupling in ((0, -1, hop.T), (1, 1, hop)):
        modes = order[:, 2 - 2 * lead : 4 - 2 * lead]
        U = np.take_along_axis(spinor, modes[:, None], axis=2)  # (energy, spin, mode)
        shifts = np.take_along_axis(lam, modes, axis=1) ** power
        U[small | lost] = np.eye(2)
        F = (U * shifts[:, None]) @ np.linalg.inv(U)
        F[small | lost] = (free[:, None, None] * np.linalg.inv(coupling))[small | lost]
        F[~lost] = _refined(F[~lost], coupling, H0[~lost])
        sigma[:, lead] = coupling @ F
    return sigma


def _without_spin_orbit(wire: Nanowire, along: float, across: float, E: FloatArray) -> ComplexArray:
    """Return the same of leads whose spin is along the field, or against it, at every energy."""
    straight = np.empty((E.size, 2, 2), dtype=np.complex128)
    size = float(np.hypot(along, across))
    for energy, out in zip(E, straight, strict=True):
        electron_self_energy(energy, wire.hopping, 0.0, size, wire.lead_mu, out)
    direction = (along * PAULI["x"] + across * PAULI["y"]) / size
    turned = straight[:, 0, 0, None, None] * np.eye(2) + straight[:, 0, 1, None, None] * direction
    return np.repeat(turned[:, None], 2, axis=1)


def _refined(F: ComplexArray, T: ComplexArray, H: ComplexArray) -> ComplexArray:
    """Return the solutions near F of T F² + H F + T† = 0, shape (energy, 2, 2)."""
    best, least = F, np.full(len(F), np.inf)
    one = np.eye(2)
    for _ in range(STEPS + 1):
        TF = T @ F
        rest = (TF + H) @ F + T.conj().T
        size = abs(rest).max(axis=(1, 2))
        better = size < least
        best, least = np.where(better[:, None, None], F, best), np.where(better, size, least)
        # T(F dF + dF F) + H dF, on the entries of dF row by row
        left = np.einsum("eij,kl->eikjl", TF + H, one)
        right = np.einsum("ij,elk->eikjl", T, F)
        step = np.linalg.solve((left + right).reshape(-1, 4, 4), rest.reshape(-1, 4, 1))
        F = F - step.reshape(F.shape)
    return best


def _roots(t: float, s: float, shifted: FloatArray, along: float, across: float) -> ComplexArray:
    """Return the four λ at each energy, shape (energy, 4), from the companion matrix."""
    leading = t**2 + s**2
    cubic = 2 * (t * shifted + 1j * s * across) / leading
    quadratic = (shifted**2 + 2 * t**2 - 2 * s**2 - across**2 - along**2) / leading
    companion = np.zeros((shifted.size, 4, 4), dtype=np.complex128)
    companion[:, [1, 2, 3], [0, 1, 2]] = 1.0
    companion[:, 0] = -np.stack([cubic, quadratic + 0j, cubic.conj(), np.ones_like(cubic)], axis=1)
    return np.asarray(np.linalg.eigvals(companion), dtype=np.complex128)
