"""What a network predicts of each simulated wire, as features of the regression.

A prediction of the network is a function of the conductances that ridge regression on them cannot
represent. With many components it is the better part of what can be learned far from the answer.
The predictions are regressed on, like conductances. So their weight follows from how right they are
about wires near the present answer.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.first_guess import on_grid_of_network
from disorder_landscape.learning.model import TrainedModel
from disorder_landscape.model.parameters import FloatArray


class Features(NamedTuple):
    """Labels that a network predicts of samples (sample, label) and of the measurement (label,)."""

    of_samples: FloatArray
    of_data: FloatArray


@dataclass(frozen=True, eq=False)
class NetworkFeatures:
    """A network, and the part of a measurement that is on its grid."""

    model: TrainedModel
    on_grid: Observation

    def features_of_samples(self, Y: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Return the labels predicted from simulated data (sample, datum) with errors added."""
        return self._labels(Y + np.sqrt(self.on_grid.variance) * rng.normal(size=Y.shape))

    @cached_property
    def features_of_data(self) -> FloatArray:
        """The labels predicted from the measurement, shape (label,)."""
        return np.asarray(self._labels(self.on_grid.data[None])[0])

    def _labels(self, Y: FloatArray) -> FloatArray:
        G = Y.reshape(-1, *self.on_grid.measurement.G.shape)
        return np.asarray(self.model.predict_labels(G.astype(np.float32)), dtype=float)


def network_features(
    model: TrainedModel | None, observation: Observation, share: float
) -> NetworkFeatures | None:
    """Return a network as a source of features, if it needs at most this share of the data.

    Rounds simulate no more than their share of the data. A network that needs more would slow them
    down.
    """
    if model is None:
        return None
    on_grid = on_grid_of_network(model.config.dataset, observation)
    if on_grid.data.size > share * observation.data.size:
        return None
    return NetworkFeatures(model, on_grid)
