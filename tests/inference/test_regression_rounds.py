"""Regression rounds lead from the prior to posteriors that are known."""

from dataclasses import replace

import numpy as np
import pytest

from disorder_landscape.inference.checkpoint import Checkpoint
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.search.gauss_newton import (
    gauss_newton,
    linearise,
    precision_of,
)
from disorder_landscape.inference.search.network_features import Features
from disorder_landscape.inference.search.proposals import ProposalSamples
from disorder_landscape.inference.search.regression import (
    RIDGES,
    error_covariance,
    residual_variance,
    ridge_regression,
)
from disorder_landscape.inference.search.regression_rounds import (
    Round,
    RoundSettings,
    regression_rounds,
)
from linear_data import SIZE, UNKNOWNS, Linear, posterior

SETTINGS = RoundSettings()


@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_rounds_lead_from_the_prior_to_the_truth(seed):
    """Data that go up and down across the prior: lines through them say little."""
    rng = np.random.default_rng(seed)
    slope = rng.normal(size=(SIZE, 40))
    truth = UNKNOWNS.white_noise.draw(rng, 2)[0]
    waves = Linear(np.zeros(40), slope / 3, bend=1.0)
    waves.data = waves.simulate(truth) + 0.01 * rng.normal(size=40)
    found = list(regression_rounds(waves, UNKNOWNS.white_noise, [0], SETTINGS))
    assert found[0].unexplained > 50
    assert 1 < len(found) < SETTINGS.rounds
    last = found[-1]
    assert last.unexplained < SETTINGS.unexplained
    assert last.spread < 0.02 * found[0].spread
    assert last.distribution.squared_distance(truth) < 3 * SIZE
    optimum = gauss_newton(waves, last.distribution.mean)
    assert optimum.squared_distance(truth) < 3 * SIZE


@pytest.mark.parametrize("nearly_noise", [2.0, np.inf])
def test_rounds_that_lead_nowhere_end(linear, nearly_noise):
    """What nobody could learn from: data of waves far shorter than the prior is wide."""
    shares = []

    class Waves(Linear):
        def simulate(self, X):
            return 2.0 * np.sin(500 * X @ self.slope)

        def on_some_lines(self, share, fewest, rng):
            shares.append(share)
            return self

    waves = Waves(linear.data, linear.slope)
    settings = RoundSettings(patience=2, nearly_noise=nearly_noise)
    found = list(regression_rounds(waves, UNKNOWNS.white_noise, [0], settings))
    assert len(found) < settings.rounds
    last = settings.patience
    for values, less in (
        ([one.unexplained for one in found], 1.0),
        ([one.spread for one in found], settings.least_improvement),
    ):
        assert min(values[-last:]) >= less * min(values[:-last])
    assert min(one.unexplained for one in found) > settings.unexplained
    all_data = shares[-1] == 1  # are tried if it might be the noise
    assert all_data == (nearly_noise == np.inf)


def test_rounds_go_on_as_long_as_they_know_less_than_a_step_would():
    """Where noise hides that the data are not straight: else steps end in the next valley."""
    rng = np.random.default_rng(2)
    slope = rng.normal(size=(SIZE, 40))
    waves = Linear(np.zeros(40), slope / 3, bend=1.0, variance=np.full(40, 1.0))
    waves.data = waves.simulate(UNKNOWNS.white_noise.draw(rng, 2)[0]) + rng.normal(size=40)
    counts = {}
    for near, patience in [(np.inf, 3), (2.0, 3), (0.0, 3), (0.0, 6)]:
        settings = replace(
            SETTINGS, times_gauss_newton=near, unexplained=np.inf, patience_when_straight=patience
        )
        found = list(regression_rounds(waves, UNKNOWNS.white_noise, [0], settings))
        counts[near, patience] = len(found)
        if near == 2.0:
            step = linearise(waves, found[-1].distribution.mean)[1]
            bar = UNKNOWNS.site_std(np.linalg.inv(precision_of(waves, step)))
            assert found[-1].spread < 2.0 * bar
    assert counts[np.inf, 3] == 2  # one round on some data, one on all
    assert counts[np.inf, 3] < counts[2.0, 3] < counts[0.0, 3] < counts[0.0, 6] < 50


