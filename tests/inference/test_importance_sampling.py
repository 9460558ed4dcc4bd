"""Samples of posteriors that are known: of lines, and of two valleys."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import kstest

from disorder_landscape.inference.checkpoint import Checkpoint
from disorder_landscape.inference.optimum import Optimum, optimum_at
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.posterior import proposal, samples
from disorder_landscape.inference.posterior.importance_sampling import (
    FIRST_BATCH,
    LARGEST_BATCH,
    Part,
    fitted,
    importance_sampling,
    widened,
)
from disorder_landscape.inference.posterior.samples import normality, posterior_samples
from disorder_landscape.inference.posterior.weighted_samples import (
    ENOUGH,
    ImportanceSamples,
    tempered,
)
from disorder_landscape.inference.problem import unknowns
from disorder_landscape.inference.problem.gaussian import Gaussian, log_density, log_mixture
from disorder_landscape.inference.problem.observation import objective
from disorder_landscape.inference.verdict import CONVERGED, NOT_CONVERGED, verdict
from disorder_landscape.studies.truth import more_probable_than, unknowns_of
from disorder_landscape.studies.truth import z_scores as z_scores_of
from linear_data import CONFIG, DATA, SIZE, UNKNOWNS, Linear, posterior

PRIOR = UNKNOWNS.white_noise
WIDTH = np.sqrt(np.diag(PRIOR.covariance))
RNG = np.random.default_rng(5)
SLOPE = RNG.normal(size=(SIZE, DATA)) / WIDTH[:, None]
ONE = np.ones(DATA)


class Folds(Linear):
    """Data that do not depend on which side of the prior's mean the unknowns are."""

    def simulate(self, X):
        return super().simulate(X - PRIOR.mean) ** 2


@pytest.fixture(scope="module")
def lines():
    return Linear((PRIOR.mean + RNG.normal(size=SIZE) * WIDTH) @ SLOPE, SLOPE, variance=ONE)


def test_samples_have_the_posteriors_moments(lines):
    exact = posterior(lines)
    scale = np.sqrt(np.diag(exact.covariance))
    far = Gaussian(exact.mean + 3 * scale, 9 * exact.covariance)
    steps = []
    *_, found = importance_sampling(
        lines, [Part(far, 1.0)], [0], progress=lambda *step: steps.append(step)
    )
    assert [number for number, _, _ in steps] == list(range(len(steps)))
    assert found.effective_sample_size >= ENOUGH
    assert found.samples.shape[0] <= FIRST_BATCH + LARGEST_BATCH * (len(steps) - 1)
    assert abs((found.moments.mean - exact.mean) / scale).max() < 0.3
    ratio = np.linalg.eigvals(np.linalg.solve(exact.covariance, found.moments.covariance))
    assert 0.5 < ratio.real.min() <= ratio.real.max() < 1.7


def test_importance_samples_are_not_too_narrow():
    """All directions at once, if their Mahalanobis distances are Hotelling's, on average."""
    ten = unknowns_of(CONFIG.model_copy(update={"components": 10}))
    size = len(ten.names)
    rng = np.random.default_rng(7)
    slope = rng.normal(size=(size, DATA)) / np.sqrt(np.diag(ten.white_noise.covariance))[:, None]
    many = Linear(np.zeros(DATA), slope, unknowns=ten, variance=ONE)
    exact = posterior(many)
    too_wide = Gaussian(exact.mean, 1.4**2 * exact.covariance)
    ratio = []
    for seed in range(40):
        mixture = [Part(too_wide, 0.5), Part(widened(exact, 1.2), 0.5)]
        *_, found = importance_sampling(many, mixture, [seed])
        n, off = found.effective_sample_size, found.moments.mean - exact.mean
        second_moment = exact.covariance + np.outer(off, off)
        square = np.trace(np.linalg.solve(found.moments.covariance, second_moment))
        ratio.append(square / (size * (n + 1) / (n - size - 2)))
    assert abs(np.mean(ratio) - 1) < 0.04


