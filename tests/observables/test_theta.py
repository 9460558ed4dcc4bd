"""A field at the angle θ: against Kwant and integrals, symmetries, limits, physics."""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.optimize import brentq

import arithmetics
from disorder_landscape import ArgumentError, Nanowire, conductance, topological_visibility
from disorder_landscape.model import hamiltonian
from disorder_landscape.solver import (
    compiled,
    compiled_green,
    kwant_reference,
    routes,
    tilted_average,
)
from disorder_landscape.solver.quadrature import thermal_quadrature
from disorder_landscape.solver.routes import thermal_average
from random_wires import energies, fields, mus, random_wire, seeds

BIAS = np.array([-0.04, -0.02, 0.0, 0.02, 0.04])
angles = st.one_of(st.floats(-3.2, 3.2), st.sampled_from([np.pi / 2, np.pi, 1e-7]))
barriers = st.tuples(st.floats(-5.0, 30.0), st.floats(-5.0, 30.0))


def bare(wire, mu, B, omega, theta, solve=arithmetics.tilted_conductance, **options):
    arguments = [wire], np.array([mu]), np.array([B]), np.atleast_1d(omega)
    return solve(*arguments, theta=theta, **options)[0, 0, 0]


def visibility(wire, mu, B, theta, solver="fast"):
    return topological_visibility(wire, mu, B, theta=theta, solver=solver).to_numpy().squeeze()


@settings(max_examples=40)
@given(seeds, mus, fields, energies, angles, barriers)
@example(3, 0.0, 0.5, 0.0, 0.3, (15.0, 5.0))
@example(1, 0.1, 0.0, 0.02, 1.0, (15.0, 15.0))
def test_both_solvers_agree(seed, mu, B, omega, theta, barrier):
    wire = replace(random_wire(seed), barrier=barrier)
    kwant = bare(wire, mu, B, omega, theta, kwant_reference.bare_conductance)
    assert_allclose(bare(wire, mu, B, omega, theta), kwant, atol=1e-9, rtol=0)


@settings(max_examples=10)
@given(seeds, mus, fields, angles, barriers)
def test_visibilities_agree(seed, mu, B, theta, barrier):
    wire = replace(random_wire(seed), barrier=barrier)
    kwant = visibility(wire, mu, B, theta, "kwant")
    assert_allclose(visibility(wire, mu, B, theta), kwant, atol=1e-8)


@settings(max_examples=30)
@given(seeds, angles)
def test_lead_self_energies_repeat_themselves_and_are_those_of_kwant(seed, theta):
    """Σ = h(ω − h₀ − Σ)⁻¹h†, one cell further on; Kwant mixes electrons and holes by 1e-6."""
    rng = np.random.default_rng(seed)
    wire = Nanowire(
        np.zeros(2),
        alpha=rng.choice([0.0, rng.uniform(0, 30)]),
        lead_g=rng.choice([0.0, rng.uniform(0, 50)]),
        lead_mu=rng.choice([25.0, rng.uniform(0.2, 40)]),
    )
    omega, B = np.array([0.0, 0.03, 0.5]), rng.uniform(-0.8, 0.8)
    sigma = compiled_green.lead_self_energies(wire, B, omega, theta)
    leads = kwant_reference.build_system(wire, theta).leads
    onsite, hop = hamiltonian.lead_onsite(wire, B, theta), hamiltonian.lead_hopping(wire)
    for (k, energy), lead in product(enumerate(omega), (0, 1)):
        ours = np.zeros((4, 4), dtype=complex)
        ours[:2, :2], ours[2:, 2:] = sigma[k, lead]
        assert_allclose(ours, leads[lead].selfenergy(energy, params={"B": B}), atol=5e-6)
        h = hop if lead == 1 else hop.conj().T
        again = h @ np.linalg.solve(energy * np.eye(4) - onsite - ours, h.conj().T)
        assert_allclose(ours, again, atol=1e-9)
        assert np.linalg.eigvalsh(1j * (ours - ours.conj().T)).min() > -1e-9  # it only absorbs
    straight = compiled_green.lead_self_energies(wire, B, omega, 1e-300)
    assert_allclose(straight, compiled_green.lead_self_energies(wire, B, omega), atol=1e-8)


