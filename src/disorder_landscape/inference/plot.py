"""A figure of what `infer` has found."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from disorder_landscape.files import write_picture
from disorder_landscape.inference.inferred import prior_of_result
from disorder_landscape.inference.page import DPI, write_page
from disorder_landscape.inference.problem.distributions import Distribution
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.problem.observation import errors_variance
from disorder_landscape.inference.report import (
    SURE,
    error_bar,
    parameter_with_std,
    prior_as_text,
    sentences_on,
)
from disorder_landscape.inference.verdict import CONVERGED
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.parts import needs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 7.06, 1.65
"""In inches: of a page of the paper's journal, and of a row of height one."""
LETTERS = 110
"""That fit in a line of this width."""
PAGE = "html"
"""The format of a page."""
RESIDUAL = {"cmap": "RdBu_r", "vmin": -4, "vmax": 4}
"""How residuals are shown, in standard deviations of all errors, the simulation's included."""
INTERVALS = (5, 95), (25, 75)
"""Percentiles of the samples between which V is shaded."""
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


@needs("figures")
def plot_inference(result: xr.Dataset, measurement: Measurement, path: Path) -> None:
    """Draw V and how sure it is, parameters, G measured and explained, P(topological) and gap.

    Parameters
    ----------
    result : Dataset
        What `infer` returned.
    measurement : Measurement
        What it was given.
    path : Path
        Picture, of a format that matplotlib knows, or a page (.html).

    Raises
    ------
    ArgumentError
        If the file cannot be written.
    """
    import matplotlib as mpl

    with mpl.rc_context({"font.size": 8, "axes.titlesize": 8}):
        figure = _figure(result, measurement)
        if path.suffix == f".{PAGE}":
            write_page(result, figure, path)
        else:
            write_picture(path, figure, dpi=DPI)


def _figure(result: xr.Dataset, measurement: Measurement) -> Figure:
    from matplotlib.figure import Figure

    unknown = prior_of_result(result).unknown
    with_components = "component" in result.dims
    rows = {
        "V": (["V"] * 6, 1.0),
        "std": (["std"] * 6, 0.6),
        "c": ((["c"] * 3 if with_components else ["misfit"] * 3) + ["misfit"] * 3, 0.9),
        "parameters": (["parameters"] * 6, 0.3 + 0.12 * len(unknown)),
        "data": (_twice("measured", "explained", "residual"), 1.3),
        "maps": (_twice("T", "P", "gap"), 1.3),
    }
    if not unknown:
        del rows["parameters"]
    heights = [height for _, height in rows.values()]
    figure = Figure(figsize=(WIDTH, HEIGHT * sum(heights)), layout="constrained")
    panels: dict[str, Any] = figure.subplot_mosaic(
        [row for row, _ in rows.values()], height_ratios=heights
    )
    _potential(panels["V"], result)
    _potential_std(panels["std"], result)
    if with_components:
        _components(panels["c"], result)
    if unknown:
        _parameters(panels["parameters"], result, unknown)
    _misfit(panels["misfit"], result)
    _conductances(figure, panels, result, measurement)
    _maps(figure, panels, result, measurement)
    color = "k" if result.attrs["verdict"] == CONVERGED else "C3"
    said = "\n".join(fill(sentence, LETTERS) for sentence in sentences_on(result))
    figure.suptitle(said, fontsize=8, color=color)
    return figure


def _twice(*names: str) -> list[str]:
    return [name for name in names for _ in range(2)]


def _potential(panel: Any, result: xr.Dataset) -> None:
    V, site = result["potential_mean"].to_numpy(), result["site"].to_numpy()
    panel.plot(site, V, "k", lw=0.8)
    panel.set(ylabel=r"$V_\mathrm{dis}$ [meV]", xlim=(site[0], site[-1]))
    panel.tick_params(labelbottom=False)
    panel.set_title("mean of the posterior")


def _potential_std(panel: Any, result: xr.Dataset) -> None:
    """Show the samples' intervals about their mean, which V's own scale would hide."""
    off = 1e3 * (result["potential"] - result["potential_mean"]).to_numpy()
    site = result["site"].to_numpy()
    for (low, high), alpha in zip(INTERVALS, (0.25, 0.5), strict=True):
        between = np.percentile(off, [low, high], axis=0)
        label = f"{high - low} % of the samples"
        panel.fill_between(site, *between, color="C0", alpha=alpha, lw=0, label=label)
    panel.set(xlabel="site", ylabel="off [µeV]", xlim=(site[0], site[-1]))
    bar = f"error bar of V: {error_bar(result):.2g} µeV, root mean square"
    panel.set_title(f"samples minus mean; {bar}")
    low, high = panel.get_ylim()
    panel.set_ylim(low, high + 0.5 * (high - low))  # room for the legend
    panel.legend(ncols=2, frameon=False, loc="upper center")


def _components(panel: Any, result: xr.Dataset) -> None:
    c, bar = result["components_mean"], result["components_std"]
    panel.errorbar(result["component"], c, bar, fmt="k.", capsize=2, lw=0.8)
    panel.axhline(0.0, color="0.7", lw=0.5)
    panel.set(xlabel="component $n$", ylabel="$c_n$ [meV]")
    panel.xaxis.get_major_locator().set_params(integer=True)


def _parameters(panel: Any, result: xr.Dataset, unknown: Mapping[str, Distribution]) -> None:
    """Show each parameter on the range that the prior gives it, and its value beside it."""
    for row, (name, belief) in enumerate(unknown.items()):
        low, high = belief.range
        mean, std = ((result[name + end].item() - low) / (high - low) for end in ("_mean", "_std"))
        std += low / (high - low)
        panel.barh(row, 1.0, 0.5, color="0.85", lw=0)
        panel.errorbar(mean, row, xerr=std, fmt="k.", capsize=2, lw=0.8)
        panel.text(1.02, row, parameter_with_std(result, name), va="center")
        panel.text(-0.02, row, f"{name}, before: {prior_as_text(belief)}", va="center", ha="right")
    panel.set(xlim=(-0.75, 1.65), ylim=(len(unknown) - 0.4, -0.6))
    panel.axis("off")
    panel.set_title("parameters, each on the range that it may have (grey)")


def _misfit(panel: Any, result: xr.Dataset) -> None:
    position = np.arange(len(CONDUCTANCES))
    panel.bar(position, result["misfit"], 0.6, color="C0", alpha=0.5, label="misfit")
    panel.plot(position, result.attrs["noise"], "k_", ms=18, label="stated noise")
    names = [rf"$G_\mathrm{{{name[2:]}}}$" for name in CONDUCTANCES]
    panel.set_xticks(position, names)
    largest = max(result["misfit"].max(), np.max(result.attrs["noise"]))
    panel.set(ylabel="r.m.s. [$e^2/h$]", ylim=(0, 1.4 * largest or None))
    panel.legend(frameon=False, ncols=2, loc="upper center")


def _conductances(
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


def _maps(
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
