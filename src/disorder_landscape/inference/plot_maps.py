"""Maps of a result: conductances measured and explained, T_IV, P(topological) and the gap."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.problem.observation import errors_variance
from disorder_landscape.inference.report import SURE
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.model.quantities import CONDUCTANCES

RESIDUAL = {"cmap": "RdBu_r", "vmin": -4, "vmax": 4}
"""How residuals are shown, in standard deviations of all errors, the simulation's included."""
APART = np.array([-0.25, 0.25])
"""Where the pixels of a map are that has one value of µ or B alone."""
AXIS = {"mu": r"$\mu$ [meV]"}
"""How the measured axis is named on a map; others have their own name."""


class Shown(NamedTuple):
    """A map: its values on a grid of the measured axis and B, its words, and how it is drawn."""

    grid: tuple[FloatArray, FloatArray]
    values: Any
    title: str
    unit: str
    options: Mapping[str, Any]


def draw_conductances(
    figure: Any, panels: Mapping[str, Any], result: xr.Dataset, measurement: Measurement
) -> None:
    """Show the first channel that was measured, at the bias next to zero."""
    there, bias = np.isfinite(measurement.G).any(axis=(0, 1, 2)), measurement.bias
    channel = int(there.argmax())
    bias_there = np.isfinite(measurement.G[..., channel]).any(axis=(0, 1))
    name, at = CONDUCTANCES[channel], int(np.where(bias_there, abs(bias), np.inf).argmin())
    G = np.ma.masked_invalid(measurement.G[:, :, at, channel])
    answer = result[name].to_numpy()[:, :, at]
    largest = max(abs(G).max(), abs(answer).max())
    local = name in ("G_LL", "G_RR")
    norm = {"vmin": 0 if local else -largest, "vmax": largest}
    norm["cmap"] = "viridis" if local else "RdBu_r"
    std = np.sqrt(errors_variance(result.attrs["noise"][channel]))
    grid = measurement.mu, measurement.B
    channel_name = rf"$G_\mathrm{{{name[2:]}}}$ at {bias[at]:g} meV"
    off, all_errors = (G - answer) / std, r"$\sigma$ of all errors"
    shown = {
        "measured": Shown(grid, G, f"{channel_name}, measured", "$e^2/h$", norm),
        "explained": Shown(grid, answer, "explained", "$e^2/h$", norm),
        "residual": Shown(grid, off, "measured minus explained", all_errors, RESIDUAL),
    }
    _row_of_maps(figure, panels, shown, measurement.axis)


def draw_maps(
    figure: Any, panels: Mapping[str, Any], result: xr.Dataset, measurement: Measurement
) -> None:
    """Show T_IV, P(topological) with the points of the data, and the gap that is sure."""
    fine = result[f"map_{measurement.axis}"].to_numpy(), result["map_B"].to_numpy()
    data, gap = (measurement.mu, measurement.B), 1e3 * sure_gap(result)
    most = gap.max() or 1e3 * float(result["gap"].max())
    in_T, in_P = {"cmap": "RdBu", "vmin": -1, "vmax": 1}, {"cmap": "Purples", "vmin": 0, "vmax": 1}
    in_gap = {"cmap": "cividis", "vmin": 0, "vmax": most}
    P, exceed = result["P_topological"], f"gap that {100 * SURE:.0f} % exceed"
    shown = {
        "T": Shown(fine, result["T_IV"][0], r"$T_\mathrm{IV}$ of the mean", "", in_T),
        "P": Shown(fine, P, "$P$(topological); dots: data", "", in_P),
        "gap": Shown(data, gap, exceed, "µeV", in_gap),
    }
    _row_of_maps(figure, panels, shown, measurement.axis)
    at_B, at_mu = np.meshgrid(measurement.B, measurement.mu)
    panels["P"].plot(at_B.ravel(), at_mu.ravel(), ".", color="0.4", ms=0.6)


def _row_of_maps(
    figure: Any, panels: Mapping[str, Any], shown: Mapping[str, Shown], axis: str
) -> None:
    """Draw maps side by side, with the measured axis named on the left."""
    for column, (kind, one) in enumerate(shown.items()):
        panel = panels[kind]
        image = _map(panel, *one.grid, one.values, **one.options)
        panel.set_title(one.title)
        panel.set_ylabel("" if column else AXIS.get(axis, axis))
        figure.colorbar(image, ax=panel, label=one.unit, location="bottom", aspect=20)


def sure_gap(result: xr.Dataset) -> FloatArray:
    """Return the energy in meV that the gap exceeds in SURE of the samples, shape (mu, B)."""
    surely = (result["P_gap"] >= SURE).sum("gap").to_numpy()
    energies = np.concatenate([[0.0], result["gap"].to_numpy()])
    return np.asarray(energies[surely])


def _map(panel: Any, mu: FloatArray, B: FloatArray, values: Any, **options: Any) -> Any:
    panel.set_xlabel("$B$ [T]")
    if mu.size == 1:  # as wide as the panel
        panel.set_yticks(mu)
        mu, values = mu + APART, np.ma.repeat(values, 2, axis=0)
    if B.size == 1:
        panel.set_xticks(B)
        B, values = B + APART, np.ma.repeat(values, 2, axis=1)
    return panel.pcolormesh(B, mu, values, shading="nearest", rasterized=True, **options)
