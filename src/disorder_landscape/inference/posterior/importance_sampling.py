"""Samples of a posterior that is no normal distribution: importance sampling.

Where the noise hides much, the posterior is as wide as a peak of the conductances or wider. Then it
is no normal distribution about one optimum. It bends, and has several maxima. But the normal
distributions about the optima are nearly as wide as it is. So samples of a mixture of t
distributions of the same centres and widths (proposal.py), weighted with the exact posterior, are
samples of the posterior. If few of them have most of the weight, the mixture is fitted to the
weighted samples, and so on: each of its parts gets the mean, the covariance and the share of the
samples that it is responsible for (Cappé et al., Stat. Comput. 18, 447 (2008)). All samples count,
as if drawn from the mixture of all proposals (adaptive multiple importance sampling: Cornuet et
al., Scand. J. Stat. 39, 798 (2012)). As long as a few samples have all the weight, the weights are
tempered: raised to a power below one (Koblents and Míguez, Stat. Comput. 25, 407 (2015)).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from scipy.special import softmax

from disorder_landscape.inference.checkpoint import Cache, uncached
from disorder_landscape.inference.posterior import proposal
from disorder_landscape.inference.posterior.weighted_samples import ImportanceSamples, tempered
from disorder_landscape.inference.problem.gaussian import Gaussian, log_density, log_mixture
from disorder_landscape.inference.problem.observation import Observation, objective, overall_misfit
from disorder_landscape.inference.problem.straightened import Straightened
from disorder_landscape.inference.stages import Report, no_report
from disorder_landscape.model.parameters import FloatArray

FIRST_BATCH = 64
"""Samples that are drawn first."""
LARGEST_BATCH, LARGEST_BATCH_PER_UNKNOWN = 128, 12
"""Each further batch has at most so many samples, or so many for each unknown if these are more."""
SMALLEST_BATCH = 32
"""It has as many as are still needed, but no fewer than this."""
ITERATIONS = 16
"""At most, even if samples are still needed then."""
LEAST_SHARE = 0.25
"""The weights from which the next proposal is made are tempered until the effective sample size is
this share of the samples, or of a largest batch if there are more."""
KEPT = 0.3
"""Proposals are drawn from again if the effective sample size is this share of the samples, and
none is fitted to the first batch. Proposals that are fitted to few samples miss the regions that
these miss. Like this the samples of a normal posterior of eleven unknowns are right within 3 %."""
WIDER = 1.2
"""The second proposals have this many times the standard deviation of the first ones, and fitted
proposals of the weighted samples. (Of a normal posterior of twelve unknowns that is 1.5 times as
wide as the first proposals, the variance comes out 7 % too small without this, and right with it.)
"""
LEAST_PART = 0.1
"""Each part of a mixture gets this part of an equal share of the samples at least.
…"""
LEAST_SAMPLES = 0.25
"""… It stays as it is if it is responsible for less than this much of one of the samples."""
WHITE_NOISE = Straightened({})
"""Proposals are t distributions of the unknowns themselves."""


class Part(NamedTuple):
    """One t distribution of a mixture: mean and scale matrix, and its share."""

    scale: Gaussian
    share: float


def importance_sampling(
    observation: Observation,
    mixture: Sequence[Part],
    seed: Sequence[int],
    cache: Cache = uncached,
    progress: Report = no_report,
    straightened: Straightened = WHITE_NOISE,
) -> Iterator[ImportanceSamples]:
    """Draw samples of the posterior, until they are enough or worth no more time.

    Parameters
    ----------
    observation : Observation
    mixture : sequence of Part
        Where the first samples come from, which must be about as wide as the posterior.
    seed : sequence of int
    cache : callable, optional
        `Checkpoint.cached`.
    progress : callable, optional
        Called after each iteration, with its number, the root-mean-square misfit of the most
        probable sample in e²/h and the standard deviation of V in meV.
    straightened : Straightened
        The variables in which proposals are t distributions.

    Yields
    ------
    ImportanceSamples
        All samples so far, after each iteration; of a wider distribution than the posterior where
        they are too few for that (`power`).
    """
    unknowns = observation.unknowns
    most = max(LARGEST_BATCH, LARGEST_BATCH_PER_UNKNOWN * len(unknowns.names))
    count = FIRST_BATCH
    drawn: list[tuple[Gaussian, int]] = []
    straight, height = np.empty((0, len(unknowns.names))), np.empty(0)
    mixture = in_straight_variables(mixture, straightened)
    for number in range(ITERATIONS):
        rng = np.random.default_rng([*seed, number])
        each = _numbers(mixture, count)
        now = [(part.scale, k) for part, k in zip(mixture, each, strict=True)]
        drawn += now
        inside = np.zeros(0, dtype=bool)
        while not inside.any():  # of a few, all may be beyond the walls
            new = np.concatenate([proposal.draw(scale, rng, k) for scale, k in now])
            inside = np.isfinite(straightened.log_stretch(new))
        name = f"importance_sampling.{'.'.join(map(str, seed))}.{number}"
        X = straightened.white_noise(new[inside])
        simulated = cache(name, partial(_simulated, observation, X))
        height_new = np.full(len(new), np.inf)
        height_new[inside] = simulated["height"]
        straight, height = np.concatenate([straight, new]), np.append(height, height_new)
        log_posterior = straightened.log_stretch(straight) - 0.5 * height
        counted = int(np.isfinite(log_posterior).sum())
        least = LEAST_SHARE * min(most, counted)
        log_proposal = log_mixture(drawn, straight, proposal.log_density)
        found = tempered(straight, log_posterior - log_proposal, least)
        progress(number, simulated["misfit"], unknowns.site_std(found.moments.covariance))
        yield replace(found, samples=straightened.white_noise(straight), height=height)
        if found.is_enough:
            return
        count = most
        if number == 0:
            mixture = [Part(widened(part.scale, WIDER), part.share) for part in mixture]
        elif found.effective_sample_size < KEPT * counted:
            mixture = fitted(mixture, found)
        elif found.power == 1:
            count = min(most, max(SMALLEST_BATCH, found.still_needed))


def in_straight_variables(mixture: Sequence[Part], straightened: Straightened) -> list[Part]:
    """Return a mixture in straight variables, to first order."""
    return [Part(straightened.of_gaussian(part.scale), part.share) for part in mixture]


def _numbers(mixture: Sequence[Part], count: int) -> list[int]:
    """Return how many samples each part gets, an even number."""
    share = np.maximum([part.share for part in mixture], LEAST_PART / len(mixture))
    return [2 * int(np.ceil(count * one / 2)) for one in share / share.sum()]


def fitted(mixture: Sequence[Part], found: ImportanceSamples) -> list[Part]:
    """Return a mixture that is nearer to the posterior, by one step of expectation maximisation.

    That is the step for normal distributions: t distributions of the same scales are wider. A
    part's covariance is mixed with what it was, the more so the fewer samples it has.
    """
    X, size = found.samples, found.samples.shape[1]
    responsible = found.weight * responsibilities(mixture, X)
    parts = []
    for part, weight in zip(mixture, responsible, strict=True):
        own_share = weight.sum()
        if own_share < LEAST_SAMPLES / len(X):
            parts.append(Part(part.scale, own_share))
            continue
        own = ImportanceSamples(X, weight / own_share)
        few, many, new = size, own.effective_sample_size, widened(own.uncorrected_moments, WIDER)
        covariance = (many * new.covariance + few * part.scale.covariance) / (many + few)
        parts.append(Part(Gaussian(new.mean, covariance), own_share))
    return parts


def responsibilities(mixture: Sequence[Part], X: FloatArray) -> FloatArray:
    """Return how probably each part, if it is normal, has made X (sample, unknown): (part, sample).

    For each sample the sum is one.
    """
    share = np.maximum([part.share for part in mixture], np.finfo(float).tiny)
    density = np.array([log_density(part.scale, X) for part in mixture])
    return np.asarray(softmax(np.log(share)[:, None] + density, axis=0))


def widened(answer: Gaussian, factor: float) -> Gaussian:
    """Return a wider distribution, as proposals of importance sampling have to be."""
    return Gaussian(answer.mean, factor**2 * answer.covariance)


def _simulated(observation: Observation, X: FloatArray) -> dict[str, Any]:
    """Return the `height` of samples, −2 log of the posterior density, and the least `misfit`."""
    Y = observation.simulate(X)
    height = objective(observation, X, Y)
    return {
        "height": height.tolist(),
        "misfit": overall_misfit(observation, Y[int(height.argmin())]),
    }
