"""The mirror symmetry that training and prediction use is the wire's own."""

from __future__ import annotations

import numpy as np

import disorder_landscape as dl
from disorder_landscape.learning.mirror import mirrored_conductance, mirrored_labels
from disorder_landscape.learning.scaling import conductance_array
from disorder_landscape.model.disorder import potential_from_components


def test_mirroring_twice_changes_nothing():
    rng = np.random.default_rng(0)
    X = rng.normal(size=(3, 8, 8, 5, 4)).astype(np.float32)
    Y = rng.normal(size=(3, 6))
    X2 = mirrored_conductance(mirrored_conductance(X))
    Y2 = mirrored_labels(mirrored_labels(Y, 5), 5)
    np.testing.assert_array_equal(X2, X)
    np.testing.assert_array_equal(Y2, Y)


def test_odd_components_change_sign_and_alpha_does_not():
    assert mirrored_labels(np.arange(1.0, 7), 5).tolist() == [-1, 2, -3, 4, -5, 6]
    assert mirrored_labels(np.arange(1.0, 5), 4).tolist() == [-1, 2, -3, 4]


def test_mirrored_components_make_the_mirrored_potential():
    c = np.random.default_rng(1).normal(size=7)
    V = potential_from_components(mirrored_labels(c, 7), 60)
    np.testing.assert_allclose(V, potential_from_components(c, 60)[::-1], atol=1e-12)


def test_mirrored_conductance_is_the_conductance_of_the_mirrored_wire():
    V = potential_from_components(np.array([1.5, -0.8, 0.6]), 40)
    grids = {"mu": [0.1, 0.4], "B": [0.3], "bias": [-0.02, 0.01]}
    there, mirror = (
        conductance_array(
            dl.conductance(dl.Nanowire(v, alpha=8.0), temperature=0, solver="kwant", **grids)
        )
        for v in (V, V[::-1])
    )
    assert abs(there - mirror).max() > 1e-3  # the wire is not its own mirror image
    np.testing.assert_allclose(mirror, mirrored_conductance(there), atol=1e-5)
