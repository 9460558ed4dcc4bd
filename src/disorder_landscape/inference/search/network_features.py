"""The network's word on every wire of the rounds, as if it were further data of that wire.

What a network says of a wire is a function of the conductances that ridge regression cannot find:
with many components it is the better part of what can be learned from far away. Its labels are
regressed on like data, so that it is never believed more than it is right about wires that are
drawn about the present answer.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.first_guess import as_seen, network_labels
from disorder_landscape.learning.model import TrainedModel
from disorder_landscape.model.parameters import FloatArray


class Said(NamedTuple):
    """Labels of samples, shape (sample, label), and of the measurement, shape (label,)."""

    of_samples: FloatArray
    of_data: FloatArray


@dataclass(frozen=True, eq=False)
class Word:
    """A network, and the part of a measurement that is on its grid."""

    model: TrainedModel
    seen: Observation

    def features_of_samples(self, Y: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Return what it says of samples' data (sample, datum) if they had errors, too."""
        return self._labels(Y + np.sqrt(self.seen.variance) * rng.normal(size=Y.shape))

    @cached_property
    def on_data(self) -> FloatArray:
        """What it says of the measurement, shape (label,)."""
        return np.asarray(self._labels(self.seen.data[None])[0])

    def _labels(self, Y: FloatArray) -> FloatArray:
        G = Y.reshape(-1, *self.seen.measurement.G.shape)
        names = self.model.labels.names
        predicted = [name in names for name in self.seen.unknowns.names]
        return network_labels(self.model, self.seen.unknowns, G)[:, predicted]


def word_on(model: TrainedModel | None, observation: Observation, share: float) -> Word | None:
    """Return a network's word on a measurement, if it needs no more than this share of its data.

    Rounds simulate no more than their share; a network that needs more would slow them down.
    """
    if model is None:
        return None
    seen = as_seen(model.config.dataset, observation)
    return Word(model, seen) if seen.data.size <= share * observation.data.size else None
