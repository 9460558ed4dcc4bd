"""The error of a grid of energies at finite temperature, against the exact average."""

import numpy as np
import pytest

from disorder_landscape import conductance
from disorder_landscape.arguments import ArgumentError
from disorder_landscape.model.parameters import BIAS
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.solver.energy_grid import ENERGY_SPACING
from random_wires import random_wire


def matrix(G):
    """Return G_LL … G_RL as one array."""
    return G[list(CONDUCTANCES)].to_array().to_numpy()


def errors(wires, points, spacings):
    """Return the errors at 50 mK of each spacing, shape (spacing, …), over random (μ, B)."""
    rng = np.random.default_rng(3)
    found = []
    for index in range(wires):
        wire = random_wire(index)
        mu, B = np.sort(rng.uniform(0, 0.6, points)), np.sort(rng.uniform(0, 0.8, points))
        exact = matrix(conductance(wire, mu, B, BIAS))
        found.append(
            [matrix(conductance(wire, mu, B, BIAS, energy_spacing=h)) - exact for h in spacings]
        )
    return np.stack(found, axis=1)


def test_the_default_spacing_has_the_stated_error():
    error = errors(wires=6, points=3, spacings=[ENERGY_SPACING])
    assert np.sqrt((error**2).mean()) < 0.006
    assert abs(error).max() < 0.15


@pytest.mark.slow
def test_the_table_of_errors():
    """The table of docs/accuracy.md: pytest -m slow -s tests/observables/test_energy_grid.py."""
    spacings = [1.77e-3, 1e-3, 0.5e-3, 0.25e-3, 0.1e-3, 0.03e-3]
    error = errors(wires=40, points=6, spacings=spacings)
    rms = np.sqrt((error**2).mean(axis=tuple(range(1, error.ndim))))
    print(f"\n{error[0].size} conductances")
    for h, one, e in zip(spacings, rms, error, strict=True):
        print(f"| {1e3 * h:g} | {one:.5f} | {abs(e).max():.4f} |")
    assert (np.diff(rms) < 0).all()


def test_the_bare_conductance_of_many_biases_takes_little_memory():
    """… and is that of each: 30,000 biases squared would be 14 GB."""
    wire, bias = random_wire(0, sites=20), np.linspace(-0.11, 0.11, 30_001)
    many = matrix(conductance(wire, 0.1, 0.3, bias, temperature=0.0))[:, 0, 0]
    some = slice(None, None, 3000)
    one_by_one = [
        matrix(conductance(wire, 0.1, 0.3, V, temperature=0.0))[:, 0, 0, 0] for V in bias[some]
    ]
    np.testing.assert_allclose(many[:, some], np.transpose(one_by_one), atol=1e-12)


def test_where_nothing_is_averaged_there_is_no_spacing():
    with pytest.raises(ArgumentError, match="energy_spacing must not be given at T = 0"):
        conductance(random_wire(0), 0.1, 0.3, temperature=0.0, energy_spacing=1e-3)
