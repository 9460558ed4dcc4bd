"""Wires that lose particles to a bath: against Kwant, the tilted route, and what they tend to."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import arithmetics
from disorder_landscape import Nanowire, conductance, topological_visibility
from disorder_landscape.arguments import ArgumentError
from disorder_landscape.observables.gradient import conductance_gradient
from disorder_landscape.solver import kwant_reference
from random_wires import energies, fields, mus, random_wire, seeds

POINT = np.array([0.3]), np.array([0.5])


def lossy(wire, dissipation):
    return Nanowire(wire.potential, alpha=wire.alpha, dissipation=dissipation)


@settings(max_examples=25)
@given(seeds, mus, fields, energies, st.floats(1e-5, 0.1))
def test_three_routes_agree(seed, mu, B, omega, dissipation):
    wire = lossy(random_wire(seed, sites=100), dissipation)
    at = [wire], np.array([mu]), np.array([B]), np.array([omega])
    G = kwant_reference.bare_conductance(*at)
    assert_allclose(arithmetics.complex_conductance(*at), G, atol=1e-8, rtol=0)
    assert_allclose(arithmetics.tilted_conductance(*at, 0.0), G, atol=1e-8, rtol=0)


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