@pytest.mark.parametrize("theta", [0.0, 0.4, -2.0])
def test_the_hamiltonian_has_the_stated_symmetries(theta):
    """C H(ω)* C = −H(−ω); θ → π − θ is a rotation by σy; θ → −θ is transposition."""
    wire = random_wire(3, sites=12)
    C, Y = (np.kron(np.eye(12), m) for m in (hamiltonian.PARTICLE_HOLE, hamiltonian.SIGMA_Y))
    H = partial(hamiltonian.wire_hamiltonian, wire, 0.2, 0.5)
    assert_allclose(C @ H(0.04, theta).conj() @ C, -H(-0.04, theta), atol=1e-14)
    assert_allclose(Y @ H(0.04, theta) @ Y, H(0.04, np.pi - theta), atol=1e-14)
    assert_allclose(H(0.04, theta).T, H(0.04, -theta), atol=1e-14)
    assert_allclose(H(0.04, theta), H(0.04, theta).conj().T, atol=1e-14)
    assert np.isrealobj(np.real_if_close(H(0.04, theta))) == (theta == 0)


@settings(max_examples=10)
@given(seeds, mus, fields, energies, angles)
def test_symmetries(seed, mu, B, omega, theta):
    """Rotation by σy, mirror, particle–hole symmetry, transposition."""
    wire = random_wire(seed)
    G = bare(wire, mu, B, omega, theta)
    assert_allclose(bare(wire, mu, B, omega, np.pi - theta), G, atol=1e-8)
    assert_allclose(bare(wire, mu, -B, omega, theta + np.pi), G, atol=1e-8)
    mirrored = Nanowire(wire.potential[::-1], alpha=wire.alpha)
    assert_allclose(bare(mirrored, mu, B, omega, -theta)[..., [1, 0, 3, 2]], G, atol=1e-8)
    assert_allclose(bare(wire, mu, B, -omega, theta)[:, ::-1], G, atol=1e-8)
    # H(−θ) = H(θ)ᵀ: incoming and outgoing swap, so that T_ee from L to R is that from R to L
    assert_allclose(
        bare(wire, mu, B, omega, -theta)[..., 2:].sum((1, 2)), G[..., 2:].sum((1, 2)), atol=1e-8
    )


@settings(max_examples=10)
@given(seeds, mus, fields, energies, angles)
def test_the_scattering_matrix_is_unitary(seed, mu, B, omega, theta):
    """N − R_ee + R_he, which is what is calculated, is 2 R_he + T_ee + T_he of Kwant's matrix."""
    wire, grids = random_wire(seed), (np.array([mu]), np.array([B]), np.array([omega]))
    S = next(kwant_reference.scattering_matrices(wire, *grids, theta))[1]
    assert_allclose(S.data.conj().T @ S.data, np.eye(len(S.data)), atol=1e-9)
    G = bare(wire, mu, B, omega, theta)[0, 0]
    for lead in (0, 1):
        out = [((lead, 1), 2), ((1 - lead, 0), 1), ((1 - lead, 1), 1)]
        net = sum(weight * S.transmission(to, (lead, 0)) for to, weight in out)
        assert_allclose(G[lead], net, atol=1e-8)


@settings(max_examples=10)
@given(seeds, mus, fields, st.one_of(energies, st.floats(0.13, 0.5)))
def test_at_no_angle_it_is_the_real_recursion(seed, mu, B, omega):
    wire = random_wire(seed)
    below = omega < wire.delta0
    solve = compiled.bare_conductance if below else arithmetics.complex_conductance
    straight = solve([wire], np.array([mu]), np.array([B]), np.array([omega]))
    assert_allclose(bare(wire, mu, B, omega, 0.0), straight[0, 0, 0], atol=1e-8)
    assert_allclose(bare(wire, mu, B, omega, np.pi), straight[0, 0, 0], atol=1e-8)


