"""Levels and poles in a tilted field, against dense matrices and what the conductance is."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.linalg import eigvals

from disorder_landscape import Nanowire
from disorder_landscape.model import hamiltonian
from disorder_landscape.model.parameters import BOLTZMANN
from disorder_landscape.solver import compiled, compiled_green, tilted_average
from random_wires import fields, mus, random_wire, seeds

core = compiled.core
BIAS = np.array([-0.04, 0.0, 0.04])
PARTICLE_HOLE = np.kron(np.eye(2), hamiltonian.PARTICLE_HOLE)
angles = st.sampled_from([1e-3, 0.4, np.pi / 2, -2.0])


def ends(wire, mu, B, theta, z):
    return compiled_green.isolated_ends([wire], np.array([mu]), np.array([B]), z, theta)[0, 0, 0]


def levels(wire, mu, B, theta, window, count=10):
    z = tilted_average._above_axis(window, count)
    return core.internals.tilted_levels(z, ends(wire, mu, B, theta, z))


@settings(max_examples=20)
@given(seeds, mus, fields.filter(lambda B: B > 0.01), angles)
def test_levels_that_the_ends_see_are_those_of_the_wire(seed, mu, B, theta):
    wire = random_wire(seed, sites=100)
    E, w = levels(wire, mu, B, theta, 0.08)
    assert (np.diff(E) >= 0).all()
    assert (E >= 0).all()
    exact = compiled.levels([wire], np.array([mu]), np.array([B]), 12, theta)[0, 0, 0]
    seen = (abs(w) ** 2).sum(1) > 1e-7
    for level in E[seen & (E < 0.08) & (E < np.nanmax(exact, initial=0.0))]:
        assert np.nanmin(abs(exact - level)) < 1e-6


@pytest.mark.parametrize(("seed", "theta"), [(1, 0.4), (2, np.pi / 2), (6, -2.0), (9, 1e-3)])
def test_the_levels_make_the_ends_green_function_of_the_wire(seed, theta):
    wire = random_wire(seed, sites=100)
    E, w = levels(wire, 0.2, 0.5, theta, 0.08, 16)
    left_end = np.hstack([w.T, PARTICLE_HOLE @ w.conj().T])[:4]  # which is not rotated
    for omega in (0.0123, 0.047):
        H = hamiltonian.wire_hamiltonian(wire, 0.2, 0.5, omega, theta)
        G = np.linalg.inv(omega * np.eye(len(H)) - H)
        ours = left_end / (omega - np.concatenate([E, -E])) @ left_end.conj().T
        assert_allclose(ours, G[:4, :4], atol=1e-6 * abs(G[:4, :4]).max())


def average_of(wire, B, theta):
    return tilted_average._Average(wire, B, BIAS, BOLTZMANN * 0.05, theta)


def poles_of(wire, mu, B, theta, more=0.0):
    """Return the poles of the ends' F and `more`, their residues, and the average."""
    average = average_of(wire, B, theta)
    z = tilted_average._above_axis(average.window, 10)
    F = ends(wire, mu, B, theta, z) + more
    leads = average.sigma, average.slope
    found = core.tilted_poles(z, F[None], *leads, wire.rotated_hopping, average.window)
    return found[0][0], found[1][0], average


@pytest.mark.parametrize(("theta", "barrier"), [(0.3, (0.0, 0.0)), (-2.5, (5.0, 20.0))])
def test_poles_without_a_parent_are_eigenvalues(theta, barrier):
    """Then nothing but the leads depends on the energy, and all is one linear problem."""
    rng = np.random.default_rng(4)
    wire = Nanowire(rng.normal(0.0, 0.3, 100), gamma=0.0, mass=0.3, barrier=barrier)
    z, residues, average = poles_of(wire, 0.3, 0.7, theta)
    H = hamiltonian.wire_hamiltonian(wire, 0.3, 0.7, 0.0, theta)
    two = average.window * np.array([-1, 1]) / np.sqrt(2)
    below, above = compiled_green.lead_self_energies(wire, 0.7, two, theta)
    slope = (above - below) / (two[1] - two[0])
    K, N = H.astype(complex), np.eye(len(H), dtype=complex)
    for lead, charge in np.ndindex(2, 2):
        at = slice(4 * (len(H) // 4 - 1) * lead + 2 * charge, None)
        at = slice(at.start, at.start + 2)
        K[at, at] += (below - two[0] * slope)[lead, charge]
        N[at, at] -= slope[lead, charge]
    exact = eigvals(K, N)
    near = abs(exact.real) < average.window
    assert near.sum() > 4
    for pole in exact[near]:
        assert abs(z - pole).min() < 1e-9
    counted = abs(residues).max(1) > 1e-9
    assert (
        abs(z[counted][:, None] - exact).min(1)[abs(z[counted].real) < average.window] < 1e-9
    ).all()


@settings(max_examples=20)
@given(seeds, mus, fields.filter(lambda B: B > 0.01), angles)
def test_poles_come_in_pairs_below_the_axis(seed, mu, B, theta):
    wire = replace(random_wire(seed, sites=100), barrier=(3.0, 20.0))
    z, residues, _ = poles_of(wire, mu, B, theta)
    assert (z.imag < 0).all()
    for pole in z[abs(residues).max(1) > 1e-9]:
        assert abs(z + pole.conj()).min() < 1e-9


def test_a_level_that_leads_hardly_reach_adds_hardly_anything():
    wire, B, theta = random_wire(3), 0.5, 0.7
    z, residues, average = poles_of(wire, 0.2, B, theta)
    rng = np.random.default_rng(1)
    w = rng.normal(size=8) + 1j * rng.normal(size=8)
    w *= 1e-4 / np.linalg.norm(w)
    image = PARTICLE_HOLE @ w.conj()
    at = tilted_average._above_axis(average.window, 10)[:, None, None]
    more = np.outer(w, w.conj()) / (at - 0.01) + np.outer(image, image.conj()) / (at + 0.01)
    other, with_level, _ = poles_of(wire, 0.2, B, theta, more)
    assert len(other) == len(z) + 2
    without = average._averaged(z[None], residues[None])
    difference = average._averaged(other[None], with_level[None]) - without
    assert 1e-9 < abs(difference).max() < 5e-5


def test_data_of_no_wire_make_no_model():
    average = average_of(random_wire(3), 0.5, 0.7)
    z = tilted_average._above_axis(average.window, 10)
    F = np.full((1, len(z), 8, 8), np.nan + 0j)
    hop = random_wire(3).rotated_hopping
    poles, residues = core.tilted_poles(z, F, average.sigma, average.slope, hop, average.window)
    assert np.isfinite(poles).all()
    assert np.isnan(residues).all()
