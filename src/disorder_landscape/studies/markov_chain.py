"""A Markov chain of the exact posterior, which checks that the posterior is a normal distribution.

The answer of an inversion is a normal distribution so narrow (some µeV) that the conductances are
linear in the unknowns across it. The chain checks that. It proposes samples of the answer, and
accepts them or not, by the exact posterior. All proposals are made at once, and so simulated
together (independence sampler: Tierney, Ann. Statist. 22, 1701 (1994)).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation, objective
from disorder_landscape.model.parameters import FloatArray

WIDER = 1.15
"""Proposals have this many times the answer's standard deviation, to reach its tails."""
AT_A_TIME = 64
"""Samples that are simulated at a time."""


class Chain(NamedTuple):
    """Samples (sample, unknown) of an exact Markov chain, and the share of accepted proposals."""

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
    present, accepted = 0, 0
    chain = np.empty_like(X[1:])
    for i in range(1, len(X)):
        if np.log(rng.random()) < log_weight[i] - log_weight[present]:
            present, accepted = i, accepted + 1
        chain[i - 1] = X[present]
    return Chain(chain, accepted / length)