def test_it_is_continuous_in_the_angle():
    wire = random_wire(1)
    straight = conductance(wire, 0.2, 0.5, BIAS)
    slightly = conductance(wire, 0.2, 0.5, BIAS, theta=1e-6)
    much = conductance(wire, 0.2, 0.5, BIAS, theta=0.5)
    for name in ("G_LL", "G_RR", "G_LR", "G_RL"):
        assert_allclose(slightly[name], straight[name], atol=2e-5)
    assert abs(much["G_LL"] - straight["G_LL"]).max() > 1e-3


@settings(max_examples=10)
@given(seeds, mus, fields, energies, angles)
def test_pivoting_changes_nothing(seed, mu, B, omega, theta):
    wire = random_wire(seed)
    pivoted = bare(wire, mu, B, omega, theta, growth_limit=0.0)
    assert_allclose(pivoted, bare(wire, mu, B, omega, theta), atol=1e-8)


def test_a_level_of_the_inner_sites_switches_to_pivoting():
    wire, theta = Nanowire(np.random.default_rng(5).normal(0, 0.5, 40)), 0.7

    def levels(omega):
        H = hamiltonian.wire_hamiltonian(wire, 0.1, 0.5, omega, theta)[4:-4, 4:-4]
        return np.linalg.eigvalsh(H) - omega

    grid = np.linspace(1e-4, 0.1, 101)
    below = np.array([(levels(omega) < 0).sum() for omega in grid])
    k = np.flatnonzero(np.diff(below))[0]
    level = min(below[k], below[k + 1])
    omega = brentq(lambda omega: levels(omega)[level], grid[k], grid[k + 1], xtol=1e-15)
    kwant = bare(wire, 0.1, 0.5, omega, theta, kwant_reference.bare_conductance)
    trusting = bare(wire, 0.1, 0.5, omega, theta, growth_limit=np.inf)
    assert abs(trusting - kwant).max() > 1e-8
    assert_allclose(bare(wire, 0.1, 0.5, omega, theta), kwant, atol=1e-9)


@pytest.mark.parametrize(
    ("seed", "mu", "B", "theta", "temperature"),
    [
        (0, 0.3, 0.5, 0.5, 0.05),
        (1, 0.0, 0.4, 1.2, 0.02),
        (5, 0.45, 0.8, -0.3, 0.05),
        (7, 0.1, 0.3, np.pi / 2, 0.04),
    ],
)
def test_the_average_is_the_integral(seed, mu, B, theta, temperature):
    wire = replace(random_wire(seed), barrier=(15.0, 8.0))
    arguments = [wire], np.array([mu]), np.array([B]), BIAS, temperature
    G, error, energies_ = thermal_average(*arguments, theta)
    brute = thermal_quadrature(*arguments, tolerance=1e-7, panel=0.2, theta=theta)
    assert abs(G - brute.conductance).max() < 3e-6
    assert abs(G - brute.conductance).max() < error.max() < tilted_average.TOLERANCE
    assert energies_.max() < 100 < brute.energies.max()


@pytest.mark.parametrize("barrier", [(0.0, 0.0), (15.0, 15.0)])
@pytest.mark.parametrize("B", [0.3, 0.8])
def test_the_average_is_the_integral_with_modes_at_zero_energy_and_with_open_leads(B, barrier):
    """Two poles on the imaginary axis, and poles that are broad and overlap."""
    arguments = [Nanowire(np.zeros(300), barrier=barrier)], np.array([0.1]), np.array([B]), BIAS
    G, error, energies_ = thermal_average(*arguments, 0.05, 0.2)
    brute = thermal_quadrature(*arguments, 0.05, tolerance=1e-7, panel=0.2, theta=0.2)
    assert abs(G - brute.conductance).max() < error.max() < tilted_average.TOLERANCE
    assert energies_.max() < 200 < brute.energies.max()


def test_where_the_model_fails_the_integral_takes_over(monkeypatch):
    monkeypatch.setattr(tilted_average, "NODES", (2,))
    arguments = [random_wire(1)], np.array([0.3]), np.array([0.5]), BIAS[2:3], 0.05
    found = thermal_average(*arguments, 0.5)
    brute = thermal_quadrature(*arguments, theta=0.5)
    np.testing.assert_array_equal(found[0], brute.conductance)


