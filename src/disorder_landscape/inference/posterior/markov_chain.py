"""Samples of the posterior, the check that it is normal, and whether it predicts further data.

The answer of an inversion is a normal distribution so narrow (some µeV) that the conductances are
linear in the unknowns across it. Whether that is so is tested by a Markov chain of the exact
posterior, which proposes samples of the answer and accepts them or not. All proposals are made at
once, and so simulated together (independence sampler: Tierney, Ann. Statist. 22, 1701 (1994)).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from disorder_landscape.inference.problem.observation import Observation, objective
from disorder_landscape.inference.problem.unknowns import Gaussian
from disorder_landscape.model.parameters import FloatArray

WIDER = 1.15
"""Proposals are this much wider than the answer, so that its tails are proposed."""
AT_A_TIME = 64
"""Samples that are simulated at a time."""


class Chain(NamedTuple):
    """Samples (sample, unknown) of an exact Markov chain, and the part of proposals it took."""

    samples: FloatArray
    acceptance: float


def independence_chain(
    observation: Observation, answer: Gaussian, length: int, rng: np.random.Generator
) -> Chain:
    """Draw from the exact posterior by Metropolis' rule, with an answer's samples as proposals.

    Parameters
    ----------
    observation : Observation
    answer : Gaussian
    length : int
        Of the chain, which starts at the answer's mean.
    rng : Generator
    """
    proposal = Gaussian(answer.mean, WIDER**2 * answer.covariance)
    X = proposal.draw(rng, length + length % 2)[:length]
    rng.shuffle(X)  # the pairs about the mean
    X = np.concatenate([answer.mean[None], X])
    blocks = np.array_split(X, max(1, len(X) // AT_A_TIME))
    Y = np.concatenate([observation.simulate(block) for block in blocks])
    log_weight = -0.5 * (objective(observation, X, Y) - proposal.squared_distance(X))
    present, taken = 0, 0
    chain = np.empty_like(X[1:])
    for i in range(1, len(X)):
        if np.log(rng.random()) < log_weight[i] - log_weight[present]:
            present, taken = i, taken + 1
        chain[i - 1] = X[present]
    return Chain(chain, taken / length)


def predictive_p(
    Y: FloatArray, data: FloatArray, variance: FloatArray, rng: np.random.Generator
) -> float:
    """Return how likely an answer makes further data as unlike its prediction as these or more.

    The posterior predictive p-value of χ² (Gelman, Meng and Stern, Stat. Sinica 6, 733 (1996)):
    what samples of the answer show at the new settings is given errors, and the data are counted
    among them. What the samples do not agree on weighs less.

    Parameters
    ----------
    Y : array, shape (sample, datum)
        What samples of the answer show.
    data, variance : array, shape (datum,)
        Which the inversion has not seen, K'_full of S-II.1, and the variance of their errors.
    rng : Generator
    """
    replicates = Y + np.sqrt(variance) * rng.normal(size=Y.shape)
    mean, both = Y.mean(axis=0), Y.var(axis=0, ddof=1) + variance
    chi_square = ((np.vstack([data, replicates]) - mean) ** 2 / both).sum(axis=1)
    return float((chi_square >= chi_square[0]).mean())
