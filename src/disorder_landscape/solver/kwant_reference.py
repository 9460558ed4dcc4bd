"""The reference solver: Kwant, plainly written."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from disorder_landscape.model import hamiltonian as h
from disorder_landscape.model.hamiltonian import ComplexArray
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.parts import needs

with needs("kwant"), warnings.catch_warnings():
    # Without MUMPS Kwant warns; for a chain SciPy's solver is as good.
    warnings.simplefilter("ignore", RuntimeWarning)
    import kwant

ELECTRON, HOLE = 0, 1


def build_system(wire: Nanowire, theta: float = 0.0) -> Any:
    """Return the finalised Kwant system of a wire in a field at the angle θ.

    Its parameters are `uniform`, the onsite matrix of a site without disorder, and B. The leads
    conserve charge (electrons are block 0, holes block 1) and have the particle–hole symmetry of
    the whole, so that Kwant's modes at ω = 0 make the determinant of the reflection matrix real.
    """
    V = wire.potential_with_barriers
    lattice = kwant.lattice.chain(1, norbs=4)
    system = kwant.Builder()

    def onsite(site: Any, uniform: ComplexArray) -> ComplexArray:
        return np.asarray(uniform + V[site.tag[0]] * h.TAU_Z)

    system[(lattice(i) for i in range(wire.sites))] = onsite
    for i in range(wire.sites - 1):
        system[lattice(i), lattice(i + 1)] = h.hopping(wire)
    system.attach_lead(_lead(wire, lattice, -1, theta))
    system.attach_lead(_lead(wire, lattice, +1, theta))
    return system.finalized()


def _lead(wire: Nanowire, lattice: Any, direction: int, theta: float) -> Any:
    lead = kwant.Builder(
        kwant.TranslationalSymmetry((direction,)),
        conservation_law=-h.TAU_Z,
        particle_hole=h.PARTICLE_HOLE,
    )

    def onsite(site: Any, B: float) -> ComplexArray:
        return h.lead_onsite(wire, B, theta)

    lead[lattice(0)] = onsite
    lead[lattice(0), lattice(1)] = h.lead_hopping(wire)
    return lead


def scattering_matrices(
    wire: Nanowire, mu: FloatArray, B: FloatArray, omega: FloatArray, theta: float = 0.0
) -> Iterator[tuple[tuple[int, int, int], Any]]:
    """Yield ((i_mu, i_B, i_omega), scattering matrix); lead modes are computed once for all μ."""
    system = build_system(wire, theta)
    for j, field in enumerate(B):
        for k, energy in enumerate(omega):
            ready = system.precalculate(energy, what="modes", params={"B": field})
            for i, chemical_potential in enumerate(mu):
                uniform = h.onsite(wire, np.zeros(1), chemical_potential, field, energy, theta)[0]
                params = {"B": field, "uniform": uniform}
                yield (
                    (i, j, k),
                    kwant.smatrix(ready, energy, params=params, check_hermiticity=wire.lossless),
                )


def conductances(smatrix: Any) -> FloatArray:
    """Return the BTK conductances at +ω and −ω, shape (2, 4): LL, RR, LR, RL.

    At +ω G_aa = N_e − R_ee + R_he and G_ab = T_ee − T_he (from b to a). Particle–hole symmetry
    gives those at −ω from holes coming in, with electrons and holes exchanged.
    """
    G = np.empty((2, 4))
    for sign, (same, other) in enumerate([(ELECTRON, HOLE), (HOLE, ELECTRON)]):
        for lead in (0, 1):
            modes = smatrix.lead_info[lead].block_nmodes[same]
            normal = smatrix.transmission((lead, same), (lead, same))
            G[sign, lead] = modes - normal + smatrix.transmission((lead, other), (lead, same))
        for position, (out, into) in enumerate([(0, 1), (1, 0)], start=2):
            direct = smatrix.transmission((out, same), (into, same))
            G[sign, position] = direct - smatrix.transmission((out, other), (into, same))
    return G


def bare_conductance(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    theta: float = 0.0,
) -> FloatArray:
    """Return the T = 0 conductances at ±ω, shape (wire, mu, B, omega, 2, 4), in e²/h."""
    G = np.empty((len(wires), mu.size, B.size, omega.size, 2, 4))
    for w, wire in enumerate(wires):
        for index, smatrix in scattering_matrices(wire, mu, B, omega, theta):
            G[w, *index] = conductances(smatrix)
    return G


def reflection_determinant(
    wires: Sequence[Nanowire], mu: FloatArray, B: FloatArray, theta: float = 0.0
) -> FloatArray:
    """Return det r at ω = 0 of both ends, shape (wire, lead, mu, B)."""
    determinant = np.empty((len(wires), 2, mu.size, B.size))
    for w, wire in enumerate(wires):
        for (i, j, _), smatrix in scattering_matrices(wire, mu, B, np.zeros(1), theta):
            for lead in (0, 1):
                determinant[w, lead, i, j] = np.linalg.det(smatrix.submatrix(lead, lead)).real
    return determinant
