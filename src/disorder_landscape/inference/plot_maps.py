"""Maps of a result: conductances measured and explained, T_IV, P(topological) and the gap."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.problem.noise import errors_variance
from disorder_landscape.inference.report import SURE, has_dissipation
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.symbols import (
    NONLOCAL_COLOURS,
    T_IV_COLOURS,
    T_IV_SYMBOL,
    TOPOLOGICAL_COLOURS,
    axis_label,
    axis_value,
    colour_scale,
    symbol,
)

RESIDUAL = {"cmap": NONLOCAL_COLOURS, "vmin": -4, "vmax": 4}
"""How residuals are shown, in standard deviations of all errors, the simulation's included."""
NOT_MEASURED = "0.8"
"""Colour of what was not measured."""
BELOW = -0.03
"""Where the data's points are beside a curve of P(topological)."""


class Shown(NamedTuple):
    """A map: its axes by name, the upward one first, its values, its words, and how it is drawn."""

    grid: Mapping[str, FloatArray]
    values: Any
    title: str
    unit: str
    options: Mapping[str, Any]


def measured_channels(measurement: Measurement) -> list[int]:
    """Return which of the channels were measured."""
    return np.flatnonzero(measurement.has_channel).tolist()


def draw_conductances(
    figure: Any, panels: Mapping[str, Any], result: xr.Dataset, measurement: Measurement
) -> None:
    """Show the first channel that was measured, and what is not explained of each other one.

    At the bias next to zero; over B and bias where there is one µ only, and over µ and bias where
    there is one B.
    """
    first, *others = measured_channels(measurement)
    _row_of_maps(figure, panels, _compared(result, measurement, first), measurement.gate_unit)
    shown = {CONDUCTANCES[c]: _compared(result, measurement, c)["residual"] for c in others}
    _row_of_maps(figure, panels, shown, measurement.gate_unit)


def _compared(result: xr.Dataset, measurement: Measurement, channel: int) -> dict[str, Shown]:
    """Return maps of what was measured of a channel, of what is explained, and of the residual."""
    name = CONDUCTANCES[channel]
    axes = {measurement.axis: measurement.mu, "B": measurement.B, "bias": measurement.bias}
    measured = xr.DataArray(measurement.G[..., channel], axes, list(axes))
    upward, along, other = _shown_axes(axes)
    at = _nearest_to_zero(measured, other)
    grid = {upward: axes[upward], along: axes[along]}
    G, answer = (
        of.isel({other: at}).transpose(*grid).to_numpy() for of in (measured, result[name])
    )
    G = np.ma.masked_invalid(G)
    largest = max(abs(G).max(), abs(answer).max())
    colours = colour_scale(name, largest)
    beside = float(result["discrepancy"][channel]) if "discrepancy" in result else 0.0
    std = np.sqrt(errors_variance(result.attrs["noise"][channel]) + beside**2)
    value = axis_value(other, f"{axes[other][at]:g}", measurement.gate_unit)
    G_name, all_errors = symbol(name), r"$\sigma$ of the errors"
    gaps = " (grey: not)" if G.mask.any() else ""
    off = f"{G_name}, measured − explained"
    return {
        "measured": Shown(grid, G, f"{G_name} at {value}, measured{gaps}", "$e^2/h$", colours),
        "explained": Shown(grid, answer, f"{G_name}, explained", "$e^2/h$", colours),
        "residual": Shown(grid, (G - answer) / std, off, all_errors, RESIDUAL),
    }


def _shown_axes(axes: Mapping[str, FloatArray]) -> tuple[str, str, str]:
    """Return the names of the upward axis, of that along, and of the one of which one value is."""
    first, B, bias = axes
    if axes[bias].size > 1 and axes[first].size == 1:
        return bias, B, first
    if axes[bias].size > 1 and axes[B].size == 1:
        return bias, first, B
    return first, B, bias


