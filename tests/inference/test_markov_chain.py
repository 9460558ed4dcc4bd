"""The chain of the exact posterior, and predictions of further data."""

import numpy as np
from scipy.stats import kstest

from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.verification.predictive import predictive_p
from disorder_landscape.studies.markov_chain import independence_chain
from linear_data import posterior


def test_the_chain_has_the_posteriors_moments(linear):
    exact = posterior(linear)
    chain = independence_chain(linear, exact, 4000, np.random.default_rng(2))
    assert 0.5 < chain.acceptance <= 1.0
    scale = np.sqrt(np.diag(exact.covariance))
    assert abs((chain.samples.mean(axis=0) - exact.mean) / scale).max() < 0.15
    np.testing.assert_allclose(chain.samples.std(axis=0) / scale, 1.0, atol=0.1)
    too_narrow = Gaussian(exact.mean, exact.covariance / 4)
    wide = independence_chain(linear, too_narrow, 4000, np.random.default_rng(2))
    assert wide.acceptance < chain.acceptance


def test_further_data_are_the_answers_or_not(linear):
    """The p-value is uniform for data that samples of the answer make, and small for others."""
    exact, rng = posterior(linear), np.random.default_rng(7)
    slope, variance = rng.normal(size=linear.slope.shape), np.full(40, 0.01**2)
    p = []
    for sample in exact.draw(rng, 60):
        data = sample @ slope + 0.01 * rng.normal(size=40)
        p.append(predictive_p(exact.draw(rng, 100) @ slope, data, variance, rng))
    assert kstest(p, "uniform").pvalue > 0.01
    assert predictive_p(exact.draw(rng, 100) @ slope, data + 0.02, variance, rng) < 0.02
