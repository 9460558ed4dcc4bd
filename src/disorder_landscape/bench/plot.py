"""The picture of the benchmark: time against wire length, and how much faster than Kwant."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from disorder_landscape.pictures import write_picture

BOUND = 2500
"""The ratio that was asked for, per energy and per set."""


def plot(found: Mapping[str, Any], path: Path) -> None:
    """Draw what `measurements.measure` returns.

    Raises
    ------
    ArgumentError
        If the file cannot be written.
    """
    figure = Figure(figsize=(9, 3.4), layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2, width_ratios=(1, 1.1))
    _plot_lengths(left, found)
    _plot_ratios(right, found["Kwant / fast"])
    write_picture(path, figure, dpi=200)


def _plot_lengths(axes: Any, found: Mapping[str, Any]) -> None:
    sites = np.array(found["sites"])
    for name, marker in (("per energy", "o"), ("per set", "s")):
        times = 1e6 * np.array([found["medians"][f"{name}, {n} sites"] for n in sites])
        label = f"{name}, exponent {found['exponent'][name]['all']:.2f}"
        (drawn,) = axes.loglog(sites, times, marker, label=label)
        slope_one = times[1] * sites / sites[1]
        axes.loglog(sites, slope_one, "-", color=drawn.get_color(), lw=0.8, zorder=1)
    axes.set_xticks(sites, [str(n) for n in sites])
    axes.minorticks_off()
    axes.set(xlabel="sites", ylabel="time on one core (µs)", title="Lines: slope 1")
    axes.legend(frameon=False)


def _plot_ratios(axes: Any, ratios: Mapping[str, float]) -> None:
    names, values = list(ratios), list(ratios.values())
    bars = axes.barh(names, values, color=["C0", *["C1"] * (len(names) - 1)], height=0.6)
    labels = [f"{value:,.0f}" for value in values]
    axes.bar_label(bars, labels, label_type="center", color="white", weight="bold")
    axes.axvline(BOUND, color="k", lw=0.8, ls="--")
    axes.invert_yaxis()
    axes.set(xscale="log", xlim=(10, 4 * max(*values, BOUND)))
    axes.set(xlabel="Kwant / fast, time on one core", title=f"Dashed: {BOUND:,}")
    axes.spines[["top", "right"]].set_visible(False)
