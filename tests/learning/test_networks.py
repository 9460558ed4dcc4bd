"""The convolutional network is the paper's, layer for layer (Fig. 1, S-II.2); others learn too."""

from __future__ import annotations

import numpy as np
import pytest

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.learning.networks.build import build_network

PAPER = [
    # class, kernel or pool, filters or nodes, shape of one realization behind it
    ("Conv3D", (5, 5, 5), 256, (15, 15, 5, 256)),
    ("Conv3D", (3, 3, 3), 256, (15, 15, 5, 256)),
    ("BatchNormalization", None, None, (15, 15, 5, 256)),
    ("MaxPooling3D", (2, 2, 2), None, (7, 7, 2, 256)),
    ("Conv3D", (3, 3, 3), 512, (7, 7, 2, 512)),
    ("Conv3D", (3, 3, 3), 512, (7, 7, 2, 512)),
    ("Conv3D", (3, 3, 3), 512, (7, 7, 2, 512)),
    ("BatchNormalization", None, None, (7, 7, 2, 512)),
    ("MaxPooling3D", (2, 2, 2), None, (3, 3, 1, 512)),
    ("Reshape", None, None, (3, 3, 512)),
    ("Conv2D", (3, 3), 1028, (3, 3, 1028)),
    ("Conv2D", (3, 3), 1028, (3, 3, 1028)),
    ("Conv2D", (3, 3), 1028, (3, 3, 1028)),
    ("Conv2D", (3, 3), 1028, (3, 3, 1028)),
    ("BatchNormalization", None, None, (3, 3, 1028)),
    ("MaxPooling2D", (2, 2), None, (1, 1, 1028)),
    ("Flatten", None, None, (1028,)),
    ("Dense", None, 500, (500,)),
    ("Dense", None, 500, (500,)),
    ("Dense", None, 6, (6,)),
]


@pytest.fixture(scope="module")
def network():
    return build_network((15, 15, 5, 4), 6)


def test_layers_are_the_papers(network):
    layers = network.layers[1:]  # after the input
    found = []
    for layer in layers:
        window = getattr(layer, "kernel_size", getattr(layer, "pool_size", None))
        size = getattr(layer, "filters", getattr(layer, "units", None))
        found.append((type(layer).__name__, window, size, layer.output.shape[1:]))
    assert found == PAPER


def test_activations_and_optimizer_are_the_papers(network):
    *inner, last = [layer for layer in network.layers if hasattr(layer, "activation")]
    assert {layer.activation.__name__ for layer in inner} == {"relu"}
    assert last.activation.__name__ == "linear"
    assert type(network.optimizer).__name__ == "Adam"
    assert float(network.optimizer.learning_rate) == pytest.approx(1e-4)
    assert network.loss == "mean_squared_error"


def test_number_of_parameters(network):
    """Kernel volume × inputs × filters, plus biases; four numbers per normalised filter."""
    set_1 = 125 * 4 * 256 + 27 * 256 * 256 + 2 * 256 + 4 * 256
    set_2 = 27 * 256 * 512 + 2 * 27 * 512 * 512 + 3 * 512 + 4 * 512
    set_3 = 9 * 512 * 1028 + 3 * 9 * 1028 * 1028 + 4 * 1028 + 4 * 1028
    dense = 1028 * 500 + 500 * 500 + 500 * 6 + 500 + 500 + 6
    assert network.count_params() == set_1 + set_2 + set_3 + dense


def test_width_fraction_scales_the_filters_only():
    network = build_network((15, 15, 5, 4), 6, width_fraction=0.125)
    sizes = [layer.filters for layer in network.layers if hasattr(layer, "filters")]
    assert sizes == [32] * 2 + [64] * 3 + [128] * 4
    assert [layer.units for layer in network.layers if hasattr(layer, "units")] == [500, 500, 6]


@pytest.mark.parametrize(
    ("grid", "before", "after"),
    [
        ((8, 8, 5), (2, 2, 1, 5), (2, 2, 5)),
        ((20, 20, 5), (5, 5, 1, 5), (5, 5, 5)),
        ((15, 15, 15), (3, 3, 3, 5), (3, 3, 15)),  # what is left of V_bias becomes channels
    ],
)
def test_other_grids(grid, before, after):
    network = build_network((*grid, 4), 10, width_fraction=0.01)
    reshape = network.get_layer("to_2d")
    assert reshape.input.shape[1:] == before
    assert reshape.output.shape[1:] == after


@pytest.mark.parametrize(
    ("grid", "axis"), [((7, 15, 5), "mu"), ((15, 7, 5), "B"), ((15, 15, 3), "bias")]
)
def test_a_grid_too_small_for_the_poolings_is_refused(grid, axis):
    with pytest.raises(ArgumentError, match=rf"grid must have at least \d points of {axis}"):
        build_network((*grid, 4), 6)


@pytest.mark.parametrize("architecture", ["residual", "recurrent"])
@pytest.mark.parametrize("grid", [(8, 8, 5), (15, 15, 5), (9, 12, 3)])
def test_other_networks_take_any_grid_and_learn(architecture, grid):
    network = build_network((*grid, 4), 3, 0.02, 1e-2, architecture=architecture)
    rng = np.random.default_rng(0)
    x = rng.normal(size=(16, *grid, 4)).astype(np.float32)
    y = x[:, 1, 2, :, :3].mean(axis=1)
    losses = [network.train_on_batch(x, y, return_dict=True)["loss"] for _ in range(30)]
    assert losses[-1] < 0.5 * losses[0]


def test_the_residual_networks_widths():
    network = build_network((15, 15, 5, 4), 6, 0.0625, architecture="residual")
    kernels = [layer.kernel_size for layer in network.layers if hasattr(layer, "filters")]
    assert kernels.count((2, 2)) == 1  # the patches
    assert kernels.count((3, 3)) == 2 * 2 * 2  # two in each of two blocks a set
    filters = {layer.filters for layer in network.layers if hasattr(layer, "filters")}
    assert filters == {16, 32}


def test_weight_decay_takes_a_share_of_the_weights_at_each_step():
    """Where the labels are met already there is no gradient, and nothing else changes them."""
    network = build_network((8, 8, 5, 4), 3, 0.02, 0.1, weight_decay=0.5)
    x = np.zeros((4, 8, 8, 5, 4), dtype=np.float32)
    before = [weight.numpy() for weight in network.trainable_weights]
    network.train_on_batch(x, network.predict_on_batch(x))
    kernels = [weight for weight in before if weight.ndim > 1]
    after = [weight.numpy() for weight in network.trainable_weights if len(weight.shape) > 1]
    for one, other in zip(kernels, after, strict=True):
        np.testing.assert_allclose(other, 0.95 * one, rtol=1e-5, atol=1e-7)


def test_the_order_of_measurements_matters_to_the_recurrent_network():
    """Each measurement has its own place in K, though its weights are shared."""
    network = build_network((8, 8, 5, 4), 3, 0.02, architecture="recurrent")
    x = np.random.default_rng(0).normal(size=(2, 8, 8, 5, 4)).astype(np.float32)
    turned = np.ascontiguousarray(x[:, ::-1])
    assert abs(network.predict_on_batch(x) - network.predict_on_batch(turned)).max() > 1e-4
