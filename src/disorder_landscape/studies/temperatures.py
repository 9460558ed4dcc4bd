"""Kind "temperatures": what hot conductances still tell of the cold ones and of T_IV.

For random wires of five components on the paper's grid, conductances at a hot temperature are
known. Those at each (μ, B) and at the eight points around it, with μ and B, are given to a
regression by boosted trees, which learns from half of the wires. Its R² on the other half says how
much of the cold conductances and of T_IV is still in a small piece of a hot map. A network that
sees whole maps can do better.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from pydantic import Field

from disorder_landscape.config import DatasetConfig, Positive
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.observables.conductance import conductance
from disorder_landscape.observables.visibility import topological_visibility
from disorder_landscape.pictures import write_picture
from disorder_landscape.runs import REPOSITORY
from disorder_landscape.studies.rows import Row, numbers
from disorder_landscape.studies.study import Derived, Place, Plan

TARGETS = ("local", "nonlocal", "visibility")
"""Of which R² is given: G_LL at zero bias, G_LR at the largest, and T_IV of the left end."""
LIMIT = 1.0
"""Largest |G| in e²/h that is drawn."""

Temperature = Annotated[float, Field(gt=0, le=1)]


@dataclass(frozen=True)
class Task:
    """A temperature in K."""

    temperature: float


class TemperaturesPlan(Plan):
    """Hot temperatures, and the cold one whose conductances are to be told."""

    kind: Literal["temperatures"]
    cold: Temperature
    hot: tuple[Temperature, ...]
    wires: Annotated[int, Field(ge=2)]
    seed: Annotated[int, Field(ge=0)]
    points: Positive = 15
    """Of μ, and of B."""

    keys: ClassVar = ("temperature",)
    common: ClassVar = ("cold", "wires", "seed", "points")

    def tasks(self) -> Sequence[Task]:
        """Return the hot temperatures."""
        return [Task(temperature) for temperature in self.hot]

    def config(self, temperature: float) -> DatasetConfig:
        """Return the wires and their grid."""
        return DatasetConfig(
            realizations=self.wires,
            mu_points=self.points,
            B_points=self.points,
            temperature=temperature,
            seed=self.seed,
        )

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Return R² of what is told of the cold maps, and how much weaker and how like they are."""
        cold, hot = (_maps(self.config(T)) for T in (self.cold, task.temperature))
        learned = _told(self, hot, cold)
        row: dict[str, object] = {"temperature": task.temperature}
        for name, channel in (("local", 0), ("nonlocal", 2)):
            a, b = hot[..., channel].ravel(), cold[..., channel].ravel()
            row[f"r2_{name}"] = round(learned[name], 4)
            row[f"correlation_{name}"] = round(float(np.corrcoef(a, b)[0, 1]), 4)
            row[f"strength_{name}"] = round(float(a.std() / b.std()), 4)
        return [row | {"r2_visibility": round(learned["visibility"], 4)}]

    def derived(self, rows: Sequence[Row], place: Place) -> Derived:
        """Return the picture."""
        return Derived(draw=partial(_save, self, list(rows)))


@cache
def _maps(config: DatasetConfig) -> FloatArray:
    """Return conductances, shape (wire, mu, B, bias, 4), in e²/h."""
    wires = [realization(config, i).wire for i in range(config.realizations)]
    each = [conductance(w, config.mu, config.B, config.bias, config.temperature) for w in wires]
    return np.array(
        [np.stack([G[name].to_numpy() for name in CONDUCTANCES], axis=-1) for G in each]
    )


def _told(plan: TemperaturesPlan, hot: FloatArray, cold: FloatArray) -> dict[str, float]:
    """Return R² of each target on the second half of the wires, learned from the first."""
    from sklearn.ensemble import HistGradientBoostingRegressor
    from sklearn.metrics import r2_score

    config = plan.config(plan.cold)
    wires = [realization(config, i).wire for i in range(plan.wires)]
    T_IV = np.array([topological_visibility(w, config.mu, config.B).to_numpy()[0] for w in wires])
    seen, half = _around(config, hot), plan.wires // 2
    middle = len(config.bias) // 2
    targets = {"local": cold[..., middle, 0], "nonlocal": cold[..., -1, 2], "visibility": T_IV}
    found = {}
    for name, values in targets.items():
        trees = HistGradientBoostingRegressor(max_iter=300, random_state=0)
        trees.fit(seen[:half].reshape(-1, seen.shape[-1]), values[:half].ravel())
        said = trees.predict(seen[half:].reshape(-1, seen.shape[-1]))
        found[name] = float(r2_score(values[half:].ravel(), said))
    return found


def _around(config: DatasetConfig, maps: FloatArray) -> FloatArray:
    """Return μ, B and the maps at each point and around it, (wire, mu, B, feature)."""
    wires, mu, B = maps.shape[:3]
    flat = np.pad(maps.reshape(wires, mu, B, -1), [(0, 0), (1, 1), (1, 1), (0, 0)], mode="edge")
    windows = sliding_window_view(flat, (3, 3), axis=(1, 2)).reshape(wires, mu, B, -1)
    at = np.stack(np.meshgrid(config.mu, config.B, indexing="ij"), axis=-1)
    return np.concatenate([windows, np.broadcast_to(at, (wires, *at.shape))], axis=-1)


def _save(plan: TemperaturesPlan, rows: list[Row], path: Path) -> None:
    from matplotlib import style

    with style.context(REPOSITORY / "paper_figures" / "style.mplstyle"):
        write_picture(path, _draw(plan, rows), dpi=200)


def _draw(plan: TemperaturesPlan, rows: list[Row]) -> Any:
    """Draw (a) to (c) G_LL of a wire, cold to hot, and (d) what is told by hot conductances."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.06, 2.2), layout="constrained")
    *maps, last = figure.subplots(1, 4, width_ratios=[1, 1, 1, 1.4])
    shown = (plan.cold, plan.hot[len(plan.hot) // 2 - 1], plan.hot[-1])
    wire = realization(plan.config(plan.cold), 0).wire
    mu, B = np.linspace(0, 0.6, 61), np.linspace(0, 0.8, 81)
    for axes, temperature, letter in zip(maps, shown, "abc", strict=True):
        G = conductance(wire, mu, B, 0.0, temperature)["G_LL"].to_numpy()[..., 0]
        image = axes.pcolormesh(mu, B, G.T, vmin=0, vmax=LIMIT, cmap="viridis", rasterized=True)
        axes.set(xlabel="µ (meV)", title=f"({letter}) {1e3 * temperature:g} mK")
        axes.tick_params(labelleft=letter == "a")
    maps[0].set_ylabel("B (T)")
    figure.colorbar(image, ax=maps, label="$G_{LL}$ at 0 meV (e²/h)", extend="max")
    T = 1e3 * numbers(rows, "temperature")
    labels = dict(zip(TARGETS, ("$G_{LL}$", "$G_{LR}$", "$T_{IV}$"), strict=True))
    for name, marker in zip(TARGETS, "osv", strict=True):
        last.plot(T, numbers(rows, f"r2_{name}"), marker=marker, label=labels[name])
    last.set(xlabel="T (mK)", ylabel="R² of what is told", title="(d)", ylim=(0, 1), xlim=(0, None))
    last.legend()
    return figure
