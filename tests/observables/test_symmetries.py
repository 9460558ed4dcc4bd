"""Exact symmetries, conservation laws and limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from numpy.testing import assert_allclose

from disorder_landscape import Nanowire, conductance, topological_visibility
from disorder_landscape.model import hamiltonian
from disorder_landscape.model.parameters import BIAS
from disorder_landscape.observables.visibility import transition_field
from disorder_landscape.solver import kwant_reference
from random_wires import energies, fields, mus, random_wire, seeds

KNOWN = [  # μ, B, ω, G_LL, G_RL, det r of the pristine wire at α = 8, from PHYSICS.md
    (0.0, 0.0, 0.0, 0.0033, 0.0000, 1.0000),
    (0.0, 0.3, 0.0, 2.0000, 0.0000, -1.0000),
    (0.0, 0.5, 0.0, 1.9981, 0.0009, -0.9979),
    (0.3, 0.3, 0.0, 0.0376, 0.0000, 1.0000),
    (0.3, 0.6, 0.0, 1.3367, 0.0036, -0.3367),
    (0.0, 0.4, 0.02, 0.0085, 0.0000, None),
]
PRISTINE = Nanowire(np.zeros(300))


@pytest.mark.parametrize("solver", ["fast", "kwant"])
@pytest.mark.parametrize(("mu", "B", "omega", "G_LL", "G_RL", "det_r"), KNOWN)
def test_known_values_of_the_pristine_wire(solver, mu, B, omega, G_LL, G_RL, det_r):
    G = conductance(PRISTINE, mu, B, omega, temperature=0, solver=solver)
    assert_allclose([G.G_LL.item(), G.G_RL.item()], [G_LL, G_RL], atol=5.1e-5)
    if det_r is not None:
        T = topological_visibility(PRISTINE, mu, B, solver=solver)
        assert_allclose(T.squeeze(), det_r, atol=5.1e-5)


@settings(max_examples=15)
@given(seeds, mus, fields, energies)
def test_the_scattering_matrix_is_unitary(seed, mu, B, omega):
    matrices = kwant_reference.scattering_matrices(
        random_wire(seed), np.array([mu]), np.array([B]), np.array([omega])
    )
    S = next(matrices)[1].data
    assert_allclose(S.conj().T @ S, np.eye(len(S)), atol=1e-9)


@settings(max_examples=15)
@given(seeds, mus, fields, energies)
def test_negative_energies_follow_from_holes_at_positive_ones(seed, mu, B, omega):
    """Particle–hole symmetry, checked against a calculation at −ω."""
    wire = random_wire(seed)
    G = {
        sign: kwant_reference.bare_conductance(
            [wire], np.array([mu]), np.array([B]), np.array([sign * omega])
        )[0, 0, 0, 0]
        for sign in (1, -1)
    }
    assert_allclose(G[1], G[-1][::-1], atol=1e-8)


def test_the_hamiltonian_has_particle_hole_symmetry_and_is_real_and_hermitian():
    wire, C = random_wire(3, sites=12), np.kron(np.eye(12), hamiltonian.PARTICLE_HOLE)
    H = hamiltonian.wire_hamiltonian(wire, 0.2, 0.5, 0.04)
    assert_allclose(C @ H.conj() @ C, -hamiltonian.wire_hamiltonian(wire, 0.2, 0.5, -0.04))
    assert_allclose(H, H.conj().T)
    assert_allclose(H.imag, 0)


@settings(max_examples=20)
@given(seeds, mus, fields)
def test_the_mirror_image_of_a_wire_swaps_left_and_right(seed, mu, B):
    wire = random_wire(seed, sites=80)
    G = conductance(wire, mu, B, BIAS, energy_spacing=4e-3)
    mirrored = conductance(
        Nanowire(wire.potential[::-1], alpha=wire.alpha), mu, B, BIAS, energy_spacing=4e-3
    )
    for name, other in [("G_LL", "G_RR"), ("G_LR", "G_RL")]:
        assert_allclose(G[name], mirrored[other], atol=1e-7)
        assert_allclose(G[other], mirrored[name], atol=1e-7)


@settings(max_examples=20)
@given(seeds, mus, fields, energies)
def test_currents_are_conserved(seed, mu, B, omega):
    """An electron from L leaves as current in L or R, or as a pair: 0 ≤ G_LL − |G_RL| ≤ 4."""
    G = conductance(random_wire(seed), mu, B, omega, temperature=0)
    for local, out in [("G_LL", "G_RL"), ("G_RR", "G_LR")]:
        surplus = G[local].item() - abs(G[out].item())
        assert -1e-9 <= surplus <= 4 + 1e-9


def test_zero_bias_conductance_needs_no_choice_of_the_sign_of_zero():
    wire = random_wire(12)
    above = conductance(wire, 0.2, 0.5, 1e-12, temperature=0)
    below = conductance(wire, 0.2, 0.5, -1e-12, temperature=0)
    for name in above.data_vars:
        assert_allclose(above[name].item(), below[name].item(), atol=1e-6)


@pytest.mark.parametrize("mu", [0.0, 0.2, 0.45])
def test_the_bulk_transition_is_where_theory_says(mu):
    """In a long pristine wire det r changes sign at V_Z² = μ² + γ²."""
    wire = Nanowire(np.zeros(4000))
    critical = transition_field(wire, mu)
    T = topological_visibility(wire, mu, critical * np.array([0.98, 1.02]), barrier=False)
    assert (T[:, 0, 0] > 0).all()
    assert (T[:, 0, 1] < 0).all()
    if mu == 0:
        assert critical == pytest.approx(0.207, abs=5e-4)


@settings(max_examples=20)
@given(seeds, mus, fields)
def test_the_visibility_is_the_same_from_both_ends_up_to_transmission(seed, mu, B):
    """det S = ±1 and unitarity make |det r| equal at both ends."""
    T = topological_visibility(random_wire(seed), mu, B)
    assert_allclose(abs(T.sel(lead="L")), abs(T.sel(lead="R")), atol=1e-7)
    assert (abs(T) <= 1 + 1e-9).all()


def test_without_coupling_to_the_superconductor_nothing_turns_into_holes():
    wire = Nanowire(np.zeros(50), gamma=0.0, barrier=(0.0, 0.0))
    G = conductance(wire, 0.3, 0.5, 0.02, temperature=0)
    assert_allclose(G.G_LL, G.G_RL, atol=1e-9)
    assert_allclose(G.G_RR, G.G_LR, atol=1e-9)