@pytest.mark.parametrize("times_wider", [1.0, 1.3, 1.5])
def test_samples_are_as_wide_as_the_posterior_where_the_first_proposal_is_not(times_wider):
    """… on average over 40 runs, to three standard deviations of this average."""
    slope = np.random.default_rng(7).normal(size=(SIZE, DATA)) / WIDTH[:, None]
    some = Linear(np.zeros(DATA), slope, variance=ONE)
    exact = posterior(some)
    narrow = widened(exact, 1 / times_wider)
    ratio = []
    for seed in range(40):
        *_, found = importance_sampling(some, [Part(narrow, 1.0)], [seed])
        ratio.append(np.trace(np.linalg.solve(exact.covariance, found.moments.covariance)) / SIZE)
    assert abs(np.mean(ratio) - 1) < 0.04


def test_both_valleys_have_their_share():
    truth = PRIOR.mean + 1.5 * WIDTH
    folds = Folds(((truth - PRIOR.mean) @ SLOPE) ** 2, SLOPE, variance=4 * ONE)
    about = [
        Part(Gaussian(at, 0.05 * PRIOR.covariance), 0.5) for at in (truth, 2 * PRIOR.mean - truth)
    ]
    *_, found = importance_sampling(folds, about, [0])
    side = (found.samples - PRIOR.mean) @ (truth - PRIOR.mean) > 0
    assert 0.35 < found.weight[side].sum() < 0.65
    assert found.moments.squared_distance(truth) < 3 * SIZE
    drawn = found.draw(np.random.default_rng(0), 1000)
    side = (drawn - PRIOR.mean) @ (truth - PRIOR.mean) > 0
    assert 0.35 < side.mean() < 0.65


def test_weights_are_tempered_no_more_than_needed():
    X, log_weight = RNG.normal(size=(500, SIZE)), 30 * RNG.normal(size=500)
    found = tempered(X, log_weight, 100.0)
    assert found.effective_sample_size == pytest.approx(100.0)
    assert 0 < found.power < 1
    np.testing.assert_array_equal(np.argsort(found.weight), np.argsort(log_weight))
    assert tempered(X, 0.01 * log_weight, 100.0).effective_sample_size > 100


def test_samples_are_enough_by_their_effective_size():
    """As many as are needed for each unknown, and of the posterior itself."""
    even = ImportanceSamples(np.zeros((500, SIZE)), np.full(500, 1 / 500))
    assert even.effective_sample_size == pytest.approx(500)
    assert even.is_enough
    assert not replace(even, power=0.9).is_enough
    assert not replace(even, samples=np.zeros((500, 50))).is_enough
    one = np.full(500, 0.1 / 499)
    one[0] = 0.9
    assert not replace(even, weight=one).is_enough


def test_as_many_samples_are_still_needed_as_will_be_enough():
    weight = np.repeat([1 / 32, 0.0], [32, 32])
    found = ImportanceSamples(np.zeros((64, SIZE)), weight)
    assert found.still_needed == 136  # half of 64 are effective, and 100 are needed


@pytest.mark.parametrize(("times_wider", "expected"), [(1.0, 1.0), (1.1, 0.86), (1.2, 0.47)])
def test_normality_is_the_share_of_laplaces_samples_that_is_effective(times_wider, expected):
    """Of normal posteriors of seven directions."""
    answer = Gaussian(np.zeros(7), np.eye(7))
    X = proposal.draw(answer, np.random.default_rng(4), 20_000)
    log_weight = log_density(widened(answer, times_wider), X)
    found = tempered(X, log_weight - proposal.log_density(answer, X), 0.0)
    assert normality(found, answer) == pytest.approx(expected, abs=0.05)
    assert normality(replace(found, power=0.5), answer) == 0


def test_samples_are_drawn_as_often_as_they_weigh():
    X = np.arange(4.0)[:, None]
    drawn = ImportanceSamples(X, np.array([0.5, 0.25, 0.25, 0.0])).draw(RNG, 400)
    np.testing.assert_array_equal(np.bincount(drawn[:, 0].astype(int)), [200, 100, 100])


