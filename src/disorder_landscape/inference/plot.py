"""A figure of what `infer` has found."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from disorder_landscape.inference.inferred import prior_of_result
from disorder_landscape.inference.page import DPI, write_page
from disorder_landscape.inference.plot_maps import (
    draw_conductances,
    draw_maps,
    measured_channels,
)
from disorder_landscape.inference.problem.distributions import Distribution
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.problem.parameters import BY_NAME
from disorder_landscape.inference.report import (
    SAID,
    error_bar,
    has_several_maxima,
    parameter_with_std,
    plain,
    prior_as_text,
    sentences_on,
)
from disorder_landscape.inference.verdict import CONVERGED
from disorder_landscape.model.disorder import positions
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.parts import needs
from disorder_landscape.pictures import write_picture
from disorder_landscape.symbols import symbol

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 7.06, 1.65
"""In inches: of a page of the paper's journal, and of a row of height one."""
LETTERS = 110
"""That fit in a line of this width."""
PAGE = "html"
"""The format of a page."""
INTERVALS = (5, 95), (25, 75)
"""Percentiles of the samples between which V is shaded."""


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
    others = [CONDUCTANCES[c] for c in measured_channels(measurement)[1:]]
    rows = {
        "V": (["V"] * 6, 1.0),
        "std": (["std"] * 6, 0.6),
        "c": ((["c"] * 3 if with_components else ["misfit"] * 3) + ["misfit"] * 3, 0.9),
        "parameters": (["parameters"] * 6, 0.3 + 0.12 * len(unknown)),
        "data": (_twice("measured", "explained", "residual"), 1.3),
        "others": (_twice(*others, *["."] * (3 - len(others))), 1.3),
        "maps": (_twice("T", "P", "gap"), 1.3),
    }
    if not unknown:
        del rows["parameters"]
    if not others:
        del rows["others"]
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
    draw_conductances(figure, panels, result, measurement)
    draw_maps(figure, panels, result, measurement)
    color = "k" if result.attrs["verdict"] == CONVERGED else "C3"
    said = "\n".join(fill(sentence, LETTERS) for sentence in sentences_on(result))
    figure.suptitle(said, fontsize=8, color=color)
    return figure


def _twice(*names: str) -> list[str]:
    return [name for name in names for _ in range(2)]


def _potential(panel: Any, result: xr.Dataset) -> None:
    V, x = result["potential_mean"].to_numpy(), _positions(result)
    panel.plot(x, V, "k", lw=0.8)
    panel.set(ylabel=r"$V_\mathrm{dis}$ [meV]", xlim=(x[0], x[-1]))
    panel.tick_params(labelbottom=False)
    if not has_several_maxima(result):
        panel.set_title("mean of the posterior")
        return
    maxima = zip(result["share"], result["potential_maxima"], strict=True)
    for number, (share, one) in enumerate(maxima):
        label = f"{100 * share:.0f} %" if number < SAID else None
        panel.plot(x, one, lw=0.6, label=label)
    panel.set_title("mean of the posterior (black), and its maxima with their shares of it")
    _legend_on_top(panel, ncols=SAID)


def _potential_std(panel: Any, result: xr.Dataset) -> None:
    """Show the samples' intervals about their mean, which V's own scale would hide."""
    off = 1e3 * (result["potential"] - result["potential_mean"]).to_numpy()
    x = _positions(result)
    for (low, high), alpha in zip(INTERVALS, (0.25, 0.5), strict=True):
        between = np.percentile(off, [low, high], axis=0)
        label = f"{high - low} % of the samples"
        panel.fill_between(x, *between, color="C0", alpha=alpha, lw=0, label=label)
    panel.set(xlabel="$x$ [µm]", ylabel="deviation\n[µeV]", xlim=(x[0], x[-1]))
    bar = f"error bar of V: {plain(error_bar(result))} µeV, root mean square"
    panel.set_title(f"samples of V minus their mean; {bar}")
    _legend_on_top(panel, ncols=2)


def _positions(result: xr.Dataset) -> FloatArray:
    return positions(result.sizes["site"], prior_of_result(result).lattice)


def _legend_on_top(panel: Any, ncols: int) -> None:
    """Show a legend in one row above what is drawn."""
    low, high = panel.get_ylim()
    panel.set_ylim(low, high + 0.5 * (high - low))
    panel.legend(ncols=ncols, frameon=False, loc="upper center")


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
        bar = [[min(std, mean)], [min(std, 1 - mean)]]  # not beyond what it may be
        panel.errorbar(mean, row, xerr=np.maximum(bar, 0), fmt="k.", capsize=2, lw=0.8)
        panel.text(1.02, row, parameter_with_std(result, name), va="center")
        before = f"{BY_NAME[name].long_name}, before: {prior_as_text(result, name, belief)}"
        panel.text(-0.02, row, before, va="center", ha="right")
    panel.set(xlim=(-1.75, 1.7), ylim=(len(unknown) - 0.4, -0.6))
    panel.axis("off")
    panel.set_title("parameters, each on the range that it may have (grey)")


def _misfit(panel: Any, result: xr.Dataset) -> None:
    position = np.arange(len(CONDUCTANCES))
    panel.bar(position, result["misfit"], 0.6, color="C0", alpha=0.5, label="misfit")
    noise = np.where(np.isfinite(result["misfit"]), result.attrs["noise"], np.nan)
    panel.plot(position, noise, "k_", ms=18, label="stated noise")
    if "discrepancy" in result:
        errors = np.hypot(noise, result["discrepancy"])
        panel.plot(position, errors, "_", color="C3", ms=18, label="and discrepancy")
    names = [symbol(name) for name in CONDUCTANCES]
    panel.set_xticks(position, names)
    largest = max(np.nanmax(line.get_ydata()) for line in panel.lines)
    largest = max(float(result["misfit"].max()), largest)
    panel.set(ylabel="r.m.s. [$e^2/h$]", ylim=(0, 1.5 * largest or None), xlim=(-0.6, 3.6))
    narrow = {"handlelength": 1.0, "columnspacing": 1.0, "handletextpad": 0.4, "markerscale": 0.6}
    panel.legend(frameon=False, ncols=3, loc="upper center", **narrow)