def _nearest_to_zero(measured: xr.DataArray, axis: str) -> int:
    """Return where along an axis something was measured, as near to zero as possible."""
    others = [name for name in measured.dims if name != axis]
    there = measured.notnull().any(others).to_numpy()
    return int(np.where(there, abs(measured[axis].to_numpy()), np.inf).argmin())


def draw_maps(
    figure: Any, panels: Mapping[str, Any], result: xr.Dataset, measurement: Measurement
) -> None:
    """Show T_IV, P(topological) with the points of the data, and the gap that is sure."""
    axis, gap = measurement.axis, 1e3 * sure_gap(result)
    fine = {axis: result[f"map_{axis}"].to_numpy(), "B": result["map_B"].to_numpy()}
    data = {axis: measurement.mu, "B": measurement.B}
    most = gap.max() or 1e3 * float(result["gap"].max())
    in_T = {"cmap": T_IV_COLOURS, "vmin": -1, "vmax": 1}
    in_P = {"cmap": TOPOLOGICAL_COLOURS, "vmin": 0, "vmax": 1}
    in_gap = {"cmap": "cividis", "vmin": 0, "vmax": most}
    P, exceed = result["P_topological"].to_numpy(), f"gap, {100 * SURE:.0f} % sure"
    T_IV = result["T_IV"][0].to_numpy()
    closed = r" ($\Gamma = 0$)" if has_dissipation(result) else ""
    wire = "most probable wire" if "share" in result else "mean"  # in results of older versions
    shown = {
        "T": Shown(fine, T_IV, f"{T_IV_SYMBOL} of the {wire}{closed}", "", in_T),
        "P": Shown(fine, P, "$P$(topological); dots: data", "", in_P),
        "gap": Shown(data, gap, exceed + closed, "µeV", in_gap),
    }
    _row_of_maps(figure, panels, shown, measurement.gate_unit)
    along, upward = np.meshgrid(measurement.B, measurement.mu)
    if 1 in along.shape:
        along = data[_axis_of_curve(data)]
        upward = np.full_like(along, BELOW)
    panels["P"].plot(along.ravel(), upward.ravel(), ".", color="0.4", ms=0.6)


def _row_of_maps(
    figure: Any, panels: Mapping[str, Any], shown: Mapping[str, Shown], gate_unit: str
) -> None:
    """Draw maps side by side, or curves where an axis has one value; name the left one's axis."""
    for column, (kind, one) in enumerate(shown.items()):
        panel, (upward, along) = panels[kind], one.grid
        panel.set_title(one.title)
        if all(axis.size > 1 for axis in one.grid.values()):
            x, y = one.grid[along], one.grid[upward]
            how = {"shading": "nearest", "rasterized": True}
            panel.set_facecolor(NOT_MEASURED)
            image = panel.pcolormesh(x, y, one.values, **how, **one.options)
            panel.set_ylabel("" if column else axis_label(upward, gate_unit))
            figure.colorbar(image, ax=panel, label=one.unit, location="bottom", aspect=20)
        else:
            along = _axis_of_curve(one.grid)
            panel.plot(one.grid[along], one.values.ravel(), "k.-", lw=0.8, ms=2)
            panel.set_ylabel(one.unit)
            if one.options is not RESIDUAL:
                low, high = one.options["vmin"], one.options["vmax"]
                panel.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
        panel.set_xlabel(axis_label(along, gate_unit))


def _axis_of_curve(grid: Mapping[str, FloatArray]) -> str:
    """Return which of two axes, one of which has one value, a curve is over."""
    upward, along = grid
    return along if grid[along].size > 1 else upward


def sure_gap(result: xr.Dataset) -> FloatArray:
    """Return the energy in meV that the gap exceeds in SURE of the samples, shape (mu, B)."""
    surely = (result["P_gap"] >= SURE).sum("gap").to_numpy()
    energies = np.concatenate([[0.0], result["gap"].to_numpy()])
    return np.asarray(energies[surely])
