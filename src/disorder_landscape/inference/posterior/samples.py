"""Whether the posterior is a normal distribution about the best optimum, and its samples if not."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from disorder_landscape.inference.checkpoint import Cache, uncached
from disorder_landscape.inference.optimum import Optimum, best, shares
from disorder_landscape.inference.posterior.importance_sampling import (
    ImportanceSamples,
    Part,
    importance_sampling,
    weighted_samples,
    widened,
)
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.model.parameters import BOLTZMANN

STRAIGHT = 0.25
"""Whether the posterior is a normal distribution is asked if the error bar of V is more than this
many kT, or …"""
LEAST_WIDTH = 1e-3
"""… this in meV, about the width of levels. Conductances are peaks of about that width. By
Mahalanobis distances of the truth, Laplace's error bars are right below that width and often too
small above it."""
CHECKED = 64
"""Samples of Laplace's approximation that are weighted by the exact posterior to find out. …"""
NORMAL = 0.8
"""… It is the posterior if their effective sample size is this share of them. (Of a normal
posterior that is wider by 10 % in seven directions it is 0.86, by 20 % 0.47.)"""
NEGLIGIBLE = 1e-3
"""Optima with less than this share of the posterior are left out."""


def posterior_samples(
    observation: Observation,
    optima: Sequence[Optimum],
    seed: Sequence[int],
    cache: Cache = uncached,
    progress: Callable[[int, float, float], None] = lambda number, misfit, spread: None,
) -> ImportanceSamples | None:
    """Return samples of the posterior where it is no normal distribution about the best optimum."""
    chosen, unknowns = best(optima), observation.unknowns
    if not chosen.fits:
        return None
    share = shares(optima)
    counts = [k for k in range(len(optima)) if share[k] > NEGLIGIBLE]
    width = max(STRAIGHT * BOLTZMANN * observation.measurement.temperature, LEAST_WIDTH)
    if len(counts) == 1:
        if unknowns.site_std(chosen.answer.covariance) < width:
            return None
        name = f"is_normal.{'.'.join(map(str, seed))}"
        make = partial(_effective_share, observation, chosen.answer, [*seed, CHECKED])
        if cache(name, make)["share"] > NORMAL:
            return None
    mixture = [Part(widened(optima[k].answer), float(share[k])) for k in counts]
    return importance_sampling(observation, mixture, seed, cache, progress)


def _effective_share(
    observation: Observation, answer: Gaussian, seed: Sequence[int]
) -> dict[str, float]:
    """Return the effective `share` of an answer's samples if weighted by the exact posterior."""
    X = answer.draw(np.random.default_rng(seed), CHECKED)
    found = weighted_samples(observation, answer, X)
    return {"share": found.effective_sample_size / CHECKED}
