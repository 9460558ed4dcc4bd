"""Wires that lose particles to a bath: against Kwant, the tilted route, and what they tend to."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

import arithmetics
from disorder_landscape import Nanowire, conductance, topological_visibility
from disorder_landscape.arguments import ArgumentError
from disorder_landscape.model.hamiltonian import wire_hamiltonian
from disorder_landscape.model.parameters import BIAS
from disorder_landscape.observables.gradient import conductance_gradient
from disorder_landscape.solver import compiled, kwant_reference
from disorder_landscape.solver.quadrature import thermal_quadrature
from disorder_landscape.solver.routes import thermal_average
from random_wires import energies, fields, mus, random_wire, seeds

POINT = np.array([0.3]), np.array([0.5])


def lossy(wire, dissipation, parent=None):
    leaking = {"dissipation": dissipation, "parent_dissipation": parent}
    return Nanowire(wire.potential, alpha=wire.alpha, **leaking)


@settings(max_examples=25)
@given(seeds, mus, fields, energies, st.floats(1e-5, 0.1), st.sampled_from([None, 0.0, 1e-3, 0.05]))
def test_three_routes_agree(seed, mu, B, omega, dissipation, parent):
    wire = lossy(random_wire(seed, sites=100), dissipation, parent)
    at = [wire], np.array([mu]), np.array([B]), np.array([omega])
    G = kwant_reference.bare_conductance(*at)
    assert_allclose(arithmetics.complex_conductance(*at), G, atol=1e-8, rtol=0)
    assert_allclose(arithmetics.tilted_conductance(*at, 0.0), G, atol=1e-8, rtol=0)


@pytest.mark.brute_force
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("temperature", [0.02, 0.05, 0.2, 0.3])
@pytest.mark.parametrize("dissipation", [1e-7, 1e-4, 1e-3, 0.02])
def test_the_average_is_the_integral(seed, temperature, dissipation):
    wire = lossy(random_wire(seed, sites=200), dissipation)
    arguments = [wire], *POINT, np.array(BIAS), temperature
    G, estimate, _ = compiled.thermal_conductance(*arguments)
    exact = thermal_quadrature(*arguments)
    assert estimate.item() < 1e-3
    assert abs(G - exact.conductance).max() <= estimate.item() + exact.error.item()
    found = thermal_average(*arguments)
    assert_allclose(found.conductance, exact.conductance, rtol=0, atol=1e-4)


def test_a_wire_that_leaks_alone_is_integrated():
    """Its levels are broadened unevenly, and no closed form is known."""
    wire = lossy(random_wire(3, sites=60), 1e-3, 0.0)
    arguments = [wire], *POINT, np.array(BIAS), 0.05
    exact, found = thermal_quadrature(*arguments), thermal_average(*arguments)
    assert_array_equal(found.conductance, exact.conductance)
    both = thermal_average([lossy(random_wire(3, sites=60), 1e-3)], *arguments[1:])
    assert abs(both.conductance - exact.conductance).max() > 1e-4


@pytest.mark.parametrize("omega", [0.03, 0.1199, 0.1201, 0.3])
def test_it_is_a_shift_of_the_energy(omega):
    """Of wire and parent, where the leads are wide: G of the ends is then that at ω + iΓ."""
    wire, width = random_wire(5, sites=30), 2e-3
    H = wire_hamiltonian(lossy(wire, width), 0.3, 0.5, omega)
    z = omega + 1j * width
    shifted = np.linalg.inv(z * np.eye(len(H)) - wire_hamiltonian(wire, 0.3, 0.5, z))
    assert_allclose(np.linalg.inv(omega * np.eye(len(H)) - H), shifted, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("theta", [0.0, 0.7])
def test_the_average_is_that_of_a_fine_grid(theta):
    """The grid cuts 5e-5 of the thermal kernel, and no level is narrower than 2Γ."""
    wire, bias = lossy(random_wire(7, sites=60), 1e-3), [-0.02, 0.0, 0.02]
    exact = conductance(wire, *POINT, bias, 0.02, theta=theta)
    grid = conductance(wire, *POINT, bias, 0.02, theta=theta, energy_spacing=1e-4)
    for name in ("G_LL", "G_RR", "G_LR", "G_RL"):
        assert_allclose(exact[name], grid[name], atol=5e-5)


def test_little_dissipation_changes_little_and_much_hides_the_far_end():
    wire = random_wire(7)
    G = [
        conductance(lossy(wire, dissipation), *POINT, [0.0, 0.02], 0.02)
        for dissipation in (0.0, 1e-7, 1.0)
    ]
    assert_allclose(G[1]["G_LL"], G[0]["G_LL"], atol=1e-3)
    assert abs(G[0]["G_LR"]).max() > 1e-4
    assert abs(G[2]["G_LR"]).max() < 1e-10


def test_what_needs_every_particle_says_so():
    wire = lossy(random_wire(7), 1e-3)
    with pytest.raises(ArgumentError, match="no dissipation for T_IV"):
        topological_visibility(wire, *POINT)
    with pytest.raises(ArgumentError, match="no dissipation for slopes"):
        conductance_gradient(wire, *POINT, temperature=0)
    with pytest.raises(ArgumentError, match="dissipation"):
        lossy(wire, -1e-3)
