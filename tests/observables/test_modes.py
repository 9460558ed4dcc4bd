"""Levels, wave functions and Majorana components: against dense matrices, and what they must be."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from disorder_landscape import ArgumentError, Nanowire, gap, modes
from disorder_landscape.inside_wire import look_inside, plot_inside
from disorder_landscape.model.hamiltonian import PARTICLE_HOLE, wire_hamiltonian
from disorder_landscape.observables.visibility import transition_field
from disorder_landscape.solver import compiled

WIRE = Nanowire(np.random.default_rng(0).normal(0, 0.2, 40))


def dense_levels(wire, mu, B, count, theta=0.0):
    """Return the lowest levels above zero: each eigenvalue of H(ω) minus ω falls, and has one zero.

    Counted from the middle, where half of the levels are below zero.
    """

    def eigenvalue(omega, number):
        H = wire_hamiltonian(wire, mu, B, omega, theta)
        return np.linalg.eigvalsh(H)[2 * wire.sites + number] - omega

    return [
        brentq(eigenvalue, 0, wire.delta0 * (1 - 1e-9), args=(number,), xtol=1e-14)
        for number in range(count)
    ]


@pytest.mark.parametrize("theta", [0.0, 0.3])
@pytest.mark.parametrize("B", [0.0, 0.5, 0.9])
def test_levels_are_those_of_the_dense_matrix(B, theta):
    levels = compiled.levels([WIRE], np.array([0.1]), np.array([B]), 5, theta)[0, 0, 0]
    np.testing.assert_allclose(levels, dense_levels(WIRE, 0.1, B, 5, theta), atol=2e-12)


@settings(max_examples=60, deadline=None)
@given(
    sites=st.integers(8, 60),
    seed=st.integers(0, 999),
    mu=st.floats(-1, 3),
    B=st.floats(-1.5, 1.5),
    theta=st.sampled_from([0.0, 0.2, 1.5]),
    strength=st.sampled_from([0.0, 0.1, 1.0]),
)
def test_modes_of_any_wire_solve_its_equation(sites, seed, mu, B, theta, strength):
    wire = Nanowire(np.random.default_rng(seed).normal(0, strength, sites))
    found = modes(wire, mu, B, 2, theta)
    waves = found.wave_function.to_numpy().reshape(2, -1)
    for E, wave in zip(found.level.to_numpy(), waves, strict=True):
        H = wire_hamiltonian(wire, mu, B, E, theta)
        slope = 1 + wire.gamma * wire.delta0**2 / (wire.delta0**2 - E**2) ** 1.5
        assert np.linalg.norm(H @ wave - E * wave) < 1e-11 * slope + 1e-9  # slope: of Σ towards Δ₀
    np.testing.assert_allclose(np.linalg.norm(waves, axis=1), 1)
    assert (np.diff(found.level) >= 0).all()
    assert found.wire_weight.min() > 0
    assert found.wire_weight.max() <= 1
    A, other = found.majorana_A.to_numpy(), found.majorana_B.to_numpy()
    for gamma in (A, other):
        np.testing.assert_allclose(gamma.conj() @ PARTICLE_HOLE.T, gamma, atol=1e-12)
        assert np.linalg.norm(gamma) == pytest.approx(1)
    together = (A + 1j * other).ravel() / np.sqrt(2)
    assert abs(np.vdot(together, waves[0])) == pytest.approx(1, abs=1e-6)
    assert -1e-9 <= float(found.overlap) <= 1 + 1e-9


def test_kramers_pairs_have_two_wave_functions():
    found = modes(WIRE, 0.1, 0.0, 4)
    waves = found.wave_function.to_numpy().reshape(4, -1)
    assert found.level[1] - found.level[0] < 1e-11
    np.testing.assert_allclose(abs(waves.conj() @ waves.T)[0, :2], [1, 0], atol=1e-9)


def test_majorana_modes_sit_at_the_ends_however_small_their_splitting():
    """Of a long clean wire: E falls below what rounding of H leaves, the components stay apart."""
    for sites in (800, 1500, 3000):
        wire = Nanowire(np.zeros(sites), alpha=20.0)
        found = modes(wire, 0.0, 0.9)
        weights = [(abs(found[f"majorana_{k}"]) ** 2).sum("nambu") for k in "AB"]
        assert float(found.level[0]) < 1e-5
        assert float(found.overlap) < 1e-2
        assert weights[0][: sites // 3].sum() > 0.999
        assert weights[1][-sites // 3 :].sum() > 0.999


def test_chirality_parts_the_components_without_a_tilt():
    """At θ = 0 γ_A and γ_B are the parts of ψ with C = ±1, which no position enters."""
    found = modes(WIRE, 0.1, 0.9)
    wave = found.wave_function[0].to_numpy()
    parts = [wave + sign * wave @ PARTICLE_HOLE.T for sign in (1, -1)]
    for gamma in (found.majorana_A, found.majorana_B):
        overlaps = [abs(np.vdot(gamma, part)) / np.linalg.norm(part) for part in parts]
        assert sorted(overlaps) == pytest.approx([0, 1], abs=1e-8)


def test_the_weight_in_the_wire_is_how_fast_the_level_moves():
    """A shift of all potentials' τz by δ moves a level by δ⟨τz⟩ times the weight in the wire."""
    step = 1e-5
    found = modes(WIRE, 0.1, 0.6, 2)
    moved = [
        compiled.levels([WIRE], np.array([0.1 + s * step]), np.array([0.6]), 2)[0, 0, 0]
        for s in (1, -1)
    ]
    charge = (abs(found.wave_function) ** 2).sum("site").to_numpy() @ np.array([1, 1, -1, -1])
    expected = -found.wire_weight * charge
    np.testing.assert_allclose((moved[0] - moved[1]) / (2 * step), expected, rtol=1e-5)