@pytest.mark.parametrize("wide", [False, True])
def test_what_is_more_probable_is_right_over_many_wires(lines, wide):
    """Of truths that are drawn from the posterior: uniform, with samples or Laplace's density."""
    exact = posterior(lines)
    truths = exact.draw(np.random.default_rng(8), 500)
    height, share = objective(lines, truths, lines.simulate(truths)), []
    for seed in range(10 if wide else 1):
        drawn = None
        if wide:
            *_, drawn = importance_sampling(lines, [Part(widened(exact, 1.3), 1.0)], [seed])
        found = Outcome([optimum_at(lines, exact)], drawn)
        share += [more_probable_than(float(one), found) for one in height]
    assert kstest(share, "uniform").statistic < 0.06
    z_scores = np.concatenate([z_scores_of(found, x) for x in truths])
    assert kstest(z_scores, "norm").statistic < 0.04


def test_what_is_more_probable_does_not_depend_on_the_posteriors_shape():
    """Of truths from two valleys that bend, drawn by other means; and wrong weights are seen."""
    at = PRIOR.mean + 1.5 * WIDTH
    folds = Folds(((at - PRIOR.mean) @ SLOPE) ** 2, SLOPE, variance=4 * ONE)
    valleys = [Gaussian(c, 0.05 * PRIOR.covariance) for c in (at, 2 * PRIOR.mean - at)]
    rng = np.random.default_rng(1)
    X = np.concatenate([proposal.draw(one, rng, 200_000) for one in valleys])
    log = -0.5 * objective(folds, X, folds.simulate(X))
    log -= log_mixture([(one, 200_000) for one in valleys], X, proposal.log_density)
    weighted = tempered(X, log, 0.0)
    assert weighted.effective_sample_size > 2000
    truths = weighted.draw(rng, 500)
    height = objective(folds, truths, folds.simulate(truths))
    right, wrong, z_scores, of_moments = [], [], [], []
    for seed in range(10):
        *_, drawn = importance_sampling(folds, [Part(one, 0.5) for one in valleys], [seed])
        for one, shares in ((_evenly_weighted(drawn), wrong), (drawn, right)):
            found = Outcome([optimum_at(folds, valleys[0])], one)
            shares += [more_probable_than(float(h), found) for h in height]
        z_scores += [z_scores_of(found, x) for x in truths]
        normal = Outcome([replace(optimum_at(folds, valleys[0]), answer=drawn.moments)])
        of_moments += [z_scores_of(normal, x) for x in truths]
    distance = [kstest(np.ravel(z), "norm").statistic for z in (z_scores, of_moments)]
    assert distance[0] < 0.04
    assert distance[1] > 0.08
    assert kstest(right, "uniform").statistic < 0.05
    assert kstest(wrong, "uniform").statistic > 0.1


def _evenly_weighted(drawn):
    return replace(drawn, weight=np.full(len(drawn.weight), 1 / len(drawn.weight)))


def test_samples_of_a_wider_distribution_do_not_tell_what_is_more_probable(lines):
    exact = posterior(lines)
    *_, drawn = importance_sampling(lines, [Part(exact, 1.0)], [0])
    found = Outcome([optimum_at(lines, exact)], replace(drawn, power=0.5))
    assert np.isnan(more_probable_than(1e3, found))


def test_interrupted_importance_sampling_goes_on(lines, tmp_path):
    start = Gaussian(PRIOR.mean, PRIOR.covariance)
    path = tmp_path / "unfinished.json"
    *_, first = importance_sampling(lines, [Part(start, 1.0)], [0], Checkpoint(path).cached)
    again = Checkpoint(path)
    assert len(again) > 0

    def fail(X):
        raise AssertionError("simulated twice")

    unavailable = replace(lines)
    unavailable.simulate = fail
    *_, second = importance_sampling(unavailable, [Part(start, 1.0)], [0], again.cached)
    np.testing.assert_array_equal(first.weight, second.weight)
    np.testing.assert_array_equal(first.samples, second.samples)


