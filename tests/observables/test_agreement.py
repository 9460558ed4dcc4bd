"""The two solvers, written independently, agree."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from numpy.testing import assert_allclose
from scipy.optimize import brentq

import arithmetics
from disorder_landscape import Nanowire, conductance, topological_visibility
from disorder_landscape.model import hamiltonian
from disorder_landscape.solver import compiled, compiled_green, kwant_reference
from random_wires import energies, fields, mus, random_wire, seeds


def both(wire, mu, B, omega):
    arguments = [wire], np.array([mu]), np.array([B]), np.array([omega])
    return compiled.bare_conductance(*arguments), kwant_reference.bare_conductance(*arguments)


@settings(max_examples=150)
@given(seeds, mus, fields, energies)
@example(0, 0.0, 0.0, 0.0)
@example(3, 0.0, 0.5, 0.0)
@example(4, 0.6, 0.8, 0.11)
def test_conductances_agree(seed, mu, B, omega):
    fast, kwant = both(random_wire(seed), mu, B, omega)
    assert_allclose(fast, kwant, atol=1e-8, rtol=0)


@pytest.mark.slow
def test_ten_thousand_random_conductances_agree():
    rng = np.random.default_rng(7)
    worst = np.empty(10_000)
    for i in range(worst.size):
        fast, kwant = both(
            random_wire(i), rng.uniform(0, 0.6), rng.uniform(0, 0.8), rng.uniform(0, 0.11)
        )
        worst[i] = abs(fast - kwant).max()
    print(f"largest {worst.max():.2e}, {np.mean(worst < 1e-9):.3%} below 1e-9 e²/h")
    assert worst.max() < 1e-6
    assert np.mean(worst < 1e-9) >= 0.999


@settings(max_examples=30)
@given(seeds, mus, fields)
def test_visibilities_agree(seed, mu, B):
    wire = random_wire(seed)
    fast = topological_visibility(wire, mu, B)
    kwant = topological_visibility(wire, mu, B, solver="kwant")
    assert_allclose(fast, kwant, atol=1e-7)


@settings(max_examples=30)
@given(seeds, mus, fields, energies)
def test_leads_and_wires_of_other_parameters_agree(seed, mu, B, omega):
    rng = np.random.default_rng(seed)
    wire = Nanowire(
        rng.normal(0, 0.5, rng.integers(2, 40)),
        alpha=rng.choice([0.0, rng.uniform(0, 30)]),
        g=rng.choice([0.0, rng.uniform(0, 50)]),
        mass=rng.uniform(0.01, 0.1),
        lattice=rng.uniform(5, 20),
        gamma=rng.uniform(0.0, 0.3),
        barrier=tuple(rng.uniform(-5, 30, 2)),
        lead_mu=rng.uniform(1, 40),
        lead_alpha=rng.choice([0.0, rng.uniform(0, 30)]),
        lead_g=rng.uniform(0, 50),
    )
    fast, kwant = both(wire, mu, B, omega)
    assert_allclose(fast, kwant, atol=1e-7)


@pytest.mark.parametrize(("alpha", "B"), [(8.0, 0.4), (8.0, 0.0), (0.0, 0.4), (0.0, 0.0)])
@pytest.mark.parametrize("lead_mu", [25.0, 0.2])
def test_lead_self_energies_are_those_of_kwant(alpha, B, lead_mu):
    wire = Nanowire(np.zeros(2), alpha=alpha, lead_mu=lead_mu)
    system = kwant_reference.build_system(wire)
    for omega in (0.0, 0.03):
        sigma = compiled_green.lead_self_energies(wire, B, np.array([omega]))[0]
        for lead in (0, 1):
            expected = system.leads[lead].selfenergy(omega, params={"B": B})
            ours = np.zeros((4, 4), dtype=complex)
            ours[:2, :2], ours[2:, 2:] = sigma[lead]
            assert_allclose(ours, expected, atol=1e-9)
            assert_allclose(ours, ours.T, atol=1e-10)


def level_of_the_inner_sites(wire, mu, B):
    """Return an ω > 0 at which ω − H(ω) without the two end sites is singular."""

    def levels(omega):
        H = hamiltonian.wire_hamiltonian(wire, mu, B, omega)[4:-4, 4:-4].real
        return np.linalg.eigvalsh(H) - omega

    grid = np.linspace(1e-4, 0.1, 101)
    below = np.array([(levels(omega) < 0).sum() for omega in grid])
    k = np.flatnonzero(np.diff(below))[0]
    level = min(below[k], below[k + 1])
    return brentq(lambda omega: levels(omega)[level], grid[k], grid[k + 1], xtol=1e-15)


def test_a_level_at_the_energy_switches_to_pivoted_elimination():
    """A level of the eliminated piece at ω ruins the real elimination; pivoting saves it."""
    wire = Nanowire(np.random.default_rng(5).normal(0, 0.5, 40))
    mu, B = 0.1, 0.5
    omega = level_of_the_inner_sites(wire, mu, B)
    arguments = [wire], np.array([mu]), np.array([B]), np.array([omega])
    trusting = compiled.bare_conductance(*arguments, growth_limit=np.inf)
    checked = compiled.bare_conductance(*arguments)
    kwant = kwant_reference.bare_conductance(*arguments)
    assert abs(trusting - kwant).max() > 1e-6  # so the check is needed here
    assert_allclose(checked, kwant, atol=1e-9)


@settings(max_examples=20)
@given(seeds, mus, fields, energies)
def test_pivoted_elimination_agrees_everywhere(seed, mu, B, omega):
    arguments = [random_wire(seed)], np.array([mu]), np.array([B]), np.array([omega])
    pivoted = compiled.bare_conductance(*arguments, growth_limit=0.0)
    assert_allclose(pivoted, compiled.bare_conductance(*arguments), atol=1e-8)


def test_lanes_and_threads_leave_no_trace():
    """A grid gives the very bits that its points give one by one, on any number of threads."""
    wires = [random_wire(i) for i in range(3)]
    mu, B, omega = np.linspace(0, 0.6, 5), np.array([0.1, 0.7]), np.linspace(0, 0.1, 7)
    grid = compiled.bare_conductance(wires, mu, B, omega)
    for index in np.ndindex(3, 5, 2, 7):
        w, i, j, k = index
        point = compiled.bare_conductance([wires[w]], mu[i : i + 1], B[j : j + 1], omega[k : k + 1])
        np.testing.assert_array_equal(grid[index], point[0, 0, 0, 0])
    for threads in (1, 3):
        before = compiled.core.set_threads(threads)
        try:
            np.testing.assert_array_equal(grid, compiled.bare_conductance(wires, mu, B, omega))
        finally:
            compiled.core.set_threads(before)


def test_finite_temperature_is_the_same_average_for_both_solvers():
    wire = random_wire(8, sites=40)
    grids = {"mu": [0.1], "B": [0.3, 0.6], "bias": [-0.02, 0.0, 0.03]}
    fast = conductance(wire, **grids, energy_spacing=4e-3)
    kwant = conductance(wire, **grids, energy_spacing=4e-3, solver="kwant")
    for name in fast.data_vars:
        assert_allclose(fast[name], kwant[name], atol=1e-10)


def partly_trivial(sites, topological):
    """Return a wire in which µ is beyond the topological phase past some site."""
    V = np.zeros(sites)
    V[topological:] = 300.0
    return Nanowire(V, alpha=20.0)


MAJORANAS = {
    "600 sites": (Nanowire(np.zeros(600)), 0.3),
    "800 sites": (Nanowire(np.zeros(800)), 0.3),
    "strong": (
        Nanowire(np.zeros(300), alpha=30.0, g=60.0, gamma=1.0, barrier=(100.0, 100.0)),
        1.0,
    ),
    "disorder": (Nanowire(np.random.default_rng(1).normal(0, 0.3, 600), alpha=20.0), 0.5),
    "a part": (partly_trivial(360, 330), 0.5),
}
"""Wires at µ = 0 and a field, in which moderate pivots hid the loss of all digits at ω = 0."""


@pytest.mark.parametrize("name", MAJORANAS)
def test_majorana_modes_leave_enough_digits_at_zero_energy(name):
    wire, B = MAJORANAS[name]
    arguments = [wire], np.zeros(1), np.array([B])
    omega = np.array([0.0])
    kwant = kwant_reference.bare_conductance(*arguments, omega)
    trusting = compiled.bare_conductance(*arguments, omega, growth_limit=np.inf)
    assert abs(trusting - kwant).max() > 1e-11  # so the check is needed here
    for found in (
        compiled.bare_conductance(*arguments, omega),
        arithmetics.complex_conductance(*arguments, omega),
        arithmetics.tilted_conductance(*arguments, omega, 1e-15),
    ):
        assert_allclose(found, kwant, atol=1e-11)
    assert_allclose(
        compiled.reflection_determinant(*arguments),
        kwant_reference.reflection_determinant(*arguments),
        atol=1e-11,
    )


def test_paper_wires_are_seldom_pivoted():
    """At most one lane in a thousand, at ω = 0, where Majorana modes are: pivoting is slow."""
    wires = [Nanowire(np.zeros(300))] + [random_wire(i) for i in range(4)]
    grid = wires, np.linspace(0, 0.6, 15), np.linspace(0, 0.8, 15), np.zeros(1)
    differ = compiled.bare_conductance(*grid) != compiled.bare_conductance(
        *grid, growth_limit=np.inf
    )
    assert differ.any(axis=(-1, -2)).mean() < 1e-3


def test_a_lead_near_its_band_edge_has_modes_for_electrons_or_holes_alone():
    wire = Nanowire(np.random.default_rng(3).normal(0, 0.5, 20), lead_mu=0.02, gamma=0.3)
    fast, kwant = both(wire, 0.3, 0.0, 0.05)
    assert_allclose(fast, kwant, atol=1e-8)


@pytest.mark.parametrize("B", [0.0, 0.3, 1e-9])
@pytest.mark.parametrize("lead_alpha", [0.0, 1e-3, 8.0, 30.0])
@pytest.mark.parametrize("off", [0.0, 1e-12, -1e-9, 1e-6])
def test_self_energies_hold_at_band_edges_and_crossings(B, lead_alpha, off):
    """Where 1 − cos k and the spinors lost digits: Σ = T g T†, g = (E − H₀ − Σ)⁻¹ of the lead."""
    start = Nanowire(np.zeros(2), lead_alpha=lead_alpha)
    t, s, zeeman = start.hopping, start.lead_spin_orbit_hopping, start.lead_zeeman_per_tesla * B
    lowest = 2 * t - 2 * np.hypot(t, s)
    for edge in (zeeman, -zeeman, 4 * t + zeeman, 4 * t - zeeman, lowest, 4 * t - lowest):
        wire = Nanowire(np.zeros(2), lead_alpha=lead_alpha, lead_mu=edge + off)
        sigma = compiled_green.lead_self_energies(wire, B, np.zeros(1))[0, 1, 0]
        T = np.array([[-t, -s], [s, -t]])
        onsite = (2 * t - wire.lead_mu) * np.eye(2) + zeeman * np.array([[0, 1], [1, 0]])
        expected = T @ np.linalg.inv(-onsite - sigma) @ T.T
        assert_allclose(sigma, expected, rtol=0, atol=1e-11 * t)
        assert (np.linalg.eigvalsh(-2 * sigma.imag) > -1e-11 * t).all()  # outgoing


def test_the_outgoing_modes_are_those_that_decay_a_little_above_the_axis():
    """At E + iη all four modes of a lead decay to one side or the other, two of them outwards."""
    rng = np.random.default_rng(6)
    for _ in range(200):
        t = 10 ** rng.uniform(-1, 3)
        s, zeeman = t * 10 ** rng.uniform(-4, 1), t * 10 ** rng.uniform(-4, 0.3)
        mu = rng.choice([0.0, 4 * t, 2 * t]) + t * rng.choice([-1, 1]) * 10 ** rng.uniform(-3, 0)
        parameters = np.array([[t, 0.0, 0.0, 0.0, 1.0, mu, s, zeeman, 0.0, 0.0]])
        arguments = np.zeros((1, 2)), parameters, 1.0, np.zeros(1), 0.0
        sigma = compiled.core.lead_self_energies(*arguments)[0, 1, 0]
        T = np.array([[-t, -s], [s, -t]], dtype=complex)
        H = (2 * t - mu) * np.eye(2) + zeeman * np.array([[0, 1], [1, 0]])
        step, back, surface = T.copy(), T.T.copy(), H - 1e-9j * t * np.eye(2)
        bulk = surface.copy()
        for _ in range(60):  # decimation, at which the lead is twice as long each time
            inverse = np.linalg.inv(-bulk)
            surface = surface + step @ inverse @ back
            bulk = bulk + step @ inverse @ back + back @ inverse @ step
            step, back = step @ inverse @ step, back @ inverse @ back
        expected = T @ np.linalg.inv(-surface) @ T.T
        assert_allclose(sigma, expected, rtol=0, atol=2e-4 * np.hypot(t, s))
