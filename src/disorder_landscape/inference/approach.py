"""The way in from far: the unknowns regressed on the data, round after round.

Far from the answer the conductances are too rough for lines through them, but what the unknowns are
can be learned from the conductances even so: as the network does for all wires, ridge regression
does it for those that are drawn about the present answer, a few hundred. Its error, by leaving out
one wire at a time, says how far to trust it, and the next wires are drawn accordingly. So a
measurement leads from the disorder model's prior to where the smoother can follow its slopes,
without any network.

This is sequential neural posterior estimation (Papamakarios and Murray, NIPS 2016) with a linear
network: the wires of a round are drawn from a proposal, and what the regression learns from the
data is put back upon the prior, so that no datum counts twice.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from sklearn.linear_model import RidgeCV

from disorder_landscape.inference.observation import Observation
from disorder_landscape.inference.smoother import Recall, Step, regression
from disorder_landscape.inference.unknowns import Gaussian
from disorder_landscape.learning.scaling import COMPRESSION, NOISE_FLOOR
from disorder_landscape.physics.parameters import FloatArray


@dataclass(frozen=True)
class ApproachSettings:
    """How the rounds go about it."""

    members_per_unknown: float = 20.0
    """Wires that are simulated in each round, for each unknown, …"""
    least_members: int = 200
    """… and of how many there are at least."""
    share: float = 0.25
    """Of the data, the same in all rounds."""
    wider: float = 1.2
    """The next round's wires are drawn this much more widely than the answer says, …"""
    nearer: float = 0.75
    farther: float = 4.0
    """… and as much more, or less, as the data lie farther out than this round's members, or nearer
    to the middle; between these factors in variance."""
    least_shrinking: float = 0.35
    """A round makes no direction's deviation smaller than this part of what it was."""
    unexplained: float = 1.0
    """Done when lines through the conductances leave less unexplained than the noise, …"""
    patience: int = 8
    """… or when what they leave has not become less in so many rounds: these lead nowhere."""
    rounds: int = 30


def approach(
    observation: Observation,
    start: Gaussian,
    seed: list[int],
    settings: ApproachSettings,
    recall: Recall = lambda name, calculate: calculate(),
) -> Iterator[Step]:
    """Yield round after round, until the smoother can go on or rounds no longer help.

    Each is a function of the one before and of (seed, number of the round).
    """
    part = observation.on_some_lines(settings.share, np.random.default_rng(seed))
    distribution, least, least_at = start, np.inf, 0
    for number in range(settings.rounds):
        make = partial(_round, part, distribution, [*seed, number], settings)
        step = Step.from_dict(recall(f"approach.{'.'.join(map(str, seed))}.{number}", make))
        yield step
        if step.unexplained < least:
            least, least_at = step.unexplained, number
        if least < settings.unexplained or number - least_at >= settings.patience:
            return
        distribution = step.distribution


def _round(
    observation: Observation,
    distribution: Gaussian,
    seed: list[int],
    settings: ApproachSettings,
) -> dict[str, Any]:
    rng = np.random.default_rng([*seed, 1])
    return approach_round(observation, distribution, rng, settings).to_dict()


def approach_round(
    observation: Observation,
    proposal: Gaussian,
    rng: np.random.Generator,
    settings: ApproachSettings,
) -> Step:
    """Draw members, simulate them with errors, and regress the unknowns on what they show."""
    unknowns, prior = observation.unknowns, observation.unknowns.prior
    root = np.linalg.cholesky(proposal.covariance)
    members = max(settings.least_members, round(settings.members_per_unknown * prior.mean.size))
    z = rng.normal(size=(members, prior.mean.size))
    X = proposal.mean + z @ root.T
    Y = observation.simulate(X)
    residual = regression(X, Y)[3]
    shown = Y + np.sqrt(observation.variance) * rng.normal(size=Y.shape)
    at, error = regress_on_data(observation, shown, z)
    share, directions = np.linalg.eigh(error)
    share = np.clip(share, settings.least_shrinking**2, 1 - 1e-3)
    error = (directions * share) @ directions.T
    # members' own answers have the variance 1 − error: do the data lie as far out as these?
    outside = (at**2).mean() / (1 - share).mean()
    widening = settings.wider**2 * float(np.clip(outside, settings.nearer, settings.farther))
    learned = Gaussian(proposal.mean + root @ at, root @ error @ root.T)
    answer = _upon_the_prior(learned, proposal, prior)
    wider = Gaussian(answer.mean, answer.covariance * widening)
    spread = unknowns.site_deviation(wider.covariance)
    step = np.linalg.solve(root, answer.mean - proposal.mean)
    return Step(
        distribution=wider,
        misfit=float(np.sqrt(((observation.data - Y.mean(axis=0)) ** 2).mean())),
        unexplained=float(np.sqrt((residual / observation.variance).mean())),
        length=float(np.sqrt((step**2).mean())),
        spread=spread,
        shrinking=spread / unknowns.site_deviation(proposal.covariance),
    )


def regress_on_data(
    observation: Observation, shown: FloatArray, z: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Learn what members z (member, unknown) are from what they show (member, datum).

    Returns
    -------
    at : array, shape (unknown,)
        What the measurement's are.
    error : array, shape (unknown, unknown)
        Mean product of the errors for members that were left out.
    """
    scale = COMPRESSION[observation.channel]
    compressed = np.arcsinh(shown / scale)
    # in units of what lines through the members leave, with the experiment's errors at least
    deviation = np.sqrt(regression(z, compressed)[3] + (NOISE_FLOOR / scale) ** 2)
    ridge = RidgeCV(
        alphas=shown.shape[1] * np.logspace(-5, 1, 13),
        scoring="neg_mean_squared_error",
        store_cv_results=True,
    )
    ridge.fit(compressed / deviation, z)
    at = ridge.predict((np.arcsinh(observation.data / scale) / deviation)[None])[0]
    chosen = int(np.argmin(abs(np.asarray(ridge.alphas) - ridge.alpha_)))
    left_out = ridge.cv_results_[:, :, chosen] - z
    return np.asarray(at), np.asarray(left_out.T @ left_out / len(z))


def _upon_the_prior(learned: Gaussian, proposal: Gaussian, prior: Gaussian) -> Gaussian:
    """Put what was learned about members of a proposal upon the prior instead."""
    new, old, first = (np.linalg.inv(one.covariance) for one in (learned, proposal, prior))
    covariance = np.linalg.inv(first + new - old)
    mean = covariance @ (first @ prior.mean + new @ learned.mean - old @ proposal.mean)
    return Gaussian(mean, np.asarray((covariance + covariance.T) / 2))
