"""The unknowns, their prior, and the noise."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from disorder_landscape.inference.problem.gaussian import log_density
from disorder_landscape.inference.problem.observation import Observation, noise_of_channels
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.model.disorder import disorder_realization
from linear_data import CONFIG, SIZE, UNKNOWNS


def test_densities_are_scipys():
    X = UNKNOWNS.prior.draw(np.random.default_rng(11), 6)
    prior = UNKNOWNS.prior
    expected = multivariate_normal(prior.mean, prior.covariance).logpdf(X)
    found = log_density(prior, X) - SIZE / 2 * np.log(2 * np.pi)
    np.testing.assert_allclose(found, expected)


def test_the_prior_is_the_disorder_models():
    rng = np.random.default_rng(3)
    drawn = [disorder_realization(rng, 3, 50) for _ in range(4000)]
    values = np.array([[*c, V.mean()] for c, V in drawn])
    covariance = UNKNOWNS.prior.covariance[np.ix_([0, 1, 2, 4], [0, 1, 2, 4])]
    scale = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(
        np.cov(values.T) / np.outer(scale, scale), covariance / np.outer(scale, scale), atol=0.08
    )
    assert scale[-1] == pytest.approx(0.01)
    assert UNKNOWNS.prior.mean[3] == pytest.approx(8.0)


def test_the_potentials_std_needs_no_potential():
    rng = np.random.default_rng(4)
    one, other = UNKNOWNS.prior.draw(rng, 2)
    apart = UNKNOWNS.potential(one) - UNKNOWNS.potential(other)
    assert UNKNOWNS.site_distance(one, other) == pytest.approx(np.sqrt((apart**2).mean()))
    X = UNKNOWNS.prior.draw(rng, 20_000)
    spread = np.sqrt(UNKNOWNS.potential(X).var(axis=0).mean())
    assert UNKNOWNS.site_std(UNKNOWNS.prior.covariance) == pytest.approx(spread, rel=0.02)
    wire = UNKNOWNS.wires(one[None], (1.0, 2.0))[0]
    np.testing.assert_array_equal(wire.potential, UNKNOWNS.potential(one))
    assert (wire.alpha, wire.barrier) == (UNKNOWNS.alpha(one), (1.0, 2.0))


def test_names_and_vectors():
    assert UNKNOWNS.names == ("c_1", "c_2", "c_3", "alpha", "mean")
    x = UNKNOWNS.vector({"c_2": np.array([1.0, 2.0])})
    np.testing.assert_array_equal(x, [[0, 1, 0, 8, 0], [0, 2, 0, 8, 0]])
    fixed = Unknowns(CONFIG.model_copy(update={"alpha_range": (7.0, 7.0)}))
    assert fixed.names == ("c_1", "c_2", "c_3", "mean")
    assert fixed.alpha(np.zeros(4)) == 7.0


def test_noise_by_channel():
    np.testing.assert_array_equal(noise_of_channels(0.1), [0.1] * 4)
    named = {"G_RL": 4.0e-3, "G_LL": 1.0e-3, "G_LR": 3.0e-3, "G_RR": 2.0e-3}
    np.testing.assert_array_equal(noise_of_channels(named), [1e-3, 2e-3, 3e-3, 4e-3])
    assert Observation.__dataclass_fields__.keys() >= {"measurement", "unknowns", "noise"}
