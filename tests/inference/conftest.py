"""Data that are linear in the unknowns."""

import numpy as np
import pytest

from linear_data import SIZE, UNKNOWNS, Linear


@pytest.fixture(scope="module")
def linear():
    rng = np.random.default_rng(0)
    slope = rng.normal(size=(SIZE, 40))
    truth = UNKNOWNS.white_noise.draw(rng, 2)[0]
    return Linear(truth @ slope + 0.01 * rng.normal(size=40), slope)