def test_the_gap_of_a_clean_wire_closes_at_the_transition():
    wire = Nanowire(np.zeros(600))
    critical = float(transition_field(wire, 0.0))
    B = critical + np.array([-0.1, 0.0, 0.1])
    found = gap(wire, 0.0, B).squeeze()
    assert found.excitation_gap[1] < 0.2 * found.excitation_gap[[0, 2]].min()
    assert found.excitation_gap[0] == found.E_1[0]
    assert found.excitation_gap[2] == found.E_2[2]
    for k in (0, 2):  # both gaps are the same in a clean wire, to the temperature
        assert float(found.transport_gap[k]) == pytest.approx(
            float(found.excitation_gap[k]), abs=5e-3
        )


def test_the_gap_of_several_wires_is_that_of_each():
    wires = [WIRE, Nanowire(WIRE.potential[::-1])]
    both = gap(wires, [0.0, 0.2], [0.3, 0.8])
    for k, wire in enumerate(wires):
        one = gap(wire, [0.0, 0.2], [0.3, 0.8])
        xr.testing.assert_allclose(both.isel(realization=k), one)
    np.testing.assert_allclose(both.E_1[0], both.E_1[1], atol=2e-12)  # the mirror changes no level


def test_the_excitation_gap_stays_open_where_zero_modes_split():
    """Far above the transition of a short clean wire, where det r changes its sign with E_1."""
    B = np.linspace(0.4, 1.3, 19)
    found = gap(Nanowire(np.zeros(300)), 0.0, B).squeeze()
    np.testing.assert_array_equal(found.excitation_gap, found.E_2)
    assert found.E_2.min() > 0.02
    assert found.E_1.max() > 0.003


def test_a_gap_depends_on_no_other_field_or_wire():
    wires = [Nanowire(WIRE.potential, critical_field=0.9), Nanowire(WIRE.potential, delta0=0.05)]
    both = gap(wires, 0.1, [0.3, 0.6, 0.89])
    for k, wire in enumerate(wires):
        for field in (0.3, 0.6):
            one = gap(wire, 0.1, field).squeeze()
            xr.testing.assert_allclose(both.isel(realization=k, mu=0).sel(B=field), one)
    assert np.isnan(both.transport_gap[0, 0, 2])  # no bias whose window is below what is left


def test_what_carries_nothing_has_no_transport_gap():
    wire = Nanowire(2 * np.random.default_rng(0).normal(size=400))
    assert np.isnan(gap(wire, 0.0, 0.1).transport_gap).all()


def test_what_a_wire_looks_like_is_drawn(tmp_path):
    result = look_inside(WIRE, 0.1, 0.8, 3, np.linspace(-0.1, 0.1, 21), 0.05, 0.0)
    assert not any(np.iscomplexobj(variable) for variable in result.variables.values())
    np.testing.assert_allclose((result.wave_function**2).sum(("site", "nambu", "part")), 1)
    for energies in (result, look_inside(WIRE, 0.1, 0.8, 1, np.array([0.0]), 0.0, 0.2)):
        plot_inside(energies, tmp_path / "inside.png")
        assert (tmp_path / "inside.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"count": 81}, "Argument count must be a number from 1 to 80"),
        ({"count": 0}, "Argument count must"),
        ({"mu": [0.0, 1.0]}, "Argument mu must be a number"),
        ({"wire": Nanowire(np.zeros(5), dissipation=0.01)}, "have no dissipation"),
        ({"wire": Nanowire(np.zeros(5), gamma=0.0), "count": 9}, "there are [0-9]+, not 9"),
    ],
)
def test_what_cannot_be_is_one_sentence(change, says):
    with pytest.raises(ArgumentError, match=says):
        modes(**{"wire": WIRE, "mu": 0.0, "B": 0.5, "count": 1} | change)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"temperature": 0.0}, "Argument temperature must be above 0"),
        ({"threshold": 2.0}, "Argument threshold must"),
        ({"wire": Nanowire(np.zeros(5), dissipation=0.01)}, "have no dissipation"),
    ],
)
def test_a_gap_that_cannot_be_is_one_sentence(change, says):
    with pytest.raises(ArgumentError, match=says):
        gap(**{"wire": WIRE, "mu": 0.0, "B": 0.5} | change)
