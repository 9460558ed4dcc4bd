"""Errors of measurement go where they are said to go."""

from __future__ import annotations

import numpy as np
import pytest

from disorder_landscape.studies.noise import with_errors

X = np.zeros((50, 8, 8, 5, 4), dtype=np.float32)


@pytest.mark.parametrize(
    ("channels", "hit"),
    [(("G_LL", "G_RR"), [1, 1, 0, 0]), (("G_LR",), [0, 0, 1, 0])],
)
def test_only_the_named_channels_have_errors(channels, hit):
    deviation = with_errors(X, 0.05, channels).std(axis=(0, 1, 2, 3))
    np.testing.assert_allclose(deviation, 0.05 * np.array(hit), rtol=0.05)


def test_errors_are_a_function_of_the_seed():
    np.testing.assert_array_equal(with_errors(X, 0.1, seed=3), with_errors(X, 0.1, seed=3))
    assert abs(with_errors(X, 0.1, seed=3) - with_errors(X, 0.1, seed=4)).max() > 0.1
