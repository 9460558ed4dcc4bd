"""Kind "components": inversions of wires of more components than the paper's networks know.

The paper reckons with 1.2 million core-hours for the training set of 30 components (S-II.3). Here
each wire is inverted by itself, from the disorder model's prior; for 30 components a network that
is far from the answer serves as a source of features (`inference.search.network_features`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import ClassVar, Literal

import numpy as np

from disorder_landscape.config import DatasetConfig, Positive
from disorder_landscape.model.parameters import ALPHA, BIAS
from disorder_landscape.runs import THIRTY, shipped_model
from disorder_landscape.studies.fresh_wires import Noise, inverted, measured_wire, model_of
from disorder_landscape.studies.rows import rounded
from disorder_landscape.studies.study import Part, Place, Plan
from disorder_landscape.studies.truth import site_distance

THIRTY_COMPONENTS = 30
"""Of which there is a network. For them the paper expects 1.2 million core-hours."""


@dataclass(frozen=True, order=True)
class Task:
    """One inversion: the number of components, the noise in e²/h, the index of a fresh wire."""

    components: int
    noise: float
    index: int


class Wires(Part):
    """So many wires of each number of components, measured with each noise."""

    components: tuple[Positive, ...]
    noise: tuple[Noise, ...]
    """In e²/h."""
    count: Positive


class ComponentsPlan(Plan):
    """Inversions of fresh wires of many components."""

    kind: Literal["components"]
    points: Positive
    """Of the grid: μ and B each."""
    biases: Positive
    """Between the paper's largest ones; they cost nothing."""
    wires: tuple[Wires, ...]

    keys: ClassVar = ("components", "noise", "index")
    common: ClassVar = ("points", "biases")

    def tasks(self) -> Sequence[Task]:
        """Return the tasks, by components, noise and index."""
        return sorted(
            Task(components, noise, index)
            for group in self.wires
            for components in group.components
            for noise in group.noise
            for index in range(group.count)
        )

    def grid(self, components: int) -> DatasetConfig:
        """Return the disorder model and what is measured of its wires."""
        return DatasetConfig(
            realizations=1,
            components=components,
            alpha_range=(ALPHA, ALPHA),
            mu_points=self.points,
            B_points=self.points,
            bias=tuple(np.linspace(BIAS[0], BIAS[-1], self.biases).round(6).tolist()),
        )

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Invert the measurement of a fresh wire and compare the answer with the truth.

        Returns
        -------
        list of dict
            V errors in meV, root mean square over the sites: `prior_error` of V = 0, `site_error`
            of the answer; `mahalanobis`, the truth's squared distance in standard deviations over
            the number of unknowns; and the outcome of `Inverted`.
        """
        observation, truth = measured_wire(self.grid(task.components), task.noise, task.index)
        network = model_of(shipped_model(THIRTY)) if task.components == THIRTY_COMPONENTS else None
        found = inverted(observation, network, task.index)
        distance = partial(site_distance, observation.unknowns)
        row = {
            "components": task.components,
            "noise": task.noise,
            "index": task.index,
            "prior_error": distance(np.zeros_like(truth), truth),
            "site_error": distance(found.answer.mean, truth),
            "mahalanobis": float(found.answer.squared_distance(truth)) / truth.size,
            **found.outcome,
        }
        return [rounded(row)]
