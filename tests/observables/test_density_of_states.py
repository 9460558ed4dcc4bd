"""The local density of states: against dense matrices, Kwant, brute force and its symmetries."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from disorder_landscape import ArgumentError, Nanowire, local_density_of_states, modes
from disorder_landscape.model.hamiltonian import onsite, wire_hamiltonian
from disorder_landscape.model.parameters import BOLTZMANN
from disorder_landscape.observables import density_of_states
from disorder_landscape.solver import compiled_green
from disorder_landscape.solver.kwant_reference import build_system, kwant
from disorder_landscape.solver.lead_continuation import continued_self_energies

WIRE = Nanowire(np.random.default_rng(0).normal(0, 0.3, 30))
BOTH = ["LDOS_electron", "LDOS_hole"]
ENERGIES = [-0.2, -0.05, 0.0, 0.03, 0.11, 0.3]


def dense(wire, mu, B, energy, theta):
    """Return −Im G/π on each site, shape (site, 2), of the matrix as a whole."""
    n = wire.sites
    above = energy + 1e-300j
    M = energy * np.eye(4 * n) - wire_hamiltonian(wire, mu, B, above, theta)
    sigma = compiled_green.lead_self_energies(wire, B, np.array([energy]), theta)[0]
    for end, site in ((0, 0), (1, n - 1)):
        for charge in range(2):
            own = slice(4 * site + 2 * charge, 4 * site + 2 * charge + 2)
            M[own, own] -= sigma[end, charge]
    diagonal = np.diagonal(np.linalg.inv(M)).reshape(n, 2, 2).sum(axis=2)
    return -diagonal.imag / np.pi


@pytest.mark.parametrize("theta", [0.0, 0.4])
@pytest.mark.parametrize("dissipation", [0.0, 0.002])
def test_it_is_that_of_the_dense_matrix(theta, dissipation):
    wire = Nanowire(WIRE.potential, dissipation=dissipation)
    density = local_density_of_states(wire, [0.1, 0.4], [0.0, 0.6], ENERGIES, theta=theta)
    for point in np.ndindex(2, 2, len(ENERGIES)):
        here = density.isel(mu=point[0], B=point[1], energy=point[2])
        expected = dense(wire, float(here.mu), float(here.B), float(here.energy), theta)
        found = here[BOTH].to_array("part", "").transpose("site", "part").to_numpy()
        np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-9 * abs(expected).max())


def test_it_is_what_kwant_finds_from_scattering_states():
    """Below the gap nothing is absorbed: all states come from the leads (kwant.ldos)."""
    system = build_system(WIRE)
    places = np.argsort([site.tag[0] for site in system.sites])
    for energy in (0.02, -0.07):
        density = local_density_of_states(WIRE, 0.3, 0.6, energy)[BOTH].to_array("part", "")
        uniform = onsite(WIRE, np.zeros(1), 0.3, 0.6, energy)[0]
        ldos = kwant.ldos(system, energy, params={"B": 0.6, "uniform": uniform})
        expected = ldos.reshape(WIRE.sites, 2, 2)[places].sum(axis=2)
        found = density.squeeze().transpose("site", "part").to_numpy()
        np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-7 * ldos.max())


@pytest.mark.parametrize("theta", [0.0, 0.5])
def test_holes_are_electrons_at_minus_the_energy(theta):
    energies = np.linspace(-0.2, 0.2, 12)
    density = local_density_of_states(WIRE, 0.2, 0.6, energies, theta=theta)
    np.testing.assert_allclose(
        density.LDOS_hole, density.LDOS_electron[:, :, ::-1], rtol=1e-9, atol=1e-12
    )


def test_broadened_it_is_the_convolution_with_the_thermal_kernel():
    """Of a wire whose levels are broad enough for a grid, which is dense where the gap ends."""
    wire = Nanowire(WIRE.potential, dissipation=2e-3)
    u, step = np.linspace(-1, 1.3, 16001, retstep=True)
    u = (u[1:] + u[:-1]) / 2
    energies, widths = wire.delta0 * (1 + u * abs(u)), 2 * wire.delta0 * abs(u) * step
    bare = local_density_of_states(wire, 0.1, 0.5, energies).squeeze()
    for T, energy in ((0.05, 0.0), (0.1, 0.04), (0.1, 0.12)):

        def kernel(omega, kT=BOLTZMANN * T, energy=energy):
            return 1 / (4 * kT * np.cosh(np.clip((omega - energy) / (2 * kT), -300, 300)) ** 2)

        expected = (kernel(energies) * widths) @ bare.LDOS_hole.to_numpy()
        expected += (kernel(-energies) * widths) @ bare.LDOS_electron.to_numpy()
        found = local_density_of_states(wire, 0.1, 0.5, energy, temperature=T).LDOS_hole
        np.testing.assert_allclose(found.squeeze(), expected, rtol=1e-4)


def test_a_level_without_width_is_as_wide_as_the_temperature():
    """Behind high barriers a level is a peak −df/dω of the weight that its mode has."""
    wire = Nanowire(np.zeros(60), alpha=12.0, barrier=(900.0, 900.0))
    found = modes(wire, 0.0, 0.6, 2)
    lowest = found.isel(mode=0)
    energy, T = float(lowest.level), 0.01
    density = local_density_of_states(wire, 0.0, 0.6, energy, temperature=T).squeeze()
    weight = float(lowest.wire_weight) / (4 * BOLTZMANN * T)
    of_charges = (abs(lowest.wave_function) ** 2).to_numpy().reshape(60, 2, 2).sum(axis=2)
    assert float(found.level[1]) - energy > 20 * BOLTZMANN * T
    for k, name in enumerate(BOTH):
        np.testing.assert_allclose(density[name], weight * of_charges[:, k], rtol=3e-3, atol=1e-3)


def test_continued_self_energies_meet_those_on_the_real_axis():
    energies = np.array([-0.3, -0.05, 0.02, 0.11])
    for theta, B in ((0.0, 0.0), (0.0, 0.7), (0.6, 0.7)):
        real = compiled_green.lead_self_energies(WIRE, B, energies, theta)
        near = continued_self_energies(WIRE, B, energies + 1e-8j, theta)
        np.testing.assert_allclose(near, real, atol=1e-7)


def test_a_hair_above_the_real_axis_it_is_the_same(monkeypatch):
    expected = local_density_of_states(WIRE, 0.1, 0.6, ENERGIES)
    monkeypatch.setattr(density_of_states, "GROWTH_LIMIT", 0.0)
    found = local_density_of_states(WIRE, 0.1, 0.6, ENERGIES)
    for name in BOTH:
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-5, atol=1e-7)


def test_where_every_part_of_a_wire_has_a_zero_mode():
    """In the middle of a long gapped wire nothing is at zero energy, and at its ends what leaks."""
    density = local_density_of_states(Nanowire(np.zeros(1000)), 0.0, 0.4, 0.0).squeeze()
    assert np.isfinite(density.LDOS_electron).all()
    np.testing.assert_allclose(density.LDOS_hole, density.LDOS_electron, rtol=1e-3, atol=1e-6)
    assert density.LDOS_electron[400:600].max() < 1e-4 * density.LDOS_electron.max()


def test_blocks_change_nothing(monkeypatch):
    mu = np.linspace(0, 0.5, 5)
    expected = local_density_of_states(WIRE, mu, [0.0, 0.6], ENERGIES, temperature=0.05)
    monkeypatch.setattr(density_of_states, "SIZE", 1)
    found = local_density_of_states(WIRE, mu, [0.0, 0.6], ENERGIES, temperature=0.05)
    np.testing.assert_array_equal(found.LDOS_electron, expected.LDOS_electron)


def test_the_edge_of_the_gap_is_a_number():
    density = local_density_of_states(WIRE, 0.1, 0.6, [-0.12, 0.12])
    assert np.isfinite(density.LDOS_electron).all()
    assert (density.LDOS_electron >= 0).all()


@settings(max_examples=30, deadline=None)
@given(
    sites=st.integers(2, 40),
    seed=st.integers(0, 99),
    mu=st.floats(-1, 5),
    B=st.floats(-2, 2),
    T=st.sampled_from([0.0, 0.01, 0.3]),
    theta=st.sampled_from([0.0, 1.0]),
)
def test_it_is_a_density_of_any_wire(sites, seed, mu, B, T, theta):
    wire = Nanowire(np.random.default_rng(seed).normal(0, 1, sites))
    density = local_density_of_states(wire, mu, B, [-0.1, 0.0, 0.15], T, theta)[BOTH].to_array()
    assert np.isfinite(density).all()
    assert (density > -1e-9).all()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"energy": 200.0}, "Argument energy must lie between"),
        ({"energy": [0.1, 0.0]}, "Argument energy must be a number or an increasing"),
        ({"temperature": -0.1}, "Argument temperature must"),
        ({"wire": 3}, "Argument wire must be a Nanowire"),
    ],
)
def test_what_cannot_be_is_one_sentence(change, says):
    arguments = {"wire": WIRE, "mu": 0.0, "B": 0.0, "energy": 0.0} | change
    with pytest.raises(ArgumentError, match=says):
        local_density_of_states(**arguments)


@pytest.mark.parametrize("temperature", [0.01, 0.3])
def test_energies_far_apart_are_broadened_as_each_alone(temperature):
    together = local_density_of_states(WIRE, 0.1, 0.5, [-0.3, 0.02, 0.021, 0.25], temperature)
    for k, energy in enumerate(together["energy"].to_numpy()):
        alone = local_density_of_states(WIRE, 0.1, 0.5, energy, temperature)
        for name in BOTH:
            one = alone[name].isel(energy=0).to_numpy()
            largest = abs(together[name].to_numpy()).max()
            np.testing.assert_allclose(
                together[name].isel(energy=k).to_numpy(), one, atol=1e-6 * largest
            )
