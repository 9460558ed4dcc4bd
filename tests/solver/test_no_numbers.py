"""Where the solver finds no number it says so, or finds it another way."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

import arithmetics
from disorder_landscape import Nanowire
from disorder_landscape.model.parameters import BIAS, BOLTZMANN, TEMPERATURE
from disorder_landscape.solver import compiled, compiled_green
from random_wires import random_wire


def neighbours(x, count):
    """Return the floats around x, `count` on either side."""
    for _ in range(count):
        x = math.nextafter(x, -math.inf)
    for _ in range(2 * count):
        yield x
        x = math.nextafter(x, math.inf)


def wire_of_degenerate_leads(omega, B):
    """Return a wire whose leads, both spins decaying, have one twofold mode at just this energy.

    There r of core/leads/self_energy.hpp is zero, and of Σ rounding leaves 0/0.
    """
    wire = Nanowire(random_wire(3).potential)
    t, s, zeeman = wire.hopping, wire.lead_spin_orbit_hopping, wire.lead_zeeman_per_tesla * B

    def r_squared(lead_mu):
        low = omega + lead_mu
        return s * s * (4 * (s * s) - low * (low - 4 * t)) + (t * t + s * s) * zeeman * zeeman

    below, above = -20.0, 0.0
    while below < (middle := (below + above) / 2) < above:
        below, above = (middle, above) if r_squared(middle) < 0 else (below, middle)
    lead_mu = next(mu for mu in neighbours(below, 40) if r_squared(mu) == 0)
    return replace(wire, lead_mu=lead_mu)


def test_a_check_without_a_number_is_not_passed():
    """The second check of twelve nodes: it has to be done without them."""
    core, B = compiled.core, np.array([0.42])
    window = max(BIAS) + core.REACH * BOLTZMANN * TEMPERATURE
    omega = window * math.sin(math.pi * 2 / (2 * 12))
    wire = wire_of_degenerate_leads(omega, B[0])
    assert np.isnan(compiled_green.lead_self_energies(wire, B[0], np.array([omega]))).any()
    mu = np.array([0.1, 0.3, 0.5])
    _, error, energies = compiled.thermal_conductance([wire], mu, B, np.array(BIAS), TEMPERATURE)
    assert (error < core.TOLERANCE).all()
    assert (energies == sum(nodes + core.COMPARED for nodes in core.NODES[:2])).all()


def test_a_pivot_that_is_zero_is_gone_round():
    """In the complex elimination as well, where its inverse is no number."""
    V, mu, B = np.random.default_rng(0).normal(0, 0.3, 20), np.array([0.25]), np.zeros(1)
    clean = Nanowire(V, alpha=0.0, gamma=0.0)
    V[1] = 0.3 - 2 * clean.hopping + mu[0]
    hop = clean.rotated_hopping
    pivot = 2 * clean.hopping / hop - mu[0] / hop + V[1] / hop  # less ω/t'
    omega = np.array([next(w for w in neighbours(pivot * hop, 3) if w / hop == pivot)])
    wire = [Nanowire(V, alpha=0.0, gamma=0.0)]
    found = arithmetics.complex_conductance(wire, mu, B, omega)
    pivoted = arithmetics.complex_conductance(wire, mu, B, omega, growth_limit=0.0)
    assert_allclose(found, pivoted, rtol=1e-9)
    assert (found[..., :2] > 0).all()


def test_wires_of_another_number_of_parameters_are_refused():
    """Not read beyond what there is of them."""
    for parameters in (np.ones((1, 9)), np.ones((1, 11)), np.ones((2, 10))):
        with pytest.raises(ValueError, match="parameters must be as many rows as V has"):
            compiled.core.lead_self_energies(np.zeros((1, 2)), parameters, 1.0, np.zeros(1), 0.0)
