"""The adaptive thermal integral: its error estimate, its limits, and simpler integrals."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import expit

from disorder_landscape import Nanowire, conductance
from disorder_landscape.arguments import ArgumentError
from disorder_landscape.model.parameters import BOLTZMANN
from disorder_landscape.solver import compiled, quadrature
from disorder_landscape.solver.quadrature import thermal_quadrature
from random_wires import random_wire

BIAS = np.array([-0.05, -0.02, 0.0, 0.02, 0.05])
POINTS = [(1, 0.3, 0.5), (2, 0.1, 0.0), (6, 0.45, 0.7)]


def thermal(wire, mu, B, temperature, bias=BIAS, **options):
    return thermal_quadrature(
        [wire], np.array([mu]), np.array([B]), np.asarray(bias), temperature, **options
    )


def test_the_rules_are_those_of_gauss_and_kronrod():
    x, w = np.polynomial.legendre.leggauss(7)
    assert_allclose(quadrature.NODES[1::2], x, atol=1e-15)
    assert_allclose(quadrature.WEIGHTS[1, 1::2], w, atol=1e-15)
    powers = quadrature.WEIGHTS[0] @ quadrature.NODES[:, None] ** np.arange(0, 23, 2)
    assert_allclose(powers, 2 / np.arange(1, 24, 2), atol=1e-15)


@pytest.mark.brute_force
@pytest.mark.parametrize("temperature", [0.02, 0.05, 0.1, 0.3])
@pytest.mark.parametrize(("seed", "mu", "B"), POINTS)
def test_the_estimate_bounds_the_error(seed, mu, B, temperature):
    wire = random_wire(seed)
    finer = {"panel": 0.025, "tolerance": 1e-8, "reach": 20.0}
    exact = thermal(wire, mu, B, temperature, **finer).conductance
    found = thermal(wire, mu, B, temperature)
    coarse = thermal(wire, mu, B, temperature, panel=0.5, tolerance=1e-5)
    for G, error, _ in (found, coarse):
        assert np.isfinite(G).all()
        assert abs(G - exact).max() <= error.max()
    assert found.error.max() < 1e-5
    assert coarse.energies.max() < found.energies.max()


def test_the_energy_grid_converges_to_it():
    wire, kT, spacing = random_wire(1), BOLTZMANN * 0.05, 2e-5
    G = thermal(wire, 0.3, 0.5, 0.05).conductance[0, 0, 0]
    edges = np.arange(0.0, 0.117, spacing)
    omega = (edges[1:] + edges[:-1]) / 2
    G0 = compiled.bare_conductance([wire], np.array([0.3]), np.array([0.5]), omega)[0, 0, 0]
    weights = [np.diff(expit((edges + s * BIAS[:, None]) / kT), axis=1) for s in (-1, 1)]
    assert_allclose(np.einsum("svk,ksg->vg", weights, G0), G, atol=2e-3)


@pytest.mark.brute_force
@pytest.mark.parametrize(("seed", "mu", "B"), POINTS)
def test_it_is_continuous_where_the_window_passes_the_gap(seed, mu, B):
    """The gap enters the window at 51 mK: G(T) from 50 to 70 mK has no kink there."""
    T = np.linspace(0.050, 0.070, 9)
    G = np.array([thermal(random_wire(seed), mu, B, t).conductance[0, 0, 0] for t in T])
    line = np.polynomial.Polynomial.fit
    scale = abs(np.ptp(G, axis=0)).max()
    for curve in G.reshape(T.size, -1).T:
        assert_allclose(line(T, curve, 4)(T), curve, atol=2e-3 * scale)


def test_a_bias_beyond_the_gap_and_any_temperature():
    wire = random_wire(3, sites=40)
    bias = np.array([-0.3, -0.12, 0.0, 0.12, 0.3])
    for temperature in (1e-4, 0.01, 1.0, 10.0):
        found = thermal(wire, 0.3, 0.4, temperature, bias)
        assert np.isfinite(found.conductance).all()
        assert found.error.max() < 1e-5


def test_the_coldest_is_the_bare_conductance():
    wire = Nanowire(np.zeros(20), barrier=(5.0, 5.0))
    cold = thermal(wire, 0.3, 0.4, 1e-4, bias=[-0.05, 0.05]).conductance[0, 0, 0]
    arguments = [wire], np.array([0.3]), np.array([0.4]), np.array([0.05])
    assert_allclose(cold, compiled.bare_conductance(*arguments)[0, 0, 0, 0, ::-1], atol=1e-4)


@pytest.mark.parametrize("gamma", [0.0, 0.15])
def test_the_shortest_wire_and_one_without_a_parent(gamma):
    found = thermal(Nanowire(np.zeros(2), gamma=gamma), 0.3, 0.4, 0.3)
    assert np.isfinite(found.conductance).all()
    assert found.error.max() < 1e-5


def test_a_grid_is_its_points_one_by_one():
    wires = [random_wire(i, sites=20) for i in range(2)]
    wires.append(Nanowire(np.zeros(20), delta0=0.2))
    mu, B = np.array([0.1, 0.4]), np.array([0.2, 0.6])
    grid = thermal_quadrature(wires, mu, B, BIAS, 0.1)
    for w, i, j in np.ndindex(3, 2, 2):
        alone = thermal(wires[w], mu[i], B[j], 0.1)
        for whole, one in zip(grid, alone, strict=True):
            assert_allclose(whole[w, i, j], one[0, 0, 0], rtol=0, atol=0)


@pytest.mark.parametrize("temperature", [0.0, -0.1, np.nan])
def test_a_temperature_that_is_not_positive_is_refused(temperature):
    with pytest.raises(ArgumentError, match="temperature must be positive"):
        thermal(random_wire(0), 0.1, 0.1, temperature)


def test_what_is_no_number_has_an_infinite_error_and_a_warning(monkeypatch):
    def failing(wires, mu, B, omega, theta):
        return np.full((len(wires), mu.size, B.size, omega.size, 2, 4), np.nan)

    monkeypatch.setattr(compiled, "bare_conductance", failing)
    found = thermal(random_wire(1, sites=10), 0.3, 0.5, 0.05)
    assert found.error == np.inf
    with pytest.warns(RuntimeWarning, match="At 1 of 1 points"):
        conductance(random_wire(1, sites=10), 0.3, 0.5, temperature=0.0)
