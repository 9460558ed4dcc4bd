"""Posteriors of few unknowns, which a grid over all of the prior gives without any search.

The data are so few and poor that much of the prior's width is left, in several valleys.
"""

import numpy as np
import pytest
from scipy.special import logsumexp, softmax

import disorder_landscape as dl
from disorder_landscape.inference import invert as inversion
from disorder_landscape.inference.problem.observation import objective
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.verdict import CONVERGED, NOT_CONVERGED, verdict
from disorder_landscape.studies.drawn_devices import Grid, drawn_device, measured_device

NOISE = 0.5
MEASURED = Grid(mu=(0.0, 0.6, 4), B_points=4, biases=3)


def on_a_grid(observation, components, points):
    """Return mean and standard deviation of the components, and the log evidence."""
    axis = np.linspace(-4, 4, points)
    C = np.stack(np.meshgrid(*[axis] * components, indexing="ij"), -1).reshape(-1, components)
    X = np.column_stack([C, np.zeros(len(C))])
    height = np.concatenate(
        [objective(observation, x, observation.simulate(x)) for x in np.array_split(X, 20)]
    )
    log_cell = components * np.log((axis[1] - axis[0]) / np.sqrt(2 * np.pi))
    weight = softmax(-0.5 * height)
    mean = weight @ C
    std = np.sqrt(weight @ (C - mean) ** 2)
    return mean, std, logsumexp(-0.5 * height) + log_cell


def poorly_measured(components, index):
    prior = dl.Prior(components, sites=40, alpha=8.0, mean_std=1e-9)  # V's mean is known
    unknowns = Unknowns(prior.for_measurement(MEASURED.grid))
    device, _ = drawn_device(unknowns, MEASURED.grid, [index])
    return measured_device(device, unknowns, MEASURED.grid, NOISE, [index])


@pytest.mark.parametrize(
    ("components", "points", "index"),
    [(2, 41, 1), (2, 41, 4)]
    + [pytest.param(3, 25, index, marks=pytest.mark.slow) for index in range(4)],
)
def test_samples_are_of_the_posterior_that_a_grid_gives(components, points, index):
    observation = poorly_measured(components, index)
    mean, std, log_evidence = on_a_grid(observation, components, points)
    found = inversion.invert(observation, None, seed=1)
    samples = found.importance_samples
    assert verdict(observation, found) == CONVERGED
    assert samples.log_mean_weight == pytest.approx(log_evidence, abs=0.25)
    found_std = np.sqrt(np.diag(found.answer.covariance))[:components]
    np.testing.assert_allclose(found.answer.mean[:components], mean, atol=0.35 * std.max())
    np.testing.assert_allclose(found_std, std, rtol=0.3)


def test_starts_go_on_until_the_samples_are_content(monkeypatch):
    """… or there have been as many as are worth their time; what had been drawn is drawn again."""
    observation, said, seeds = poorly_measured(1, 0), [], []
    verdicts = {"content": (CONVERGED,), "in the end": (NOT_CONVERGED, CONVERGED)}
    verdicts["never"] = 9 * (NOT_CONVERGED,)

    def posterior_samples(observation, optima, seed, cache, report):
        seeds.append(tuple(seed))
        said.append(sum(len(one.found_by) for one in optima))

    monkeypatch.setattr(inversion, "posterior_samples", posterior_samples)
    counts = {}
    for which, each in verdicts.items():
        one_after_the_other = iter(each)
        monkeypatch.setattr(inversion, "verdict", lambda *_, left=one_after_the_other: next(left))
        said.clear()
        seeds.clear()
        found = inversion.invert(observation, None, seed=1)
        assert sum(len(one.found_by) for one in found.optima) == said[-1]
        assert len(set(seeds)) == len(seeds)
        counts[which] = list(said)
    content, later, never = counts.values()
    assert len(content) == 1
    assert later == never[:2]
    assert content == later[:1]
    assert len(never) >= 3
    assert (np.diff(never) > 0).all()
