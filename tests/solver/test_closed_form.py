"""Sets whose poles or levels are hard to find are in closed form all the same, and right."""

import numpy as np
import pytest

from disorder_landscape import Nanowire
from disorder_landscape.model.disorder import smooth_noise
from disorder_landscape.solver import compiled, routes
from disorder_landscape.solver.quadrature import thermal_quadrature
from disorder_landscape.studies.odd_cases import warm_case

BIAS = np.linspace(-0.04, 0.04, 5)


def smooth_wire(index):
    """Return one of some wires with smooth disorder that are drawn one after the other."""
    rng = np.random.default_rng(1)
    for _ in range(index + 1):
        V = smooth_noise(rng, 300, 3, "sum", 0.8)
    return Nanowire(V - V.mean())


def check(wire, mu, B, bias, temperature):
    arguments = [wire], np.atleast_1d(mu), np.atleast_1d(B), bias, temperature
    G, error, _ = routes.closed_form(*arguments, theta=0.0)
    assert error.item() <= compiled.core.TOLERANCE
    exact = thermal_quadrature(*arguments)
    assert abs(G - exact.conductance).max() < error.item() + exact.error.item()


@pytest.mark.parametrize("temperature", [0.1, 0.2, 0.3])
def test_a_pole_beyond_the_gap(temperature):
    """The error that it makes where the samples are was taken for one of 1e63 e²/h."""
    check(smooth_wire(2), 4.2 * 16 / 47, 1.2 / 9, BIAS, temperature)


@pytest.mark.parametrize(
    ("index", "mu", "B"), [(30, 4.2 * 31 / 47, 6 / 9), (32, 4.2 * 39 / 47, 1.2 / 9)]
)
def test_a_level_of_inner_sites_where_the_model_is_checked(index, mu, B):
    """Elimination without pivots loses digits at that energy, the same in every round of nodes."""
    check(smooth_wire(index), mu, B, np.linspace(-0.04, 0.04, 21), 0.05)


@pytest.mark.parametrize("index", [19, 80, 528, 1072])
def test_poles_too_faint_to_carry_anything_may_stand_twice(index):
    (wire, mu, B, theta), bias, temperature = warm_case(0, index)
    assert theta == 0
    check(wire, mu, B, bias, temperature)
