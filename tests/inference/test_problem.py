"""The unknowns, their prior, and the noise."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from disorder_landscape.inference.problem.gaussian import log_density
from disorder_landscape.inference.problem.noise import noise_of_channels
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.model.disorder import disorder_realization
from disorder_landscape.studies.truth import labels as labels_of
from disorder_landscape.studies.truth import of_device, site_distance, unknowns_of
from linear_data import CONFIG, SIZE, UNKNOWNS


def test_densities_are_scipys():
    X = UNKNOWNS.white_noise.draw(np.random.default_rng(11), 6)
    prior = UNKNOWNS.white_noise
    expected = multivariate_normal(prior.mean, prior.covariance).logpdf(X)
    found = log_density(prior, X) - SIZE / 2 * np.log(2 * np.pi)
    np.testing.assert_allclose(found, expected)


def test_the_prior_is_the_disorder_models():
    rng = np.random.default_rng(3)
    drawn = [disorder_realization(rng, 3, 50) for _ in range(4000)]
    X = np.array([of_device(UNKNOWNS, c, V, {"alpha": rng.uniform(6.4, 9.6)}) for c, V in drawn])
    np.testing.assert_allclose(np.cov(X.T), np.eye(SIZE), atol=0.08)
    np.testing.assert_allclose(X.mean(axis=0), 0, atol=0.08)
    c, V = drawn[0]
    np.testing.assert_allclose(UNKNOWNS.potential(X[0]), V, atol=1e-12)
    np.testing.assert_allclose(UNKNOWNS.components(X[0]), c, atol=1e-12)
    mean_std, alpha_std = UNKNOWNS.label_std[3:]
    assert mean_std == pytest.approx(0.01)
    assert alpha_std == pytest.approx(3.2 / np.sqrt(12))
    assert UNKNOWNS.parameter("alpha", UNKNOWNS.white_noise.mean) == pytest.approx(8.0)


def test_the_potentials_std_needs_no_potential():
    rng = np.random.default_rng(4)
    one, other = UNKNOWNS.white_noise.draw(rng, 2)
    apart = UNKNOWNS.potential(one) - UNKNOWNS.potential(other)
    assert site_distance(UNKNOWNS, one, other) == pytest.approx(np.sqrt((apart**2).mean()))
    X = UNKNOWNS.white_noise.draw(rng, 20_000)
    spread = np.sqrt(UNKNOWNS.potential(X).var(axis=0).mean())
    assert UNKNOWNS.site_std(UNKNOWNS.white_noise.covariance) == pytest.approx(spread, rel=0.02)
    covariance = np.diag(rng.uniform(0.5, 1, SIZE))
    each = UNKNOWNS.potential_std(covariance)
    assert np.sqrt((each**2).mean()) == pytest.approx(UNKNOWNS.site_std(covariance))


def test_names_and_vectors():
    assert UNKNOWNS.names == ("c_1", "c_2", "c_3", "mean", "alpha")
    x = UNKNOWNS.vector({"c_2": np.array([0.1, 0.2])})
    np.testing.assert_allclose(
        labels_of(UNKNOWNS, x)[:, :3], [[0, 0.1, 0], [0, 0.2, 0]], atol=1e-15
    )
    np.testing.assert_array_equal(x[:, 3:], 0)
    labels = dict(zip(UNKNOWNS.names, np.array([0.3, -0.2, 0.1, 0.02, 7.0]), strict=True))
    np.testing.assert_allclose(labels_of(UNKNOWNS, UNKNOWNS.vector(labels)), [*labels.values()])
    fixed = unknowns_of(CONFIG.model_copy(update={"alpha_range": (7.0, 7.0)}))
    assert fixed.names == ("c_1", "c_2", "c_3", "mean")
    assert fixed.parameter("alpha", np.zeros(4)) == 7.0


def test_noise_by_channel():
    np.testing.assert_array_equal(noise_of_channels(0.1), [0.1] * 4)
    named = {"G_RL": 4.0e-3, "G_LL": 1.0e-3, "G_LR": 3.0e-3, "G_RR": 2.0e-3}
    np.testing.assert_array_equal(noise_of_channels(named), [1e-3, 2e-3, 3e-3, 4e-3])
    assert Observation.__dataclass_fields__.keys() >= {"measurement", "unknowns", "noise"}
