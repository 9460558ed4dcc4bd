"""Whether the posterior is a normal distribution about the best optimum, and its samples if not."""

from __future__ import annotations

from collections.abc import Sequence

from scipy.special import softmax

from disorder_landscape.inference.checkpoint import Cache, uncached
from disorder_landscape.inference.optimum import NEGLIGIBLE, Optimum, best, shares
from disorder_landscape.inference.posterior import proposal
from disorder_landscape.inference.posterior.importance_sampling import (
    Part,
    importance_sampling,
    in_straight_variables,
    responsibilities,
)
from disorder_landscape.inference.posterior.weighted_samples import ImportanceSamples
from disorder_landscape.inference.problem.gaussian import Gaussian, log_density
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.straightened import Straightened
from disorder_landscape.inference.stages import Report, no_report
from disorder_landscape.model.parameters import FloatArray

STRAIGHT = 1.08e-3
"""Whether the posterior is a normal distribution is asked if several parameters of the device are
unknown, or the error bar of V is more than this in meV, about the width of levels. By Mahalanobis
distances of the truth, Laplace's error bars are right below that and often too small above it."""
NORMAL, LEAST_NORMAL = 0.97, 0.3
"""… The posterior is taken for Laplace's approximation if samples of the latter, weighted by the
exact posterior, are effective to a share of at least NORMALⁿ, and never less than LEAST_NORMAL:
each unknown may make a little worse what many make much worse. (Of a normal posterior that is wider
by 10 % in seven directions it is 0.86, by 20 % 0.47.)"""
MOST_UNKNOWNS = 64
"""Of so many unknowns samples are drawn, and no more. Of 150, 64 samples of Laplace's approximation
are as few as 16 even with weights to the power 0.29, and ten iterations take half an hour and are
not enough. (That wire's truth is where Laplace's approximation has it: 180 error bars squared away,
and 143 above the optimum in −2 log(posterior). So it is of five such wires in eight.)"""


def posterior_samples(
    observation: Observation,
    optima: Sequence[Optimum],
    seed: Sequence[int],
    cache: Cache = uncached,
    progress: Report = no_report,
) -> ImportanceSamples | None:
    """Return samples of the posterior where it is no normal distribution about the best optimum.

    None where it is, and where there are too many unknowns to ask. Too few, so that the answer is
    not accepted, where these have several optima.
    """
    chosen, unknowns = best(optima), observation.unknowns
    has_many = len(unknowns.names) > MOST_UNKNOWNS
    if not chosen.fits:
        return None
    share = shares(optima)
    counts = [k for k in range(len(optima)) if share[k] > NEGLIGIBLE]
    straightened = Straightened.about(chosen.answer, unknowns)
    may_be_normal = len(counts) == 1 and not straightened.parameters
    is_sharp = unknowns.site_std(chosen.answer.covariance) < STRAIGHT
    is_narrow = is_sharp and not unknowns.has_several_parameters
    if may_be_normal and (is_narrow or has_many):
        return None
    mixture = _mixture([optima[k] for k in counts], share[counts])
    needed = max(NORMAL ** len(unknowns.names), LEAST_NORMAL)
    batches = importance_sampling(observation, mixture, seed, cache, progress, straightened)
    for number, found in enumerate(batches):
        if number == 0 and may_be_normal and normality(found, chosen.answer) > needed:
            return None
        if has_many:
            break
    return found


def posterior_shares(
    observation: Observation, optima: Sequence[Optimum], found: ImportanceSamples | None
) -> FloatArray:
    """Return the share of the posterior that each optimum has (optimum,).

    By its samples, or by Laplace's approximation where there are none.
    """
    share = shares(optima)
    if found is None:
        return share
    straightened = Straightened.about(best(optima).answer, observation.unknowns)
    mixture = in_straight_variables(_mixture(optima, share), straightened)
    return responsibilities(mixture, straightened.of_white_noise(found.samples)) @ found.weight


def _mixture(optima: Sequence[Optimum], share: FloatArray) -> list[Part]:
    return [Part(one.answer, float(part)) for one, part in zip(optima, share, strict=True)]


def normality(found: ImportanceSamples, answer: Gaussian) -> float:
    """Return what share of samples of an answer is effective if weighted by the exact posterior.

    Parameters
    ----------
    found : ImportanceSamples
        Samples of its t distribution, with the weights of the posterior.
    answer : Gaussian
    """
    X = found.samples
    of_answer = softmax(log_density(answer, X) - proposal.log_density(answer, X))
    return 0.0 if found.power < 1 else float(1 / (found.weight**2 / of_answer).sum())