def test_a_grid_is_its_points_and_without_a_field_the_angle_is_nothing():
    wires = [random_wire(i, sites=60) for i in range(2)]
    mu, B = np.array([0.1, 0.4]), np.array([0.0, 0.6])
    grid = thermal_average(wires, mu, B, BIAS, 0.05, 0.5)
    for w, i, j in np.ndindex(2, 2, 2):
        alone = thermal_average([wires[w]], mu[i : i + 1], B[j : j + 1], BIAS, 0.05, 0.5)
        for whole, one in zip(grid, alone, strict=True):
            assert_allclose(whole[w, i, j], one[0, 0, 0], atol=1e-12)
    straight = thermal_average(wires, mu, B, BIAS, 0.05)
    np.testing.assert_array_equal(grid[0][:, :, 0], straight[0][:, :, 0])
    assert abs(grid[0] - straight[0])[:, :, 1].max() > 1e-3


def test_above_the_gap_the_integral_knows_the_angle_too():
    wire = Nanowire(np.random.default_rng(0).normal(0.0, 0.3, 60), barrier=(2.0, 5.0))
    G = conductance(wire, 0.4, 0.8, 0.0, temperature=0.15, theta=1.2)
    mirrored = replace(wire, potential=wire.potential[::-1], barrier=(5.0, 2.0))
    other = conductance(mirrored, 0.4, 0.8, 0.0, temperature=0.15, theta=-1.2)
    straight = conductance(wire, 0.4, 0.8, 0.0, temperature=0.15)
    assert_allclose(G["G_LL"], other["G_RR"], atol=1e-6)
    assert abs(G["G_LL"] - straight["G_LL"]) > 1e-3


def test_an_energy_grid_is_the_same_average_for_both_solvers():
    wire = replace(random_wire(8, sites=40), barrier=(15.0, 3.0))
    grids = {"mu": [0.1], "B": [0.3, 0.6], "bias": [-0.02, 0.0, 0.03]}
    fast = conductance(wire, **grids, energy_spacing=4e-3, theta=0.8)
    kwant = conductance(wire, **grids, energy_spacing=4e-3, theta=0.8, solver="kwant")
    for name in fast.data_vars:
        assert_allclose(fast[name], kwant[name], atol=1e-9)


def test_the_field_along_the_spin_orbit_field_closes_the_topological_phase():
    """θ = π/2: no gap opens at k = 0, and T_IV of the pristine wire is that of no field, +1."""
    wire = Nanowire(np.zeros(300))
    assert visibility(wire, 0.0, 0.4, 0.0)[0] < -0.9
    assert visibility(wire, 0.0, 0.15, np.pi / 2)[0] > 0.9


def test_a_dataset_states_its_settings():
    G = conductance(Nanowire(np.zeros(10), barrier=(1.0, 2.0)), 0.1, 0.2, theta=0.25)
    assert G.attrs["theta"] == 0.25
    assert G.attrs["barrier"] == (1.0, 2.0)
    assert conductance(Nanowire(np.zeros(10)), 0.1, 0.2).attrs["theta"] == 0.0
    two = conductance([Nanowire(np.zeros(10), barrier=(1.0, b)) for b in (1.0, 2.0)], 0.1, 0.2)
    assert "barrier" not in two.attrs


@pytest.mark.parametrize("theta", [np.nan, 30.0, "x", None])
def test_a_wrong_angle_is_one_sentence(theta):
    for function in (conductance, topological_visibility):
        with pytest.raises(ArgumentError, match=r"^Argument theta must be a number .* radians"):
            function(Nanowire(np.zeros(10)), 0.1, 0.2, theta=theta)


