"""Inversions of wires of more components than the paper's networks know, from the prior.

The paper reckons with 1.2 million core-hours for the training set of 30 components (S-II.3). Here
each wire is inverted by itself, from the disorder model's prior. For 30 components a network that
is far from the answer serves as a source of features (`inference.search.network_features`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from disorder_landscape.chain import THIRTY, shipped_model
from disorder_landscape.config import DatasetConfig
from disorder_landscape.model.parameters import ALPHA, BIAS
from disorder_landscape.studies.inversions import inverted, measured_wire, model_of, rounded

POINTS, BIASES = 20, 21
"""Of the grid: μ and B each, and between the paper's largest biases, which cost nothing."""
THIRTY_COMPONENTS = 30
"""Of which there is a network. For them the paper expects 1.2 million core-hours."""
KEYS = ["components", "noise", "index"]


@dataclass(frozen=True)
class Task:
    """One inversion: the number of components, the noise in e²/h, the index of a fresh wire."""

    components: int
    noise: float
    index: int


def measured_grid(components: int) -> DatasetConfig:
    """Return the disorder model and what is measured of its wires."""
    return DatasetConfig(
        realizations=1,
        components=components,
        alpha_range=(ALPHA, ALPHA),
        mu_points=POINTS,
        B_points=POINTS,
        bias=tuple(np.linspace(BIAS[0], BIAS[-1], BIASES).round(6).tolist()),
    )


def components_row(task: Task) -> dict[str, object]:
    """Invert the measurement of a fresh wire and compare the answer with the truth.

    Returns
    -------
    dict
        V errors in meV, root mean square over the sites: `prior_error` of V = 0, `site_error` of
        the answer; `mahalanobis`, the truth's squared distance in standard deviations over the
        number of unknowns; and the outcome of `Inverted`.
    """
    observation, truth = measured_wire(measured_grid(task.components), task.noise, task.index)
    network = model_of(shipped_model(THIRTY)) if task.components == THIRTY_COMPONENTS else None
    found = inverted(observation, network, task.index)
    distance = observation.unknowns.site_distance
    return rounded(
        {
            "components": task.components,
            "noise": task.noise,
            "index": task.index,
            "prior_error": distance(np.zeros_like(truth), truth),
            "site_error": distance(found.answer.mean, truth),
            "mahalanobis": float(found.answer.squared_distance(truth)) / truth.size,
            **found.outcome,
        }
    )
