"""Kind "inversions": how far off the answers for fresh wires are, and what they say of it.

One row per wire and noise, with what the accuracy, the calibration and the verdicts are judged by.
"""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np

from disorder_landscape.inference.search.first_guess import network_labels
from disorder_landscape.observables.topological_overlap import topological_points
from disorder_landscape.studies.fresh_wires import (
    FreshWiresPlan,
    Task,
    fresh_wire,
    inverted,
    network_of,
)
from disorder_landscape.studies.rows import rounded
from disorder_landscape.studies.study import Place
from disorder_landscape.studies.truth import labels, more_probable, site_distance, z_scores


class InversionsPlan(FreshWiresPlan):
    """Inversions of fresh wires."""

    kind: Literal["inversions"]

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Invert the measurement of a fresh wire."""
        return [inversion_row(task)]


def inversion_row(task: Task) -> dict[str, object]:
    """Invert the measurement of a fresh wire and compare the answer with the truth.

    Returns
    -------
    dict
        V errors in meV, root mean square over the sites; the errors of α in meV nm; `scaled_error`,
        the mean square error of the paper's labels in units of their variance, which is 1 − R²;
        `z_scores` of the true unknowns (`truth.z_scores`); `more_probable`, how much of the
        posterior is more probable than the truth; at how many (μ, B) both the wire and the answer
        are topological, and at how many either is; and the outcome of `Inverted`.
    """
    observation, truth = fresh_wire(task)
    unknowns, network = observation.unknowns, network_of(task.model, task.noise)
    found = inverted(observation, network, task.index)
    mean = found.answer.mean
    guess = network_labels(network, unknowns, observation.measurement.G[None])[0]
    alpha = partial(unknowns.parameter, "alpha")
    papers = np.array([name != "mean" for name in unknowns.names])
    true, answered, guessed = (labels(unknowns, x) for x in (truth, mean, guess))
    variance = unknowns.label_std**2
    measured = observation.measurement
    true_wire, wire = (d.wire for d in unknowns.devices(np.array([truth, mean]), measured))
    both, either = topological_points([true_wire], [wire], measured.mu.max(), measured.B.max())
    row: dict[str, object] = {
        "model": task.model,
        "noise": task.noise,
        "index": task.index,
        "network_error": site_distance(unknowns, guess, truth),
        "site_error": site_distance(unknowns, mean, truth),
        "network_scaled_error": ((guessed - true) ** 2 / variance)[papers].mean(),
        "scaled_error": ((answered - true) ** 2 / variance)[papers].mean(),
        "network_alpha_error": abs(alpha(guess) - alpha(truth)),
        "alpha_error": abs(alpha(mean) - alpha(truth)),
        "more_probable": more_probable(observation, found.found, truth),
        "both_topological": both,
        "either_topological": either,
        **found.outcome,
    }
    return {**rounded(row), "z_scores": " ".join(f"{z:.3f}" for z in z_scores(found.found, truth))}
