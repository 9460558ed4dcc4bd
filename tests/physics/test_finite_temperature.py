"""The exact thermal average against the adaptive integral."""

import numpy as np
import pytest

from disorder_landscape.physics.quadrature import thermal_quadrature
from disorder_landscape.physics.transport import exact_average
from random_wires import random_wire


def point(seed):
    """Return μ, B, five biases and a temperature, drawn from the seed."""
    rng = np.random.default_rng([7, seed])
    mu = rng.uniform(0, 0.6)
    B = 0.0 if seed % 10 == 0 else rng.uniform(0, 0.8)
    bias = np.sort(rng.uniform(-0.05, 0.05, 5))
    return np.array([mu]), np.array([B]), bias, rng.choice([0.02, 0.05, 0.06])


@pytest.mark.xfail(strict=True, reason="the model's estimate is up to 27 times below its error")
@pytest.mark.parametrize("seed", [318, 508, 265, 551, 36, 39])
def test_the_estimate_bounds_the_error_where_it_was_found_not_to(seed):
    wire, arguments = random_wire(seed), point(seed)
    found, estimate, _ = exact_average([wire], *arguments)
    exact = thermal_quadrature([wire], *arguments, panel=0.02, tolerance=1e-9, reach=20.0)
    error = abs(found - exact.conductance).max()
    assert error < 1e-4
    assert error <= 3 * estimate.item() + exact.error.item()
