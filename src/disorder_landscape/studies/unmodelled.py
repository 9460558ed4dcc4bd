"""Kind "unmodelled": inversions of wires with something that the model lacks; what notices it.

Each row inverts a fresh wire of `studies.fresh_wires`, of which one thing is other than the model
has it, and asks two checks: the verdict, and measurements at other barriers (K'_full of S-II.1),
which the inversion has not seen. Rows of the kind "nothing" count false alarms. With a prior that
leaves the thing open, the answer should be right: `wide` does so with gap, temperature, barrier and
bias, and nearly with the dissipation, which its parent shares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

import numpy as np

from disorder_landscape.config import Positive
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.inference.defaults import OTHER_BARRIERS
from disorder_landscape.inference.problem.measurement import (
    Measurement,
    empty_measurement,
    simulated,
)
from disorder_landscape.inference.problem.noise import noise_of_channels
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.verification.predictive import predictive_p
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.studies.fresh_wires import (
    SEED,
    Noise,
    ShippedModel,
    inverted,
    measured,
    network_of,
)
from disorder_landscape.studies.named_priors import PriorName, named_prior
from disorder_landscape.studies.other_wires import (
    Kind,
    changed,
    true_conductances,
    true_noise,
)
from disorder_landscape.studies.rows import rounded
from disorder_landscape.studies.study import Part, Place, Plan
from disorder_landscape.studies.truth import unknowns_of

MODEL_ALONE = "model"
"""Of a task: all but the disorder and α is taken as known."""
STATED = Nanowire.barrier[0]
"""Both barriers of the measurement that is inverted, in meV."""


@dataclass(frozen=True, order=True)
class Task:
    """One inversion: a shipped model's name, a prior's, the noise in e²/h, the kind, and a wire."""

    model: str
    prior: str
    noise: float
    kind: str
    index: int


class Wires(Part):
    """So many wires of each model, with each thing other than the model has it."""

    models: tuple[ShippedModel, ...]
    prior: PriorName | None = None
    """Name of a file in configs/priors, without its ending, for an inversion without a network."""
    noise: tuple[Noise, ...]
    """In e²/h."""
    other: tuple[Kind, ...]
    """Of `other_wires.KINDS`."""
    count: Positive


class UnmodelledPlan(Plan):
    """Inversions of fresh wires of which one thing is other than the model has it."""

    kind: Literal["unmodelled"]
    samples: Positive
    """Of the answer, which predict the measurements at other barriers."""
    every: Positive
    """Of the points of μ and B, how many those measurements are apart."""
    wires: tuple[Wires, ...]

    keys: ClassVar = ("model", "prior", "noise", "kind", "index")
    common: ClassVar = ("samples", "every")

    def tasks(self) -> Sequence[Task]:
        """Return the tasks, by model, prior, noise, kind and index."""
        return sorted(
            Task(model, group.prior or MODEL_ALONE, noise, kind, index)
            for group in self.wires
            for model in group.models
            for noise in group.noise
            for kind in group.other
            for index in range(group.count)
        )

    def settings(self) -> dict[str, Any]:
        """Return what all rows have in common, and the priors by name."""
        names = {group.prior for group in self.wires if group.prior is not None}
        return {**super().settings(), **{name: named_prior(name).to_dict() for name in names}}

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Invert the measurement of a wire that is not as the model has it."""
        return [unmodelled_row(task, self.samples, self.every)]


def unmodelled_row(task: Task, samples: int, every: int) -> dict[str, object]:
    """Invert the measurement, check the answer, and compare it with the truth.

    Parameters
    ----------
    task : Task
    samples, every : int
        As in `UnmodelledPlan`.

    Returns
    -------
    dict
        As `inversion_row`; besides, `departure`, the root-mean-square change of the conductances in
        units of the noise; `p_predictive`, the p-value of `predictive_p` at OTHER_BARRIERS.
    """
    network = network_of(task.model, task.noise)
    config = network.config.dataset.model_copy(update={"seed": SEED})
    noise, one = noise_of_channels(task.noise), realization(config, task.index)
    settings, unknowns = empty_measurement(config), unknowns_of(config)
    alone = task.prior == MODEL_ALONE
    if not alone:
        unknowns = Unknowns(named_prior(task.prior).for_measurement(settings))
    G = true_conductances(task.kind, task.index, one.wire, settings)
    errors = true_noise(task.kind, task.index, task.noise)
    observation = Observation(measured(settings, G, errors, task.index), unknowns, noise)
    found = inverted(observation, network if alone else None, task.index)
    mean = found.answer.mean
    true, _ = changed(task.kind, task.index, one.wire, settings)
    change = G - simulated(one.wire, settings)
    elsewhere = replace(
        settings, mu=config.mu[::every], B=config.B[::every], barrier=OTHER_BARRIERS
    )
    other = replace(one.wire, barrier=OTHER_BARRIERS)
    other_G = true_conductances(task.kind, task.index, other, elsewhere)
    further = Observation(measured(elsewhere, other_G, errors, task.index, 3), unknowns, noise)
    rng = np.random.default_rng([SEED, task.index, 4])
    predicted = predicted_at(elsewhere, unknowns, found.found.draw(rng, samples))
    return rounded(
        {
            "model": task.model,
            "prior": task.prior,
            "noise": task.noise,
            "kind": task.kind,
            "index": task.index,
            "departure": float(np.sqrt((change**2).mean()) / task.noise),
            "site_error": float(np.sqrt(((unknowns.potential(mean) - true.potential) ** 2).mean())),
            "alpha_error": abs(unknowns.parameter("alpha", mean) - one.alpha),
            "p_predictive": predictive_p(predicted, further.data, further.variance, rng),
            **found.outcome,
        }
    )


def predicted_at(settings: Measurement, unknowns: Unknowns, X: FloatArray) -> FloatArray:
    """Return data that samples X (sample, unknown) predict at the barriers of other settings.

    Barriers that an inversion has found to be higher than stated are so there, by the same factor.
    """
    predicted = []
    for device in unknowns.devices(X, settings):
        found, (left, right) = device.wire.barrier, settings.barrier
        barrier = (left * found[0] / STATED, right * found[1] / STATED)
        wire = replace(device.wire, barrier=barrier)
        predicted.append(simulated(wire, device.as_set_up(settings)).ravel())
    return np.array(predicted)
