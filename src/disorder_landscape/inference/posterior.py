"""Members of the posterior, and the check that it is normal.

The answer of an inversion is a normal distribution so narrow (some µeV) that the conductances are
linear in the unknowns across it. Whether that is so is tested by a Markov chain of the exact
posterior, which proposes members of the answer and accepts them or not. All proposals are made at
once, and so simulated together (independence sampler: Tierney, Ann. Statist. 22, 1701 (1994)).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from disorder_landscape.inference.observation import Observation, squared_misfits
from disorder_landscape.inference.unknowns import Gaussian
from disorder_landscape.physics.parameters import FloatArray

WIDER = 1.15
"""Proposals are this much wider than the answer, so that its tails are proposed."""
AT_A_TIME = 64
"""Members that are simulated at a time."""


class Chain(NamedTuple):
    """Members (member, unknown) of an exact Markov chain, and the part of proposals it took."""

    members: FloatArray
    acceptance: float


def independence_chain(
    observation: Observation, answer: Gaussian, length: int, rng: np.random.Generator
) -> Chain:
    """Draw from the exact posterior by Metropolis' rule, with an answer's members as proposals.

    Parameters
    ----------
    observation : Observation
    answer : Gaussian
    length : int
        Of the chain, which starts at the answer's mean.
    rng : Generator
    """
    prior = observation.unknowns.prior
    proposal = Gaussian(answer.mean, WIDER**2 * answer.covariance)
    X = proposal.draw(rng, length + length % 2)[:length]
    rng.shuffle(X)  # the pairs about the mean
    X = np.concatenate([answer.mean[None], X])
    blocks = np.array_split(X, max(1, len(X) // AT_A_TIME))
    Y = np.concatenate([observation.simulate(block) for block in blocks])
    likelihood = squared_misfits(observation, Y).sum(axis=1)
    log_weight = -0.5 * (likelihood + prior.squared_distance(X) - proposal.squared_distance(X))
    present, taken = 0, 0
    chain = np.empty_like(X[1:])
    for i in range(1, len(X)):
        if np.log(rng.random()) < log_weight[i] - log_weight[present]:
            present, taken = i, taken + 1
        chain[i - 1] = X[present]
    return Chain(chain, taken / length)