def test_rounds_on_lines_do_not_count_data_twice(linear):
    """They come no closer than the posterior, which is where the first of them cannot be yet."""
    exact = posterior(linear)
    settings = RoundSettings(unexplained=0.0, rounds=15, wider=1.0, least_widening=1.0)
    *_, last = regression_rounds(linear, UNKNOWNS.white_noise, [0], settings)
    std, least = (np.sqrt(np.diag(one.covariance)) for one in (last.distribution, exact))
    assert (std > 0.8 * least).all()
    assert (std < 5 * least).all()
    assert (abs(last.distribution.mean - exact.mean) < 4 * std).all()


def test_errors_of_the_regression_are_those_of_samples_it_has_not_seen(linear):
    """… and shown with noise: of the known kind, and of curves that lines leave."""
    rng = np.random.default_rng(6)
    slope = linear.slope / np.linalg.norm(linear.slope, axis=1, keepdims=True)
    bent = Linear(linear.data, slope, bend=0.1, variance=np.full(40, 0.3**2))
    z = rng.normal(size=(300, SIZE))
    Y = bent.simulate(z)
    residual = residual_variance(z, Y, np.ones(300))
    found = []
    for true in rng.normal(size=(400, SIZE)):
        data = bent.simulate(true[None])[0] + 0.3 * rng.normal(size=40)
        at, error = ridge_regression(replace(bent, data=data), z, Y, residual, np.ones(300))
        found.append(at - true)
    assert at.shape == (SIZE,)
    actual = np.array(found).T @ np.array(found) / len(found)
    assert 0.02 < np.trace(error) / SIZE < 0.5
    np.testing.assert_allclose(np.diag(actual), np.diag(error), rtol=0.3)
    nothing = ridge_regression(bent, z, 1e-6 * Y, np.zeros(40), np.ones(300))[1]
    np.testing.assert_allclose(nothing, np.eye(SIZE), atol=0.3)


def test_leaving_out_is_what_the_closed_form_says(linear):
    """Each sample's error without it, by fitting again without it."""
    rng = np.random.default_rng(8)
    z, weight = rng.normal(size=(30, SIZE)), rng.uniform(0.2, 2.0, 30)
    Y = z @ linear.slope
    exact = replace(linear, variance=np.full(40, 1e-12))
    residual = np.full(40, 100.0)
    error = ridge_regression(exact, z, Y, residual, weight)[1]

    def without(ridge):
        errors = []
        for i in range(30):
            kept = np.arange(30) != i
            w = weight[kept] / weight[kept].sum()
            A, own, mean = Y[kept] / 10, w @ Y[kept] / 10, w @ z[kept]
            fit = np.linalg.solve(
                ((A - own).T * weight[kept]) @ (A - own) + ridge * np.eye(40),
                ((A - own).T * weight[kept]) @ (z[kept] - mean),
            )
            errors.append((Y[i] / 10 - own) @ fit + mean - z[i])
        return np.sqrt(weight / weight.sum())[:, None] * errors

    best = min((without(weight.sum() * ridge) for ridge in RIDGES), key=np.linalg.norm)
    np.testing.assert_allclose(error, error_covariance(best), rtol=1e-6, atol=1e-9)


def test_no_direction_is_known_best_by_chance():
    """Errors alike in all directions are found so by few samples; others are told apart by many."""
    rng = np.random.default_rng(13)
    errors = rng.normal(size=(60, 12)) / np.sqrt(60)
    raw, found = (np.linalg.eigvalsh(S) for S in (errors.T @ errors, error_covariance(errors)))
    assert raw[0] < 0.5
    assert 0.8 < found[0] <= found[-1] < 1.2
    assert found.sum() == pytest.approx(raw.sum())
    unlike = rng.normal(size=(2000, 12)) * np.geomspace(0.01, 1, 12) / np.sqrt(2000)
    found = np.linalg.eigvalsh(error_covariance(unlike))
    np.testing.assert_allclose(found, np.geomspace(0.01, 1, 12) ** 2, rtol=0.2, atol=2e-3)


def test_network_features_weigh_as_much_as_they_are_right():
    """Data that teach nothing, and labels with errors of half the samples' σ."""
    rng = np.random.default_rng(12)
    z, Y, one = rng.normal(size=(300, SIZE)), rng.normal(size=(300, 40)), np.ones(300)
    nothing = Linear(np.zeros(40), np.zeros((SIZE, 40)))
    truth = rng.normal(size=(200, SIZE))
    labels, predicted = (x + 0.5 * rng.normal(size=x.shape) for x in (z, truth))
    residual = residual_variance(z, Y, one)
    without = ridge_regression(nothing, z, Y, residual, one)[1]
    assert np.trace(without) / SIZE > 0.9
    found = [
        ridge_regression(nothing, z, Y, residual, one, Features(3 * labels, 3 * label))
        for label in predicted
    ]
    constant = np.column_stack([labels, one])  # one label never varies
    same = Features(constant, np.append(predicted[0], 2.0))
    assert np.isfinite(ridge_regression(nothing, z, Y, residual, one, same)[0]).all()
    error = found[0][1]
    assert 0.2 < np.trace(error) / SIZE < 0.35  # 0.2 is Bayes' theorem's
    actual = np.array([at for at, _ in found]) - truth
    np.testing.assert_allclose((actual**2).mean(), np.trace(error) / SIZE, rtol=0.15)


