"""Rough derivatives by V, against those that are exact."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.solver import compiled_gradients, gradients
from disorder_landscape.solver.rough_gradient import roughly_by_potential
from random_wires import random_wire

MU, B, BIAS = np.linspace(0.1, 1.5, 4), np.array([0.2, 0.6]), np.array([-0.04, -0.01, 0.02])


def exact(wire, bias, temperature):
    return gradients.at_a_temperature(wire, MU, B, bias, temperature, ["V"], complete=False)


@pytest.mark.parametrize(
    ("temperature", "dissipation", "critical_field"),
    [(0.05, 0.0, np.inf), (0.02, 0.0, 2.0), (0.06, 0.0, np.inf), (0.05, 1e-3, np.inf)],
)
def test_they_are_within_a_few_percent(temperature, dissipation, critical_field):
    off = []
    for seed in range(4):
        wire = random_wire(seed, sites=200)
        wire = replace(wire, dissipation=dissipation, critical_field=critical_field)
        found = roughly_by_potential(wire, MU, B, BIAS, temperature)
        right = exact(wire, BIAS, temperature)
        assert found.by["V"].shape == (MU.size, B.size, BIAS.size, len(CONDUCTANCES), 200)
        assert_allclose(found.conductance, right.conductance, rtol=0, atol=2e-4)
        assert (found.gradient_error == 0).all()
        size = abs(right.by["V"]).max(axis=(2, 3, 4))
        off.append(abs(found.by["V"] - right.by["V"]).max(axis=(2, 3, 4)) / size)
    assert 1e-5 < np.median(off) < 0.01
    assert np.quantile(off, 0.9) < 0.05


def test_next_to_the_gap_they_are_as_exact_as_others():
    wire, bias = random_wire(2, sites=60), np.array([0.0, 0.15])
    right = exact(wire, bias, 0.3)
    found = roughly_by_potential(wire, MU, B, bias, 0.3)
    assert_allclose(found.by["V"], right.by["V"], rtol=0, atol=1e-9)


def test_sets_without_a_model_have_none(monkeypatch):
    core_of = compiled_gradients.thermal_gradient

    def none_at_first(*arguments, **options):
        found = core_of(*arguments, **options)
        found.by_V[:, 0] = np.nan
        found.difference[:, 0] = np.inf
        return found

    monkeypatch.setattr(compiled_gradients, "thermal_gradient", none_at_first)
    found = roughly_by_potential(random_wire(9, sites=40), MU, B, BIAS, 0.05)
    assert np.isinf(found.gradient_error[:, 0]).all()
    assert np.isnan(found.by["V"][:, 0]).all()
    assert np.isfinite(found.by["V"][:, 1]).all()
