"""Averages whose thermal window reaches the gap, in closed form, against the adaptive integral."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import quad
from scipy.stats import logistic

from disorder_landscape.model.disorder import disorder_realization
from disorder_landscape.model.parameters import BIAS, BOLTZMANN, Nanowire
from disorder_landscape.solver import compiled, routes
from disorder_landscape.solver.compiled import thermal_conductance, threads_at_work
from disorder_landscape.solver.quadrature import thermal_quadrature

of_core = compiled.core.internals
CLOSE_TO_THE_GAP = (-0.1, -0.03, 0.09)


def hot_wire(seed):
    """Return a wire of 3 to 30 components, µ and B."""
    rng = np.random.default_rng([12, seed])
    V = disorder_realization(rng, int(rng.choice([3, 5, 10, 30])), 300)[1]
    wire = Nanowire(V, alpha=rng.uniform(6.4, 9.6))
    return wire, np.array([rng.uniform(0, 0.6)]), np.array([rng.uniform(0, 0.8)])


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("temperature", [0.09, 0.1, 0.2, 0.3, 1.0])
@pytest.mark.parametrize("bias", [BIAS, CLOSE_TO_THE_GAP])
def test_it_is_the_integral(seed, temperature, bias):
    wire, mu, B = hot_wire(seed)
    arguments = [wire], mu, B, np.array(bias), temperature
    G, estimate, _ = thermal_conductance(*arguments)
    exact = thermal_quadrature(*arguments, tolerance=1e-6)
    error = abs(G - exact.conductance).max()
    assert error <= 1.5 * estimate.item() + exact.error.item()
    if estimate.item() <= compiled.core.TOLERANCE:  # nearly always
        assert error < 1e-4


@pytest.mark.parametrize("part", [0.96, 0.99, 1.0, 1.01, 1.05])
def test_windows_that_end_around_the_gap(part):
    """Where other nodes are taken from one temperature to the next."""
    wire, mu, B = hot_wire(7)
    bias = np.array([-0.07, 0.0, 0.03])
    temperature = (part * wire.delta0 - 0.07) / (compiled.core.REACH * BOLTZMANN)
    assert routes.stays_below_gap([wire], bias, temperature) == (part < routes.BELOW_GAP)
    G, _, _ = thermal_conductance([wire], mu, B, bias, temperature)
    exact = thermal_quadrature([wire], mu, B, bias, temperature)
    assert_allclose(G, exact.conductance, rtol=0, atol=3e-5)


def test_wires_of_other_gaps_do_not_know_of_each_other():
    wire, mu, B = hot_wire(1)
    wires = [wire, replace(wire, delta0=0.3), replace(wire, gamma=0.1), replace(wire, delta0=0.13)]
    mu, B, bias = np.append(mu, 0.7), np.append(B, 1.0), np.array(BIAS)
    together = thermal_conductance(wires, mu, B, bias, 0.2)
    for w, one in enumerate(wires):
        alone = thermal_conductance([one], mu, B, bias, 0.2)
        for all_of_them, its_own in zip(together, alone, strict=True):
            assert_array_equal(all_of_them[w], its_own[0])
    with threads_at_work(1):
        for many, one in zip(together, thermal_conductance(wires, mu, B, bias, 0.2), strict=True):
            assert_array_equal(many, one)


@pytest.mark.parametrize("wire", [Nanowire(np.zeros(2)), Nanowire(np.zeros(40), gamma=0.0)])
def test_wires_without_levels_or_parent(wire):
    """Above the gap a wire without a parent has narrow levels: the estimate tells."""
    arguments = [wire], np.array([0.2]), np.array([0.3]), np.array(BIAS), 0.2
    exact = thermal_quadrature(*arguments)
    found = routes.thermal_average(*arguments)
    assert_allclose(found.conductance, exact.conductance, rtol=0, atol=1e-4)
    assert found.error.item() < 1e-4


@pytest.mark.parametrize("temperature", [0.1, 0.3, 1.0])
@pytest.mark.parametrize("sites", [60, 300])
def test_a_smooth_function_is_averaged_rightly(temperature, sites):
    """To what is cut of the kernel, eleven kT from the bias."""
    wire, bias, kT = Nanowire(np.zeros(sites)), np.array([-0.1, 0.0, 0.04]), BOLTZMANN * temperature
    handed_over = compiled.handed_over([wire])
    below, above, weights = of_core.averages_to_gap(*handed_over, bias, kT, 24)
    assert (np.sort(above) == above).all()
    assert above[0] > wire.delta0 > below.max()
    energies = np.concatenate([below, -below, above, -above])

    def smooth(omega):
        return np.exp(-3 * omega**2) + omega / (1 + 5 * omega**2)

    def averaged(V):
        def integrand(omega):
            return smooth(omega) * logistic.pdf((omega - V) / kT) / kT

        return quad(integrand, V - 40 * kT, V + 40 * kT, points=[V], limit=500, epsabs=1e-10)[0]

    assert_allclose(weights.sum(axis=1), 1, atol=1e-7)
    expected = [averaged(V) for V in bias]
    assert_allclose(weights @ smooth(energies), expected, rtol=0, atol=5e-5)


@pytest.fixture
def asked(monkeypatch):
    """Return what the quadrature has been asked for."""
    asked = []

    def quadrature(*arguments, **settings):
        asked.append(arguments)
        return thermal_quadrature(*arguments, **settings)

    monkeypatch.setattr(routes, "thermal_quadrature", quadrature)
    return asked


@pytest.mark.brute_force
@pytest.mark.parametrize("temperature", [0.02, 0.05])
@pytest.mark.parametrize(
    "material",
    [
        {},
        {"alpha": 30, "mass": 0.014, "g": 40, "gamma": 0.2, "delta0": 0.25},
        {"alpha": 20, "mass": 0.023, "g": 15, "gamma": 0.2, "delta0": 0.25},
    ],
)
def test_neither_do_cold_wires_with_biases_next_to_the_gap(material, temperature, asked):
    """Kernels at smaller biases end below it. All of these sets were integrated."""
    wire = Nanowire(np.random.default_rng(1).normal(0, 0.3, 150), **material)
    bias = 0.9 * wire.delta0 * np.linspace(-1, 1, 5)
    point = [wire], np.array([0.2, 0.5]), np.array([0.2, 0.6]), bias, temperature
    found = routes.thermal_average(*point)
    assert not asked
    exact = thermal_quadrature(*point)
    off = abs(found.conductance - exact.conductance).max(axis=(3, 4))
    assert (off < found.error + exact.error).all()


def test_the_paper_s_wires_need_no_quadrature(asked):
    """At 100, 200 and 300 mK and the paper's biases: at most one of 150 does."""
    wire, _, _ = hot_wire(3)
    mu, B = np.linspace(0.03, 0.57, 5), np.linspace(0.04, 0.76, 10)
    for temperature in (0.1, 0.2, 0.3):
        found = routes.thermal_average([wire], mu, B, np.array(BIAS), temperature)
        assert (found.error < 1e-4).all()
    assert len(asked) <= 1