@pytest.mark.parametrize("B", [5.6e-17, 1e-9, 1e-5])
def test_in_a_tiny_field_leads_without_spin_orbit_keep_their_digits(B):
    """Spins degenerate to rounding: np.arange gives 5.6e-17 for zero; G_LL was 3.64."""
    wire = Nanowire(np.zeros(300), lead_alpha=0.0)
    found = bare(wire, 0.05, B, 0.03, 0.3)
    assert_allclose(
        found, bare(wire, 0.05, B, 0.03, 0.3, solve=kwant_reference.bare_conductance), atol=1e-8
    )
    arguments = [wire], np.array([0.05]), np.array([B]), BIAS, 0.05
    G, error, _ = thermal_average(*arguments, theta=0.3)
    straight, also_wrong, _ = thermal_average(*arguments)
    assert_allclose(G, straight, rtol=0, atol=(error + also_wrong).item() + 2 * B)


@pytest.mark.parametrize("lead_alpha", [0.0, 1e-6, 1e-2, 8.0])
@pytest.mark.parametrize("B", [1e-17, 1e-10, 1e-6, 1e-3, 0.5])
def test_self_energies_solve_their_equation_at_any_field(lead_alpha, B):
    """Σ = T g T† with g = (E − H₀ − Σ)⁻¹ of the lead, outgoing."""
    wire = Nanowire(np.zeros(2), lead_alpha=lead_alpha)
    t, s = wire.hopping, wire.lead_spin_orbit_hopping
    omega, theta = np.array([0.0, 0.03, -0.07]), 0.3
    T = np.array([[-t, -s], [s, -t]])
    zeeman = hamiltonian.zeeman(wire.lead_zeeman_per_tesla * B, theta)[:2, :2]
    onsite = (2 * t - wire.lead_mu) * np.eye(2) + zeeman
    found = compiled_green.lead_self_energies(wire, B, omega, theta)[:, :, 0]
    for E, pair in zip(omega, found, strict=True):
        for sigma, hop in zip(pair, (T.T, T), strict=True):
            expected = hop @ np.linalg.inv(E * np.eye(2) - onsite - sigma) @ hop.T
            assert_allclose(sigma, expected, rtol=0, atol=1e-11 * t)
            gamma = 1j * (sigma - sigma.conj().T)
            assert (np.linalg.eigvalsh(gamma) > -1e-11 * t).all()


@pytest.mark.parametrize(
    ("seed", "sites", "lead_mu"), [(1, 2, 50.0), (2, 3, 50.0), (3, 7, 1.0), (4, 20, 50.0)]
)
def test_poles_far_outside_the_window_are_left_to_the_smooth_part(seed, sites, lead_mu):
    """Σ as linear in the energy fed some of them, and residues of 1e15 cancelled in the sum."""
    rng = np.random.default_rng([12, seed])
    wire = Nanowire(rng.normal(0, 0.5, sites), lead_mu=lead_mu, barrier=(0.0, 0.0))
    arguments = [wire], np.array([0.3]), np.array([0.4]), BIAS, 0.05
    G, error, _ = routes.closed_form(*arguments, theta=0.7)
    exact = thermal_quadrature(*arguments, theta=0.7)
    assert abs(G - exact.conductance).max() <= 3 * error.item() + exact.error.item()


def test_two_sites_without_a_parent_along_the_spin_orbit_field():
    wire = Nanowire(np.zeros(2), gamma=0.0)
    arguments = [wire], np.array([0.3]), np.array([0.4]), BIAS, 0.05
    G, error, _ = thermal_average(*arguments, theta=np.pi / 2)
    exact = thermal_quadrature(*arguments, theta=np.pi / 2)
    assert abs(G - exact.conductance).max() <= 3 * error.item() + exact.error.item()


def test_a_field_that_rounding_hides_at_the_crossing_of_spins_is_none():
    """The roots are all but twofold: rounding decided on the modes, and G_LL was off by 0.1."""
    wire = Nanowire(np.zeros(2), lead_mu=0.0)
    along = compiled_green.lead_self_energies(wire, 0.0, np.zeros(1), np.pi / 2)
    assert_allclose(
        compiled_green.lead_self_energies(wire, 2e-11, np.zeros(1), np.pi / 2),
        along,
        rtol=0,
        atol=1e-8,
    )
