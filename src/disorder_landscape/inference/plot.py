"""A figure of what `infer` has found."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from disorder_landscape.files import write_picture
from disorder_landscape.inference.inferred import prior_of_result
from disorder_landscape.inference.problem.distributions import Distribution
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.report import (
    error_bar,
    parameter_with_std,
    prior_as_text,
)
from disorder_landscape.inference.verdict import CONVERGED
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.parts import needs

FIGURE_SIZE = 7.06, 7.2
"""In inches; the width is that of a page of the paper's journal."""
INTERVALS = (5, 95), (25, 75)
"""Percentiles of the samples between which V is shaded."""
APART = np.array([-0.25, 0.25])
"""Where the pixels of a map are that has one value of µ or B alone."""


@needs("figures")
def plot_inference(result: xr.Dataset, measurement: Measurement, path: Path) -> None:
    """Draw V and how sure it is, components, misfits, G measured and explained, P(topological).

    Parameters
    ----------
    result : Dataset
        What `infer` returned.
    measurement : Measurement
        What it was given.
    path : Path
        Picture, of a format that matplotlib knows.

    Raises
    ------
    ArgumentError
        If the file cannot be written.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    unknown = prior_of_result(result).unknown
    with_components = "component" in result.dims
    rows = {
        "V": (["V"] * 4, 1.0),
        "std": (["std"] * 4, 0.6),
        "c": ((["c"] * 2 if with_components else ["misfit"] * 2) + ["misfit"] * 2, 0.9),
        "parameters": (["parameters"] * 4, 0.3 + 0.12 * len(unknown)),
        "maps": (["measured", "explained", "T", "P"], 1.3),
    }
    if not unknown:
        del rows["parameters"]
    heights = [height for _, height in rows.values()]
    width, least_height = FIGURE_SIZE
    with mpl.rc_context({"font.size": 8, "axes.titlesize": 8}):
        height = least_height * sum(heights) / (sum(heights) - rows.get("parameters", ([], 0.0))[1])
        figure = Figure(figsize=(width, height), layout="constrained")
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
        _conductances(figure, panels["measured"], panels["explained"], result, measurement)
        _maps(figure, panels["T"], panels["P"], result)
        color = "k" if result.attrs["verdict"] == CONVERGED else "C3"
        title = f"{result.attrs['verdict']}; from {result.attrs['start']}"
        figure.suptitle(title, fontsize=8, color=color)
        write_picture(path, figure, dpi=200)


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
    figure: Any, measured: Any, explained: Any, result: xr.Dataset, measurement: Measurement
) -> None:
    """Show the first channel that was measured, at the bias next to zero."""
    there = np.isfinite(measurement.G).any(axis=(0, 1, 2))
    channel = int(there.argmax())
    name, at = CONDUCTANCES[channel], int(abs(measurement.bias).argmin())
    G = np.ma.masked_invalid(measurement.G[:, :, at, channel])
    answer = result[name].to_numpy()[:, :, at]
    largest = max(abs(G).max(), abs(answer).max())
    local = name in ("G_LL", "G_RR")
    norm = {"vmin": 0 if local else -largest, "vmax": largest}
    norm["cmap"] = "viridis" if local else "RdBu_r"
    channel_name, bias = rf"$G_\mathrm{{{name[2:]}}}$", f"{measurement.bias[at]:g} meV"
    titles = f"{channel_name}, {bias}: measured", f"{channel_name} explained"
    for panel, values, title in zip((measured, explained), (G, answer), titles, strict=True):
        image = _map(panel, measurement.mu, measurement.B, values, **norm)
        panel.set_title(title)
    explained.set_ylabel("")
    figure.colorbar(image, ax=[measured, explained], label="$e^2/h$", location="bottom", aspect=30)


def _maps(figure: Any, visibility: Any, probability: Any, result: xr.Dataset) -> None:
    grids = result["map_mu"].to_numpy(), result["map_B"].to_numpy()
    T = _map(visibility, *grids, result["T_IV"][0], cmap="RdBu", vmin=-1, vmax=1)
    P = _map(probability, *grids, result["P_topological"], cmap="Purples", vmin=0, vmax=1)
    visibility.set_title(r"$T_\mathrm{IV}$ of the mean")
    probability.set_title("$P$(topological)")
    for panel, image in ((visibility, T), (probability, P)):
        panel.set_ylabel("")
        figure.colorbar(image, ax=panel, location="bottom", aspect=15)


def _map(panel: Any, mu: FloatArray, B: FloatArray, values: Any, **options: Any) -> Any:
    panel.set(xlabel="$B$ [T]", ylabel=r"$\mu$ [meV]")
    if mu.size == 1:  # as wide as the panel
        panel.set_yticks(mu)
        mu, values = mu + APART, np.ma.repeat(values, 2, axis=0)
    if B.size == 1:
        panel.set_xticks(B)
        B, values = B + APART, np.ma.repeat(values, 2, axis=1)
    return panel.pcolormesh(B, mu, values, shading="nearest", rasterized=True, **options)
