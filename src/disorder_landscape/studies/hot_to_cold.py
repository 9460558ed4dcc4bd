"""Kind "hot_to_cold": from hot conductances to the disorder, and from it to the cold ones and T_IV.

Fresh wires of five components are measured at a hot temperature and inverted from the prior alone.
Samples of the posterior then say what the wire shows when it is cold: their mean is the prediction,
their quantiles are its error bars.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, Literal

import numpy as np
import pandas as pd
from pydantic import Field

from disorder_landscape.config import DatasetConfig, Positive
from disorder_landscape.inference.problem.measurement import simulated
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.observables.visibility import topological_visibility
from disorder_landscape.studies.fresh_wires import Noise, inverted, measured_wire
from disorder_landscape.studies.rows import Row, rounded
from disorder_landscape.studies.study import Derived, Part, Place, Plan
from disorder_landscape.studies.temperatures import Temperature
from disorder_landscape.studies.truth import more_probable, site_distance

TARGETS = ("local", "nonlocal", "visibility")
"""What is predicted: G_LL and G_RR, G_LR and G_RL, T_IV of both ends, on the measured grid."""
INTERVAL = 0.9
"""Of the samples' central intervals, whose coverage is given."""


@dataclass(frozen=True, order=True)
class Task:
    """One inversion: the temperature in K, the noise in e²/h, the index of a fresh wire."""

    temperature: float
    noise: float
    index: int


class HotWires(Part):
    """So many wires, measured at each temperature with each noise."""

    temperatures: tuple[Temperature, ...]
    noise: tuple[Annotated[Noise, Field(gt=0)], ...]
    """In e²/h."""
    count: Positive


class HotToColdPlan(Plan):
    """Hot wires, and the temperature at which they are predicted."""

    kind: Literal["hot_to_cold"]
    cold: Temperature
    hot: tuple[HotWires, ...]
    points: Positive = 15
    """Of μ, and of B."""
    samples: Positive = 64
    """Of each posterior."""

    keys: ClassVar = ("temperature", "noise", "index")
    common: ClassVar = ("cold", "points", "samples")

    def tasks(self) -> Sequence[Task]:
        """Return the tasks, by temperature, noise and index."""
        return sorted(
            Task(temperature, noise, index)
            for group in self.hot
            for temperature in group.temperatures
            for noise in group.noise
            for index in range(group.count)
        )

    def config(self, temperature: float) -> DatasetConfig:
        """Return the wires and their grid."""
        return DatasetConfig(
            realizations=max(group.count for group in self.hot),
            mu_points=self.points,
            B_points=self.points,
            temperature=temperature,
        )

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Invert hot data of a wire and predict it when it is cold.

        Returns
        -------
        list of dict
            `site_error` of V in meV and `more_probable`, as in `inversion_row`; of each of TARGETS
            the mean and the mean square of the truth, the mean square of the prediction's error,
            and the share of the truths in the INTERVAL; the outcome of `Inverted`.
        """
        config = self.config(task.temperature)
        observation, truth = measured_wire(config, task.noise, task.index)
        found = inverted(observation, None, task.index)
        mean = found.answer.mean
        row: dict[str, object] = {
            "temperature": task.temperature,
            "noise": task.noise,
            "index": task.index,
            "site_error": site_distance(observation.unknowns, mean, truth),
            "more_probable": more_probable(observation, found.found, truth),
        }
        X = found.found.draw(np.random.default_rng([task.index, 5]), self.samples)
        predicted = cold_wires(observation, X, self.cold)
        true = cold_wires(observation, truth[None], self.cold)
        for name in TARGETS:
            row |= compared(name, predicted[name], true[name][0])
        return [rounded(row | found.outcome)]

    def derived(self, rows: Sequence[Row], place: Place) -> Derived:
        """Return R² of the predictions, and coverage, at each temperature and noise."""
        table = pd.DataFrame(rows)
        table = table.assign(
            **{name: pd.to_numeric(table[name]) for name in table if name != "verdict"}
        )
        groups = table.groupby(["temperature", "noise"])
        return Derived({f"{1e3 * T:g} mK, {noise:g}": summary(some) for (T, noise), some in groups})


def cold_wires(
    observation: Observation, X: FloatArray, temperature: float
) -> dict[str, FloatArray]:
    """Return what wires X (sample, unknown) show at a temperature, of each of TARGETS.

    The first axis is that of the samples.
    """
    settings = observation.measurement
    wires = [device.wire for device in observation.unknowns.devices(X, settings)]
    G = simulated(wires, replace(settings, temperature=temperature))
    T_IV = topological_visibility(wires, settings.mu, settings.B).to_numpy()
    return {"local": G[..., :2], "nonlocal": G[..., 2:], "visibility": T_IV}


def compared(name: str, predicted: FloatArray, true: FloatArray) -> dict[str, object]:
    """Return what R² and coverage are made of, predicted (sample, …) and true (…)."""
    low, high = np.quantile(predicted, [(1 - INTERVAL) / 2, (1 + INTERVAL) / 2], axis=0)
    return {
        f"{name}_mean": true.mean(),
        f"{name}_square": (true**2).mean(),
        f"{name}_error": ((predicted.mean(axis=0) - true) ** 2).mean(),
        f"{name}_covered": ((low <= true) & (true <= high)).mean(),
    }


def summary(table: pd.DataFrame) -> dict[str, object]:
    """Return what the rows of one temperature and noise come to; errors of V in µeV."""
    found: dict[str, object] = {
        "wires": len(table),
        "error": round(1e3 * float(table["site_error"].median()), 3),
        "spread": round(1e3 * float(table["spread"].median()), 3),
        "verdicts": table["verdict"].value_counts().to_dict(),
    }
    for name in TARGETS:
        variance = table[f"{name}_square"].mean() - table[f"{name}_mean"].mean() ** 2
        found[f"r2_{name}"] = round(1 - float(table[f"{name}_error"].mean() / variance), 5)
        found[f"covered_{name}"] = round(float(table[f"{name}_covered"].mean()), 3)
    return found
