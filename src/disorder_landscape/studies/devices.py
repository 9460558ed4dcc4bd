"""Kind "devices": inversions of devices that are drawn from a prior, whatever it leaves unknown.

Each row draws a device, measures it and inverts the measurement. Conductances are averaged by
quadrature, which is another route than the inversion's own, and have errors. Devices, errors and
answers are functions of (name, noise, index) alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
import pandas as pd
from pydantic import Field

from disorder_landscape.config import Positive
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.studies.calibration import coverage, joint_coverage
from disorder_landscape.studies.drawn_devices import Grid, drawn_device, measured_device, seed_of
from disorder_landscape.studies.fresh_wires import Noise, inverted
from disorder_landscape.studies.named_priors import PriorName, named_prior
from disorder_landscape.studies.rows import Row, rounded
from disorder_landscape.studies.study import Derived, Place, Plan, by_name
from disorder_landscape.studies.truth import more_probable, shape_std, z_scores

NUMBERS = (
    *("noise", "site_error", "spread", "shape_error", "shape_spread", "more_probable"),
    *("effective_sample_size", "excess", "seconds"),
)
"""Columns of the table."""


@dataclass(frozen=True, order=True)
class Task:
    """One inversion: the name of a group of devices, the noise in e²/h, the index of a device."""

    name: str
    noise: float
    index: int


class Devices(Grid):
    """So many devices of a prior, measured on a grid with each noise."""

    name: str
    prior: PriorName
    """Name of a file in configs/priors, without its ending."""
    noise: tuple[Annotated[Noise, Field(gt=0)], ...]
    """In e²/h."""
    count: Positive

    @cached_property
    def unknowns(self) -> Unknowns:
        """What is unknown of the devices."""
        return Unknowns(named_prior(self.prior).for_measurement(self.grid))


class DevicesPlan(Plan):
    """Inversions of devices of some priors."""

    kind: Literal["devices"]
    devices: tuple[Devices, ...]

    keys: ClassVar = ("name", "noise", "index")

    def tasks(self) -> Sequence[Task]:
        """Return the tasks, by name, noise and index."""
        return sorted(
            Task(group.name, noise, index)
            for group in self.devices
            for noise in group.noise
            for index in range(group.count)
        )

    def settings(self) -> dict[str, Any]:
        """Return the priors of the devices, and where they are measured, by group."""
        return {
            group.name: {"prior": named_prior(group.prior).to_dict(), **group.points}
            for group in self.devices
        }

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Draw a device, measure it, invert the measurement."""
        return [device_row(task, by_name(self.devices, task.name))]

    def derived(self, rows: Sequence[Row], place: Place) -> Derived:
        """Return coverage and errors, and how much of each parameter's uncertainty is left."""
        table = pd.DataFrame(rows)
        table = table.assign(**{name: pd.to_numeric(table[name]) for name in NUMBERS})
        numbers = {}
        for (name, noise), some in table.groupby(["name", "noise"]):
            unknowns = by_name(self.devices, name).unknowns
            numbers[f"{name}, {noise:g}"] = summary(some, unknowns)
        return Derived(numbers)


def device_row(task: Task, group: Devices) -> dict[str, object]:
    """Invert the measurement of a device and compare the answer with the truth.

    Returns
    -------
    dict
        `site_error` of V in meV, root mean square over the sites, and its error bar `spread`; the
        same of V less its mean, `shape_error` and `shape_spread`; `more_probable`, how much of
        the posterior is more probable than the truth; the outcome of `Inverted`; and, as text, for
        each unknown `z_scores` of the truth (`truth.z_scores`), and `widths`, the standard
        deviation as a share of the prior's.
    """
    unknowns, seed = group.unknowns, seed_of(task.name, task.index)
    device, truth = drawn_device(unknowns, group.grid, seed)
    observation = measured_device(device, unknowns, group.grid, task.noise, seed)
    found = inverted(observation, None, task.index)
    mean, covariance = found.answer.mean, found.answer.covariance
    off = unknowns.potential(mean) - device.wire.potential
    std = np.sqrt(np.diag(covariance))
    row: dict[str, object] = {
        "name": task.name,
        "noise": task.noise,
        "index": task.index,
        "site_error": np.sqrt((off**2).mean()),
        "spread": found.outcome["spread"],
        "shape_error": off.std(),
        "shape_spread": shape_std(unknowns, covariance),
        "more_probable": more_probable(observation, found.found, truth),
    }
    return {
        **rounded(row | found.outcome),
        "z_scores": " ".join(f"{z:.3f}" for z in z_scores(found.found, truth)),
        "widths": " ".join(f"{width:.3g}" for width in std),
    }


def summary(table: pd.DataFrame, unknowns: Unknowns) -> dict[str, object]:
    """Return what the rows of one group and noise come to.

    Errors in µeV; coverage in percent of the intervals of COVERAGE, of each unknown and of all at
    once; of each parameter the median width of the posterior as a share of the prior's.
    """
    widths = np.array([text.split() for text in table["widths"]], dtype=float)
    names = list(unknowns.names)[unknowns.of_disorder :]
    return {
        "devices": len(table),
        "error": round(1e3 * table["site_error"].median(), 3),
        "error_90": round(1e3 * table["site_error"].quantile(0.9), 3),
        "spread": round(1e3 * table["spread"].median(), 3),
        "shape_error": round(1e3 * table["shape_error"].median(), 3),
        "verdicts": table["verdict"].value_counts().to_dict(),
        "coverage": [round(100 * float(part), 1) for part in coverage(table)],
        "joint_coverage": [round(100 * float(part), 1) for part in joint_coverage(table)],
        "seconds": round(table["seconds"].median()),
        "widths": {
            name: float(f"{np.median(widths[:, unknowns.of_disorder + k]):.3g}")
            for k, name in enumerate(names)
        },
    }
