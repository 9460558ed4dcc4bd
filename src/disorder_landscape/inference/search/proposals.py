"""Samples of several proposals, weighted as if all were drawn from the last one.

Where proposals change little from round to round, wires that earlier rounds have simulated teach
the next one as well. Each counts with the ratio of the last proposal's density to that of the
mixture of all (the deterministic mixture, or balance heuristic: Veach and Guibas, SIGGRAPH 1995;
of adaptive importance sampling: Cornuet et al., Scand. J. Stat. 39, 798 (2012)), so that a sample
counts more than one of the last proposal's own only where these are few.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.unknowns import Gaussian
from disorder_landscape.inference.search.network_features import Said, Word
from disorder_landscape.model.parameters import FloatArray

LEAST_WEIGHT = 1e-3
"""Samples of less weight are not looked at."""


class Weighted(NamedTuple):
    """Samples (sample, unknown), what they show (sample, datum), and weights (sample,)."""

    X: FloatArray
    Y: FloatArray
    weight: FloatArray
    said: Said | None
    """What the network says, of them and of the measurement."""


class _Shown(NamedTuple):
    """Data (sample, datum) and the network's labels (sample, label), of which there may be none."""

    Y: FloatArray
    labels: FloatArray


@dataclass(eq=False)
class _Drawn:
    """Samples of one proposal; `shown` once they have been simulated."""

    proposal: Gaussian
    X: FloatArray
    rng: np.random.Generator
    shown: _Shown | None = None


@dataclass(eq=False)
class ProposalSamples:
    """What has been drawn from proposal after proposal.

    Parameters
    ----------
    observation : Observation
        Which data are simulated.
    most : int
        The oldest are forgotten where there are more.
    word : Word, optional
        Of the network on these data.
    """

    observation: Observation
    most: int
    word: Word | None = None
    _drawn: list[_Drawn] = field(default_factory=list)

    def draw(self, proposal: Gaussian, count: int, rng: np.random.Generator) -> None:
        """Draw so many samples of the next proposal; they are simulated when they are needed."""
        root = np.linalg.cholesky(proposal.covariance)
        X = proposal.mean + rng.normal(size=(count, proposal.mean.size)) @ root.T
        self._drawn.append(_Drawn(proposal, X, rng))
        while sum(len(drawn.X) for drawn in self._drawn) > max(self.most, count):
            self._drawn.pop(0)

    def weighted(self) -> Weighted:
        """Return the samples that count for the last proposal."""
        count = np.array([len(drawn.X) for drawn in self._drawn])
        X = np.concatenate([drawn.X for drawn in self._drawn])
        mixture = log_mixture([(drawn.proposal, len(drawn.X)) for drawn in self._drawn], X)
        weight = np.exp(log_density(self._drawn[-1].proposal, X) - mixture)
        counts = weight > LEAST_WEIGHT
        some = np.split(counts, np.cumsum(count)[:-1])
        shown = [
            [part[here] for part in self._simulated(drawn)]
            for drawn, here in zip(self._drawn, some, strict=True)
            if here.any()
        ]
        Y, labels = (np.concatenate(parts) for parts in zip(*shown, strict=True))
        said = None if self.word is None else Said(labels, self.word.on_data)
        return Weighted(X[counts], Y, weight[counts], said)

    def _simulated(self, drawn: _Drawn) -> _Shown:
        if drawn.shown is None:
            Y = self.observation.simulate(drawn.X)
            nothing = np.empty((len(Y), 0))
            labels = nothing if self.word is None else self.word.features_of_samples(Y, drawn.rng)
            drawn.shown = _Shown(Y, labels)
        return drawn.shown


def log_mixture(drawn: Sequence[tuple[Gaussian, int]], X: FloatArray) -> FloatArray:
    """Return the logarithm of the density of samples drawn from several normal distributions.

    Parameters
    ----------
    drawn : sequence of (Gaussian, int)
        The distributions, and how many samples were drawn from each.
    X : array, shape (sample, unknown)
    """
    count = np.array([number for _, number in drawn])
    log = np.array([log_density(gaussian, X) for gaussian, _ in drawn])
    return np.asarray(np.logaddexp.reduce(log + np.log(count / count.sum())[:, None], axis=0))


def log_density(gaussian: Gaussian, X: FloatArray) -> FloatArray:
    """Return the logarithm of a normal density at X (sample, unknown), shape (sample,).

    Up to the power of 2π.
    """
    determinant = np.linalg.slogdet(gaussian.covariance)[1]
    return np.asarray(-0.5 * (gaussian.squared_distance(X) + determinant))
