"""TensorFlow sees the gradient that the simulator has."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import disorder_landscape as dl
from random_wires import random_wire

GRIDS = np.array([0.1, 0.4]), np.array([0.2, 0.5]), np.array([-0.02, 0.02])


def test_the_operation_has_the_gradient_of_the_simulator():
    import tensorflow as tf

    wires = [random_wire(seed, sites=20) for seed in (1, 2)]
    operation = dl.differentiable_conductance(wires[0], *GRIDS, parameters=("V", "alpha"))
    V = tf.Variable(np.array([w.potential for w in wires]), dtype=tf.float32)
    alpha = tf.Variable([7.0, 9.0])
    with tf.GradientTape() as tape:
        G = operation(V, alpha)
        loss = tf.reduce_sum(G**2)
    by_V, by_alpha = tape.gradient(loss, [V, alpha])
    assert G.shape == (2, 2, 2, 2, 4)
    assert G.dtype == tf.float32
    for k in range(2):
        wire = dl.Nanowire(V[k].numpy(), alpha=[7.0, 9.0][k])
        of = dl.conductance(wire, *GRIDS)
        assert_allclose(G[k, ..., 0], of.G_LL, atol=1e-6)
        weights = 2 * of[["G_LL", "G_RR", "G_LR", "G_RL"]]
        slopes = dl.conductance_gradient(wire, *GRIDS, weights=weights)
        assert_allclose(by_V[k], slopes.V, rtol=1e-4, atol=1e-5)
        assert_allclose(by_alpha[k], slopes.alpha, rtol=1e-3, atol=1e-5)


def test_bad_input_is_one_sentence():
    with pytest.raises(dl.ArgumentError, match="parameters must be some of V"):
        dl.differentiable_conductance(random_wire(1, sites=5), *GRIDS, parameters=["mu"])
    with pytest.raises(dl.ArgumentError, match="above zero"):
        dl.differentiable_conductance(random_wire(1, sites=5), *GRIDS, temperature=0.0)
