"""Kind "starts": the same measurement inverted from the network's guess, and from the prior alone.

If a conductance profile has one disorder landscape, both end in the same answer, whatever network
there is. If the noise leaves several, both find them, with the same weights and the same evidence.
Seeds differ: each start has attempts of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Literal

import numpy as np
import pandas as pd

from disorder_landscape.inference.optimum import same_answer
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.posterior.samples import posterior_shares
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.verdict import CONVERGED
from disorder_landscape.studies.fresh_wires import (
    FreshWiresPlan,
    Task,
    fresh_wire,
    inverted,
    log_evidence,
    network_of,
)
from disorder_landscape.studies.rows import Row, numbers, rounded
from disorder_landscape.studies.study import Derived, Place
from disorder_landscape.studies.truth import site_distance

STARTS = ("network", "prior")
OTHER_SEEDS = 2**20
"""Added to the seed of an inversion from the prior alone."""


class StartsPlan(FreshWiresPlan):
    """Inversions of fresh wires from two starts."""

    kind: Literal["starts"]

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Invert the measurement of a fresh wire from both starts.

        Returns
        -------
        list of dict
            `apart`, the root-mean-square difference of both potentials in meV, and `weights_apart`;
            of each start, how far its answer is off, `network_error` and `prior_error`, its log
            evidence, `network_log_evidence` and so on, and the outcome of `Inverted`, as
            `network_spread`.
        """
        observation, truth = fresh_wire(task)
        distance = partial(site_distance, observation.unknowns)
        from_network = inverted(observation, network_of(task.model, task.noise), task.index)
        found = from_network, inverted(observation, None, OTHER_SEEDS + task.index)
        row: dict[str, object] = {"model": task.model, "noise": task.noise, "index": task.index}
        row["apart"] = distance(found[0].answer.mean, found[1].answer.mean)
        row["weights_apart"] = weights_apart(observation, *(one.found for one in found))
        for start, one in zip(STARTS, found, strict=True):
            row[f"{start}_error"] = distance(one.answer.mean, truth)
            rng = np.random.default_rng([task.index, 6])
            row[f"{start}_log_evidence"] = log_evidence(observation, one.found, rng)
            row |= {f"{start}_{name}": value for name, value in one.outcome.items()}
        return [rounded(row)]

    def derived(self, rows: Sequence[Row], place: Place) -> Derived:
        """Return how far the answers of both starts are from each other."""
        table = pd.DataFrame(rows)
        named = table.columns.str.endswith(("verdict", "model"))
        table = table.assign(**{name: numbers(rows, name) for name in table.columns[~named]})
        groups = table.groupby(["model", "noise"], sort=False)
        return Derived({f"{model}, {noise:g}": summary(some) for (model, noise), some in groups})


def weights_apart(observation: Observation, one: Outcome, other: Outcome) -> float:
    """Return how much of the posterior two searches put at different optima, from 0 to 1."""
    apart, *more = (
        posterior_shares(observation, found.optima, found.importance_samples)
        for found in (one, other)
    )
    alone = 0.0
    for optimum, share in zip(other.optima, *more, strict=True):
        same = [k for k, known in enumerate(one.optima) if same_answer(observation, known, optimum)]
        if same:
            apart[same[0]] -= share
        else:
            alone += share
    return float((abs(apart).sum() + alone) / 2)


def summary(table: pd.DataFrame) -> dict[str, object]:
    """Return what the rows of one model and noise come to.

    How far the answers of both starts are from each other, in their error bars; the difference of
    their log evidence, and of the weights of optima: the median and the most.
    """
    bars = table[[f"{start}_spread" for start in STARTS]].mean(axis=1)
    apart = table["network_log_evidence"] - table["prior_log_evidence"]
    both = table[[f"{start}_verdict" for start in STARTS]].eq(CONVERGED).all(axis=1)
    differences = {
        "apart_in_bars": table["apart"] / bars,
        "log_evidence_apart": abs(apart),
        "weights_apart": table["weights_apart"],
    }
    found: dict[str, object] = {"wires": len(table), "both_converged": int(both.sum())}
    for name, values in differences.items():
        found[name] = round(float(values.median()), 3)
        found[f"{name}_at_most"] = round(float(values.max()), 3)
    return found
