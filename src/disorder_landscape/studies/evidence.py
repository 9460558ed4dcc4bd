"""Kind "evidence": which of several priors describes a measurement, by their evidence.

Devices are drawn from each of the priors of a group, measured, and inverted with all of them. The
one with the largest log evidence should be that from which the device is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
import pandas as pd
from pydantic import Field

from disorder_landscape.config import Positive
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.studies.drawn_devices import Grid, drawn_device, measured_device, seed_of
from disorder_landscape.studies.fresh_wires import Noise, inverted, log_evidence
from disorder_landscape.studies.rows import Row, numbers, rounded
from disorder_landscape.studies.study import Derived, Place, Plan, by_name

DECISIVE = 5.0
"""A difference of log evidence by which one prior is 150 times as probable as the other (Kass and
Raftery, J. Am. Stat. Assoc. 90, 773 (1995): very strong)."""


@dataclass(frozen=True, order=True)
class Task:
    """One device: the group, the name of its own prior, and its index."""

    group: str
    truth: str
    index: int


class Group(Grid):
    """Priors to be told apart, and how devices of each are measured."""

    name: str
    priors: Annotated[dict[str, dict[str, Any]], Field(min_length=2)]
    """Tables as in configs/priors, by name."""
    noise: Annotated[Noise, Field(gt=0)]
    """In e²/h."""
    count: Positive
    """Devices of each prior."""

    def unknowns(self, name: str) -> Unknowns:
        """Return what is unknown by a prior."""
        return Unknowns(Prior.from_mapping(self.priors[name]).for_measurement(self.grid))


class EvidencePlan(Plan):
    """Comparisons of priors."""

    kind: Literal["evidence"]
    groups: tuple[Group, ...]

    keys: ClassVar = ("group", "truth", "index")

    def tasks(self) -> Sequence[Task]:
        """Return the devices, by group, prior and index."""
        return [
            Task(group.name, truth, index)
            for group in self.groups
            for truth in group.priors
            for index in range(group.count)
        ]

    def settings(self) -> dict[str, Any]:
        """Return the priors, and where devices are measured with which noise, by group."""
        return {
            group.name: {"priors": group.priors, "noise": group.noise, **group.points}
            for group in self.groups
        }

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Draw a device, measure it, and invert the measurement with each prior."""
        return rows_of(task, by_name(self.groups, task.group))

    def derived(self, rows: Sequence[Row], place: Place) -> Derived:
        """Return how often, and by how much, the prior of the device has the larger evidence."""
        table = pd.DataFrame(rows).assign(log_evidence=numbers(rows, "log_evidence"))
        groups = table.groupby(["group", "truth"], sort=False)
        return Derived({f"{group}, {truth}": summary(some) for (group, truth), some in groups})


def rows_of(task: Task, group: Group) -> list[dict[str, object]]:
    """Return the evidence of each prior for one device.

    Returns
    -------
    list of dict
        For each `prior` the `log_evidence`, the `excess` of χ², the `verdict`, and `seconds`.
    """
    seed = seed_of(f"{task.group}, {task.truth}", task.index)
    own = group.unknowns(task.truth)
    device, _ = drawn_device(own, group.grid, seed)
    measured = measured_device(device, own, group.grid, group.noise, seed)
    rows: list[dict[str, object]] = []
    for name in group.priors:
        observation = replace(measured, unknowns=group.unknowns(name))
        answer = inverted(observation, None, task.index)
        rng = np.random.default_rng([*seed, 2])
        outcome: dict[str, object] = {
            "group": task.group,
            "truth": task.truth,
            "index": task.index,
            "prior": name,
            "log_evidence": log_evidence(observation, answer.found, rng),
            **{key: answer.outcome[key] for key in ("excess", "verdict", "seconds")},
        }
        rows.append(rounded(outcome))
    return rows


def summary(table: pd.DataFrame) -> dict[str, object]:
    """Return what the rows of the devices of one prior come to.

    By how much the log evidence of their own prior is above the largest of the others: the median
    and the least; how many devices have it above, by how many decisively, and how many decisively
    below.
    """
    by_prior = table.pivot(index="index", columns="prior", values="log_evidence")
    own = table["truth"].iloc[0]
    above = by_prior[own] - by_prior.drop(columns=own).max(axis=1)
    return {
        "devices": len(above),
        "median": round(float(above.median()), 1),
        "least": round(float(above.min()), 1),
        "right": int((above > 0).sum()),
        "decisively": int((above > DECISIVE).sum()),
        "decisively_wrong": int((above < -DECISIVE).sum()),
    }