def test_mixtures_are_fitted_to_samples():
    """Of two normal distributions that are far apart; one that no sample is near stays."""
    rng, unit = np.random.default_rng(3), np.eye(2)
    X = np.concatenate([rng.normal(size=(3000, 2)), [8.0, 0.0] + 0.5 * rng.normal(size=(1000, 2))])
    samples = ImportanceSamples(X, np.full(4000, 1 / 4000))
    centers = [(1.0, 0.0), (7.0, 1.0), (0.0, 90.0)]
    first, second, far = fitted(
        [Part(Gaussian(np.array(at), unit), 1 / 3) for at in centers], samples
    )
    assert first.share == pytest.approx(0.75, abs=0.01)
    assert second.share == pytest.approx(0.25, abs=0.01)
    assert abs(first.scale.mean).max() < 0.1
    assert abs(second.scale.mean - [8.0, 0.0]).max() < 0.1
    np.testing.assert_allclose(first.scale.covariance, 1.44 * unit, atol=0.15)
    np.testing.assert_allclose(second.scale.covariance, 0.36 * unit, atol=0.05)
    assert far.share < 1e-9
    np.testing.assert_array_equal(far.scale.covariance, unit)
    again = fitted([first, second, far], samples)  # whose share of none of them is no warning
    assert again[2].share < 1e-9
    assert again[0].share == pytest.approx(0.75, abs=0.01)


@pytest.mark.parametrize(("straight", "wide"), [(1.05, False), (0.95, True), (0.1, True)])
def test_answers_wider_than_conductances_are_straight_get_importance_samples(
    lines, monkeypatch, straight, wide
):
    """Here as wide as so many bars of an answer that is too narrow."""
    exact = posterior(lines)
    answer = Gaussian(exact.mean, 0.5 * exact.covariance)
    bar = UNKNOWNS.site_std(answer.covariance)
    monkeypatch.setattr(samples, "STRAIGHT", straight * bar)
    one = Optimum(answer, lines.simulate(answer.mean[None])[0], 0.0, 0.0, (0, 0))
    optima = [one, replace(one, objective=20.0)]
    found = Outcome(optima, posterior_samples(lines, optima, [0]))
    assert verdict(lines, found) == CONVERGED
    assert (found.importance_samples is not None) == wide
    expected = UNKNOWNS.site_std(exact.covariance) if wide else bar
    assert UNKNOWNS.site_std(found.answer.covariance) == pytest.approx(expected, rel=0.15)
    if wide:
        tempered_only = replace(found.importance_samples, power=0.5)
        assert verdict(lines, Outcome(optima, tempered_only)) == NOT_CONVERGED
    poor = replace(one, excess=9.0)
    assert posterior_samples(lines, [poor], [0]) is None  # what does not fit stays as it is


def test_narrow_answers_get_importance_samples_if_much_of_a_device_is_unknown(lines, monkeypatch):
    answer = posterior(lines)
    bar = UNKNOWNS.site_std(answer.covariance)
    monkeypatch.setattr(samples, "STRAIGHT", bar)
    narrow = Gaussian(answer.mean, answer.covariance / 25)
    one = optimum_at(lines, narrow)
    assert len(UNKNOWNS.parameters) == 1
    assert posterior_samples(lines, [one], [0]) is None
    monkeypatch.setattr(unknowns, "FEW_PARAMETERS", 0)
    found = posterior_samples(lines, [one], [0])
    assert UNKNOWNS.site_std(found.moments.covariance) == pytest.approx(bar, rel=0.15)


def test_many_unknowns_get_none(lines, monkeypatch):
    """… or too few, where there are several optima."""
    exact = posterior(lines)
    narrow = optimum_at(lines, Gaussian(exact.mean, 0.5 * exact.covariance))
    monkeypatch.setattr(samples, "STRAIGHT", 0.25 * UNKNOWNS.site_std(exact.covariance))
    assert posterior_samples(lines, [narrow], [0]) is not None
    monkeypatch.setattr(samples, "MOST_UNKNOWNS", len(UNKNOWNS.names) - 1)
    assert posterior_samples(lines, [narrow], [0]) is None
    found = posterior_samples(lines, [narrow, narrow], [0])
    assert len(found.samples) < FIRST_BATCH + 4
    assert not found.is_enough


def test_several_optima_get_importance_samples(lines):
    """However narrow they are."""
    exact = posterior(lines)
    one = optimum_at(lines, exact)
    apart = Gaussian(exact.mean + 2 * np.sqrt(np.diag(exact.covariance)), exact.covariance)
    other = replace(one, answer=apart)
    found = posterior_samples(lines, [one, other], [0])
    assert found.is_enough
    assert exact.squared_distance(found.moments.mean) < 0.3