def test_samples_of_earlier_proposals_count_as_if_drawn_from_the_last(linear):
    """Weighted means are the last proposal's; what is far from it is neither used nor simulated."""
    simulated = []

    class Counting(Linear):
        def simulate(self, X):
            simulated.append(len(X))
            return super().simulate(X)

    rng, wide = np.random.default_rng(10), UNKNOWNS.white_noise
    last = Gaussian(wide.mean + 0.3 * np.sqrt(np.diag(wide.covariance)), 0.8 * wide.covariance)
    elsewhere = replace(last, mean=last.mean + 20 * np.sqrt(np.diag(wide.covariance)))
    samples = ProposalSamples(Counting(linear.data, linear.slope), most=2000)
    for proposal in (elsewhere, wide, last):
        samples.draw(proposal, 666, rng)
    alone = ProposalSamples(samples.observation, most=2000)
    alone.draw(last, 600, rng)
    np.testing.assert_allclose(alone.weighted().weight, 1.0)
    simulated.clear()
    X, Y, weight, features = samples.weighted()
    assert features is None
    assert simulated == [666, 666]
    np.testing.assert_allclose(Y, X @ linear.slope)
    z = np.linalg.solve(np.linalg.cholesky(last.covariance), (X - last.mean).T).T
    assert 400 < weight.sum() ** 2 / (weight**2).sum()
    np.testing.assert_allclose(weight @ z / weight.sum(), 0.0, atol=0.15)
    np.testing.assert_allclose((z.T * weight) @ z / weight.sum(), np.eye(SIZE), atol=0.2)
    samples.draw(last, 10, rng)  # the oldest are forgotten
    assert len(samples.weighted().X) <= 2 * 666 + 10
    assert simulated == [666, 666, 10]


def test_weights_stand_for_samples(linear):
    """A sample of weight two is two samples."""
    rng = np.random.default_rng(9)
    z, twice = rng.normal(size=(20, 3)), np.repeat(np.arange(20), rng.integers(1, 3, 20))
    Y = rng.normal(size=(20, 40))
    weight = np.bincount(twice).astype(float)
    total, one = weight.sum(), np.ones(twice.size)
    residual, of_all = residual_variance(z, Y, weight), residual_variance(z[twice], Y[twice], one)
    effective = total**2 / (weight**2).sum()
    ratio = effective / (effective - 4) * (total - 4) / total
    np.testing.assert_allclose(residual, ratio * of_all)
    at = ridge_regression(linear, z, Y, residual, weight)[0]
    np.testing.assert_allclose(
        at, ridge_regression(linear, z[twice], Y[twice], residual, one)[0], atol=0.05
    )


def test_lines_leave_nothing_of_lines():
    rng = np.random.default_rng(1)
    X, slope = rng.normal(size=(12, 3)), rng.normal(size=(3, 7))
    np.testing.assert_allclose(residual_variance(X, X @ slope + 2.0, np.ones(12)), 0.0, atol=1e-20)
    noisy = X @ slope + rng.normal(size=(12, 7))
    assert residual_variance(X, noisy, np.ones(12)).mean() == pytest.approx(1.0, abs=0.5)


def test_rounds_and_checkpoints_survive_json(linear, tmp_path):
    one = next(iter(regression_rounds(linear, UNKNOWNS.white_noise, [0], SETTINGS)))
    path = tmp_path / "notes.json"
    notes = Checkpoint(path, b"run")
    notes.cached("round", one.to_dict)
    again = Checkpoint(path, b"run")
    assert len(again) == 1
    read = Round.from_dict(again.cached("round", lambda: pytest.fail("calculated again")))
    np.testing.assert_array_equal(read.distribution.covariance, one.distribution.covariance)
    other = Checkpoint(path, b"another run")
    assert len(other) == 0
    other.cached("round", one.to_dict)
    assert [len(Checkpoint(path, run)) for run in (b"run", b"another run")] == [1, 1]
