"""Kind "verification": whether measurements that the network never saw tell right from wrong.

Each of the shipped 5+1 network's test wires is measured at settings between and beyond those of the
training: other μ, B and biases with both barriers changed, and with the field at an angle θ to the
wire. `verify` then compares its prediction, and wires with wrong disorder, with these measurements.
A prediction is told apart if it fits better than each of those.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Annotated, ClassVar, Literal

import numpy as np
import xarray as xr
from pydantic import Field

from disorder_landscape.chain import read_test_set
from disorder_landscape.config import DatasetConfig, Positive
from disorder_landscape.inference.defaults import OTHER_ANGLE, OTHER_BARRIERS, shifts
from disorder_landscape.inference.verify import verify
from disorder_landscape.learning.prediction import predict
from disorder_landscape.observables.conductance import conductance
from disorder_landscape.runs import FIVE, SHIPPED, preset_run
from disorder_landscape.studies.rows import Row, numbers
from disorder_landscape.studies.study import Derived, Place, Plan

MU = np.array([0.13, 0.4])
"""In meV, between the points of the network's grid."""
B = np.array([0.33, 0.5, 0.69])
"""In T."""
BIAS = np.array([-0.03, 0.01])
"""In meV."""


@dataclass(frozen=True)
class Task:
    """A test wire."""

    index: int


class VerificationPlan(Plan):
    """Verifications of the shipped predictions."""

    kind: Literal["verification"]
    wires: Positive
    controls: Annotated[int, Field(ge=19)]
    """Wires with wrong disorder, for each."""
    shifts: Positive
    """Of V that are tried."""

    keys: ClassVar = ("index",)
    common: ClassVar = ("controls", "shifts")

    def tasks(self) -> Sequence[Task]:
        """Return the first test wires."""
        return [Task(index) for index in range(self.wires)]

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Measure one test wire, and verify its prediction.

        Returns
        -------
        list of dict
            The `score` of the prediction, and of the best of those with wrong disorder.
        """
        tests, predictions, config = _predicted()
        test = tests.isel(realization=task.index)
        wire = config.wire.with_disorder(test["potential"].to_numpy(), float(test["alpha"]))
        measurements = [
            conductance(replace(wire, barrier=OTHER_BARRIERS), MU, B, BIAS, config.temperature),
            conductance(wire, MU[:1], B[1:], BIAS, config.temperature, theta=OTHER_ANGLE),
        ]
        result = verify(
            predictions.isel(realization=task.index),
            measurements,
            controls=self.controls,
            config=config,
            shifts=shifts(self.shifts),
        )
        score, best_wrong = float(result["score"]), float(result["control_score"].min())
        return [{"index": task.index, "score": score, "best_wrong": best_wrong}]

    def derived(self, rows: Sequence[Row], place: Place) -> Derived:
        """Return the share of wires that are told apart."""
        score, best_wrong = numbers(rows, "score"), numbers(rows, "best_wrong")
        share = float(np.mean(score < best_wrong))
        return Derived(
            {
                "share_told_apart": share,
                "wires": len(rows),
                "controls": self.controls,
                "median_score": float(np.median(score)),
            },
            lines=[
                f"{share:.1%} of {len(rows)} predictions fit better than each of {self.controls} "
                "wrong wires"
            ],
        )


@lru_cache
def _predicted() -> tuple[xr.Dataset, xr.Dataset, DatasetConfig]:
    """Return the test wires and their predictions, once in each process."""
    run = preset_run(SHIPPED, model=FIVE)
    test = read_test_set(run)
    return test, predict(run.model_folder, test), run.config.dataset
