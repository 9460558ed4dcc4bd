"""What a training shows: wires, mirror images behind them, errors of measurement."""

from __future__ import annotations

import numpy as np
import pytest

from disorder_landscape.config import TrainingConfig
from disorder_landscape.learning.examples import Examples
from disorder_landscape.learning.mirror import mirrored_conductance, mirrored_labels

RNG = np.random.default_rng(5)
X = RNG.normal(size=(6, 8, 8, 5, 4)).astype(np.float32)
Y = RNG.normal(size=(6, 4))


def examples(**training):
    return Examples(X.copy(), Y.copy(), 3, TrainingConfig(**training))


def test_without_mirror_the_examples_are_the_wires():
    plain = examples()
    which = np.array([4, 0, 5])
    assert len(plain) == 6
    np.testing.assert_array_equal(plain.conductances(which), X[which])
    np.testing.assert_array_equal(plain.labels(which), Y[which])


def test_mirror_images_stand_behind_the_wires():
    both = examples(mirror=True)
    X_mirrored, Y_mirrored = mirrored_conductance(X), mirrored_labels(Y, 3)
    which = np.array([2, 8, 11, 0])
    assert len(both) == 12
    np.testing.assert_array_equal(both.conductances(which), np.vstack([X, X_mirrored])[which])
    np.testing.assert_array_equal(both.labels(which), np.vstack([Y, Y_mirrored])[which])
    np.testing.assert_array_equal(both.X, X)  # the data themselves stay as they are


def test_scalers_are_those_of_all_examples():
    both = examples(mirror=True)
    everything = np.arange(12)
    labels = both.fit_labels(("c_1", "c_2", "c_3", "alpha"))
    np.testing.assert_allclose(labels.mean, both.labels(everything).mean(axis=0), atol=1e-12)
    np.testing.assert_allclose(labels.mean[[0, 2]], 0, atol=1e-12)
    inputs = both.fit_inputs()
    scaled = inputs.scale(both.conductances(everything))
    np.testing.assert_allclose(scaled.mean(axis=0), 0, atol=1e-5)
    np.testing.assert_allclose(inputs.mean[..., 0], inputs.mean[..., 1], atol=1e-6)


def test_each_example_may_have_errors_of_its_own():
    noisy = examples(noise=0.005, noise_up_to=0.1)
    which = np.resize(np.arange(6), 600)
    off = noisy.conductances(which, np.random.default_rng(0)) - X[which]
    deviation = off.std(axis=(1, 2, 3, 4))
    assert 0.004 < deviation.min() < 0.006
    assert 0.09 < deviation.max() < 0.11
    assert np.median(deviation) == pytest.approx(noisy.training.typical_noise, rel=0.2)
    assert noisy.training.largest_noise == 0.1
    with pytest.raises(ValueError, match="noise must be more than 0 and at most noise_up_to"):
        TrainingConfig(noise_up_to=0.1)


def test_inputs_are_scaled_as_the_errors_make_them():
    """So that errors do not swamp a network where conductances hardly vary."""
    still = Examples(np.zeros_like(X), Y, 3, TrainingConfig(noise=0.05))
    scaled = still.fit_inputs().scale(0.05 * RNG.normal(size=X.shape).astype(np.float32))
    assert abs(scaled).max() < 10


def test_errors_have_the_stated_deviation_and_come_anew():
    noisy = examples(noise=0.05)
    everything = np.arange(6)
    rng = np.random.default_rng(0)
    one, other = (noisy.conductances(everything, rng) - X for _ in range(2))
    assert np.std(one) == pytest.approx(0.05, rel=0.02)
    assert abs(np.corrcoef(one.ravel(), other.ravel())[0, 1]) < 0.03
    np.testing.assert_array_equal(noisy.conductances(everything), X)
