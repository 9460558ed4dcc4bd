"""Kind "accuracy": thermal averages against the integral done by brute force.

Random wires (pristine, of 5, 10 and 30 components, weak and strong, of uncorrelated noise), each at
a random μ, B, temperature and five biases. What `conductance` and `generate` compute is compared
with ∫ dω G₀(ω) (−f'(ω − V)) by adaptive quadrature (`solver.quadrature`), which assumes nothing
about G₀; that this has converged is shown by a finer run of some of the wires.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from disorder_landscape.config import Positive
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.studies.accuracy_cases import BIASES, Region, measure, random_case
from disorder_landscape.studies.fingerprint import fingerprint
from disorder_landscape.studies.rows import Row, numbers
from disorder_landscape.studies.study import Derived, Place, Plan

CHANNELS = 4


@dataclass(frozen=True)
class Task:
    """A random wire."""

    index: int


class AccuracyPlan(Plan):
    """Random wires whose averages are done by brute force too."""

    kind: Literal["accuracy"]
    wires: Positive
    finer_every: Positive
    """Every so many wires is integrated more finely too."""
    seed: Annotated[int, Field(ge=0)]
    region: Region = "cold"

    keys: ClassVar = ("index",)

    def tasks(self) -> Sequence[Task]:
        """Return the wires."""
        return [Task(index) for index in range(self.wires)]

    def folder(self, place: Place) -> Path:
        """Return a folder of these very solvers and cases."""
        settings = self.model_dump_json(include={"finer_every", "seed", "region"})
        return place.build / "studies" / fingerprint("accuracy_cases", settings=settings)

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Measure a wire; errors of all biases and channels stand in one cell."""
        case = random_case(self.seed, task.index, region=self.region)
        found = measure(case, finer=task.index % self.finer_every == 0)
        error = " ".join(repr(float(value)) for value in found["error"].ravel())
        return [{"index": task.index, **found, "error": error}]

    def derived(self, rows: Sequence[Row], place: Place) -> Derived:
        """Return whether the bounds hold, and the numbers, report and picture of the errors."""
        from disorder_landscape.studies.accuracy_report import report, save, summary

        measured = errors_of(rows)
        found = summary(measured)
        text = report(found)
        return Derived(found, text, partial(save, measured), text.splitlines(), found["passed"])


def errors_of(rows: Sequence[Row]) -> dict[str, FloatArray]:
    """Return the arrays of `measure`, with a leading dim wire."""
    names = [name for name in rows[0] if name not in ("index", "error")]
    error = np.array([row["error"].split() for row in rows], dtype=float)
    return {
        **{name: numbers(rows, name) for name in names},
        "error": error.reshape(len(rows), BIASES, CHANNELS),
    }
