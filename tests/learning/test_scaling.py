"""What the network sees, and the scales of inputs and labels."""

from __future__ import annotations

import json

import numpy as np
import pytest

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.learning.scaling import (
    CHANNELS,
    COMPRESSION,
    InputScaler,
    LabelScaler,
    conductance_array,
    label_array,
    label_names,
)


def through_json(scaler):
    return type(scaler).from_dict(json.loads(json.dumps(scaler.to_dict())))


def test_channels_and_axes_are_in_the_stated_order(dataset):
    X = conductance_array(dataset)
    assert X.shape == (400, 8, 8, 5, 4)
    assert X.dtype == np.float32
    for k, name in enumerate(CHANNELS):
        np.testing.assert_array_equal(X[..., k], dataset[name])


def test_the_order_of_dimensions_does_not_matter(dataset):
    turned = dataset.transpose("bias", "component", "B", "realization", "mu", "site")
    np.testing.assert_array_equal(conductance_array(turned), conductance_array(dataset))


def test_one_wire_needs_no_realization(dataset):
    one = conductance_array(dataset.isel(realization=3))
    np.testing.assert_array_equal(one, conductance_array(dataset)[3:4])


def test_a_missing_variable_is_refused(dataset):
    with pytest.raises(ArgumentError, match=r"G must hold .*, but G_LR is missing"):
        conductance_array(dataset.drop_vars("G_LR"))


@pytest.mark.parametrize("change", [{"bias": 0}, {"mu": 2}])
def test_a_missing_dimension_is_refused(dataset, change):
    with pytest.raises(ArgumentError, match="G must have the dimensions mu, B, bias"):
        conductance_array(dataset.isel(change))


def test_a_further_dimension_is_refused(dataset):
    with pytest.raises(ArgumentError, match="at most realization"):
        conductance_array(dataset.expand_dims("temperature"))


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_conductances_that_are_not_finite_are_refused(dataset, value):
    G = dataset.copy(deep=True)
    G["G_RL"][5, 1, 2, 3] = value
    with pytest.raises(ArgumentError, match="G must be finite"):
        conductance_array(G)


def test_labels_are_components_then_alpha(dataset):
    Y = label_array(dataset, label_names(5, True))
    np.testing.assert_array_equal(Y[:, :5], dataset["components"])
    np.testing.assert_array_equal(Y[:, 5], dataset["alpha"])
    assert label_array(dataset, label_names(5, False)).shape == (400, 5)
    assert label_names(2, True) == ("c_1", "c_2", "alpha")


def test_the_mean_of_the_potential_may_be_a_label(dataset):
    assert label_names(2, False, True) == ("c_1", "c_2", "mean")
    shifted = dataset.assign(potential=dataset["potential"] + 0.01)
    np.testing.assert_allclose(label_array(shifted, label_names(5, True, True))[:, 6], 0.01)


def test_label_scaler_gives_zero_mean_and_unit_variance(dataset):
    Y = label_array(dataset, label_names(5, True))
    scaler = LabelScaler.fit(label_names(5, True), Y)
    np.testing.assert_allclose(scaler.scale(Y).mean(axis=0), 0, atol=1e-12)
    np.testing.assert_allclose(scaler.scale(Y).std(axis=0), 1, rtol=1e-12)
    np.testing.assert_allclose(scaler.unscale(scaler.scale(Y)), Y, rtol=1e-12)


def test_label_scaler_survives_json_to_the_last_bit(dataset):
    scaler = LabelScaler.fit(label_names(5, True), label_array(dataset, label_names(5, True)))
    again = through_json(scaler)
    assert again.names == scaler.names
    assert again.mean.tobytes() == scaler.mean.tobytes()
    assert again.std.tobytes() == scaler.std.tobytes()


def test_input_scaler_compresses_then_standardises_each_pixel(dataset):
    X = conductance_array(dataset)
    scaled = InputScaler.fit(X).scale(X)
    assert scaled.dtype == np.float32
    np.testing.assert_allclose(scaled.mean(axis=0), 0, atol=1e-5)
    assert (scaled.std(axis=0) < 1 + 1e-5).all()
    pixel = np.arcsinh(X[:, 2, 3, 4, 2] / 0.003)  # G_LR
    expected = (pixel - pixel.mean()) / np.hypot(pixel.std(), 0.001 / 0.003)
    np.testing.assert_allclose(scaled[:, 2, 3, 4, 2], expected, atol=1e-5)


def test_a_scaler_fitted_in_parts_is_that_of_the_whole(dataset, monkeypatch):
    X = conductance_array(dataset)
    whole = InputScaler.fit(X)
    monkeypatch.setattr("disorder_landscape.learning.scaling.ROWS_AT_A_TIME", 64)
    parts = InputScaler.fit(X[:150], X[150:])
    np.testing.assert_allclose(parts.mean, whole.mean, atol=1e-5)
    np.testing.assert_allclose(parts.std, whole.std, rtol=1e-4)


def test_errors_of_measurement_are_not_blown_up():
    """Pixels that never vary, as nonlocal ones at B = 0, must not shout at an error of 0.001."""
    X = np.full((10, 1, 1, 1, 4), 1e-10, dtype=np.float32)
    scaled = InputScaler.fit(X).scale(X + np.float32(0.001))
    assert abs(scaled).max() < 1.01


def test_a_constant_pixel_is_only_shifted():
    X = np.full((10, 1, 1, 1, 4), 0.1, dtype=np.float32)
    scaler = InputScaler.fit(X)
    np.testing.assert_allclose(scaler.scale(X), 0, atol=1e-6)
    expected = np.arcsinh(0.2 / COMPRESSION) - np.arcsinh(0.1 / COMPRESSION)
    expected /= 0.001 / COMPRESSION
    np.testing.assert_allclose(scaler.scale(2 * X)[0, 0, 0, 0], expected, rtol=1e-4)


def test_input_scaler_survives_json_to_the_last_bit(dataset):
    scaler = InputScaler.fit(conductance_array(dataset))
    again = through_json(scaler)
    assert again.mean.dtype == again.std.dtype == np.float32
    assert again.mean.tobytes() == scaler.mean.tobytes()
    assert again.std.tobytes() == scaler.std.tobytes()
