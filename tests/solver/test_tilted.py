"""The core in a tilted field: against Kwant, itself by another route, and among its variants."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

import arithmetics
from disorder_landscape.model import hamiltonian
from disorder_landscape.solver import compiled, compiled_green, kwant_reference, variants
from random_wires import energies, fields, mus, random_wire, seeds

angles = st.one_of(st.floats(-3.2, 3.2), st.sampled_from([0.0, np.pi / 2, np.pi, 1e-7]))
barriers = st.tuples(st.floats(-5.0, 30.0), st.floats(-5.0, 30.0))
above = st.floats(0.13, 0.5)


def at(mu, B, omega):
    return np.array([mu]), np.array([B]), np.array([omega])


@settings(max_examples=30)
@given(seeds, mus, fields, energies, angles, barriers)
def test_conductances_are_those_of_kwant(seed, mu, B, omega, theta, barrier):
    wire = replace(random_wire(seed, sites=100), barrier=barrier)
    arguments = [wire], *at(mu, B, omega)
    found = arithmetics.tilted_conductance(*arguments, theta)
    expected = kwant_reference.bare_conductance(*arguments, theta)
    assert_allclose(found, expected, atol=1e-9, rtol=0)


@settings(max_examples=15)
@given(seeds, mus, fields, angles, barriers)
def test_determinants_are_those_of_kwant(seed, mu, B, theta, barrier):
    wire = replace(random_wire(seed, sites=100), barrier=barrier)
    arguments = [wire], np.array([mu]), np.array([B]), theta
    found = compiled.reflection_determinant(*arguments)
    assert_allclose(found, kwant_reference.reflection_determinant(*arguments), atol=1e-9, rtol=0)


@settings(max_examples=30)
@given(seeds, mus, fields, st.one_of(energies, above), st.sampled_from([0.0, 1e-3]))
def test_along_the_wire_it_is_the_symmetric_elimination(seed, mu, B, omega, dissipation):
    wire = replace(random_wire(seed, sites=100), dissipation=dissipation)
    arguments = [wire], *at(mu, B, omega)
    symmetric = arithmetics.complex_conductance(*arguments)
    assert_allclose(arithmetics.tilted_conductance(*arguments, 0.0), symmetric, atol=1e-9, rtol=0)


@settings(max_examples=30)
@given(seeds, mus, fields, st.one_of(energies, above), angles)
def test_pivoting_changes_nothing_above_the_gap_either(seed, mu, B, omega, theta):
    arguments = [random_wire(seed, sites=60)], *at(mu, B, omega), theta
    pivoted = arithmetics.tilted_conductance(*arguments, growth_limit=0.0)
    assert_allclose(arithmetics.tilted_conductance(*arguments), pivoted, atol=1e-9, rtol=0)


@pytest.mark.parametrize("theta", [0.4, -2.0])
def test_the_ends_are_those_of_the_inverted_hamiltonian(theta):
    wire, z = random_wire(1, sites=30), np.array([0.02 + 0.003j, 0.05 + 0.001j])
    B, mu = np.array([0.5]), np.array([0.2])
    found = compiled_green.isolated_ends([wire], mu, B, z, theta)[0, 0, 0]
    phi = np.arctan2(wire.spin_orbit_hopping, wire.hopping) * (wire.sites - 1)
    turn = np.kron(np.eye(2), [[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]])
    U = np.kron([[1, 0], [0, 0]], np.eye(4)) + np.kron([[0, 0], [0, 1]], turn)
    ends = np.append(np.arange(4), np.arange(-4, 0))
    for energy, ours in zip(z, found, strict=True):
        H = hamiltonian.wire_hamiltonian(wire, 0.2, 0.5, energy, theta)
        G = np.linalg.inv(energy * np.eye(len(H)) - H)[np.ix_(ends, ends)]
        assert_allclose(ours, U.T @ G @ U, atol=1e-11 * abs(G).max(), rtol=0)


def test_every_variant_gives_the_same(monkeypatch):
    """Without a level at ω, of which rounding, another one without multiply-adds, is amplified."""
    wires = [random_wire(seed, sites=100) for seed in (0, 2, 3)]
    mu, B, theta = np.linspace(0.0, 0.6, 5), np.array([0.0, 1e-9, 0.3, 0.8]), 0.7
    omega, z = np.array([0.0, 0.04, 0.2]), np.array([0.01 + 0.002j, 0.08 + 0.001j])
    results = {}
    for name in variants.supported():
        monkeypatch.setattr(compiled, "core", variants.variant(name))
        results[name] = (
            arithmetics.tilted_conductance(wires, mu, B, omega, theta),
            compiled.reflection_determinant(wires, mu, B, theta),
            compiled_green.isolated_ends(wires, mu, B, z, theta),
            np.array(
                [compiled_green.lead_self_energies(wires[0], field, omega, theta) for field in B]
            ),
        )
    for name, found in results.items():
        for ours, best in zip(found, results[variants.supported()[-1]], strict=True):
            assert_allclose(ours, best, rtol=0, atol=1e-12)
            if name != "baseline":
                assert_array_equal(ours, best)
