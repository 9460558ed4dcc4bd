"""Samples of a sequence of proposals, weighted as if all were drawn from the last one.

Where proposals change little from round to round, wires that earlier rounds have simulated serve
the next round as well. The weight of a sample is the ratio of two densities: that of the last
proposal, and that of the mixture of all proposals. This is the deterministic mixture, or balance
heuristic (Veach and Guibas, SIGGRAPH 1995; in adaptive importance sampling: Cornuet et al., Scand.
J. Stat. 39, 798 (2012)). It bounds the weights: the last proposal is part of the mixture.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from disorder_landscape.inference.problem.gaussian import Gaussian, log_density, log_mixture
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.network_features import Features, NetworkFeatures
from disorder_landscape.model.parameters import FloatArray

LEAST_WEIGHT = 1e-3
"""Samples of less weight are left out."""


class TrainingSamples(NamedTuple):
    """Samples (sample, unknown), their data (sample, datum), and their weights (sample,)."""

    X: FloatArray
    Y: FloatArray
    weight: FloatArray
    features: Features | None
    """What the network predicts of them and of the measurement."""


class _Simulated(NamedTuple):
    """Data (sample, datum), and the network's labels (sample, label), if there is a network."""

    Y: FloatArray
    labels: FloatArray


@dataclass(eq=False)
class _Drawn:
    """Samples of one proposal, which are simulated when they are needed."""

    proposal: Gaussian
    X: FloatArray
    rng: np.random.Generator
    simulated: _Simulated | None = None


@dataclass(eq=False)
class ProposalSamples:
    """What has been drawn from proposal after proposal.

    Parameters
    ----------
    observation : Observation
        Which data are simulated.
    most : int
        How many samples are kept. The oldest are dropped first.
    network : NetworkFeatures, optional
        Makes features of these data.
    """

    observation: Observation
    most: int
    network: NetworkFeatures | None = None
    _drawn: list[_Drawn] = field(default_factory=list)

    def draw(self, proposal: Gaussian, count: int, rng: np.random.Generator) -> None:
        """Draw so many samples of the next proposal."""
        root = np.linalg.cholesky(proposal.covariance)
        X = proposal.mean + rng.normal(size=(count, proposal.mean.size)) @ root.T
        self._drawn.append(_Drawn(proposal, X, rng))
        while sum(len(drawn.X) for drawn in self._drawn) > max(self.most, count):
            self._drawn.pop(0)

    def weighted(self) -> TrainingSamples:
        """Return the samples that have weight in the last proposal."""
        count = np.array([len(drawn.X) for drawn in self._drawn])
        X = np.concatenate([drawn.X for drawn in self._drawn])
        mixture = log_mixture([(drawn.proposal, len(drawn.X)) for drawn in self._drawn], X)
        weight = np.exp(log_density(self._drawn[-1].proposal, X) - mixture)
        counts = weight > LEAST_WEIGHT
        some = np.split(counts, np.cumsum(count)[:-1])
        simulated = [
            [part[here] for part in self._simulated(drawn)]
            for drawn, here in zip(self._drawn, some, strict=True)
            if here.any()
        ]
        Y, labels = (np.concatenate(parts) for parts in zip(*simulated, strict=True))
        features = None if self.network is None else Features(labels, self.network.features_of_data)
        return TrainingSamples(X[counts], Y, weight[counts], features)

    def _simulated(self, drawn: _Drawn) -> _Simulated:
        if drawn.simulated is None:
            Y = self.observation.simulate(drawn.X)
            labels = np.empty((len(Y), 0))
            if self.network is not None:
                labels = self.network.features_of_samples(Y, drawn.rng)
            drawn.simulated = _Simulated(Y, labels)
        return drawn.simulated
