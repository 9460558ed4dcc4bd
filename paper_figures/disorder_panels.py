"""Panels of disorder components and potentials, as in Figures 4 and S4."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from disorder_landscape.config import WireConfig
from disorder_landscape.model.disorder import positions
from plotting import FULL_WIDTH, INPUT, PREDICTION, inches, keep_labels_inside, write
from wires import ROWS, in_rows, letters, wire_of

LEFT, RIGHT, TOP, GAP = 0.58, 0.08, 0.42, 0.1
COMPONENTS, POTENTIAL = (2.12, 1.1), (0.38, 1.3)
"""Bottom and height of the panels, in inches."""
HEIGHT = COMPONENTS[0] + COMPONENTS[1] + TOP
"""Room that both rows of panels need, in inches."""


def disorder_data(chosen: xr.Dataset, fixed: WireConfig) -> xr.Dataset:
    """Return components and potential of input and prediction.

    Parameters
    ----------
    chosen : Dataset
        Of `drawn_realizations`.
    fixed : WireConfig
        What all wires have in common.

    Returns
    -------
    xarray.Dataset
        components (realization, row, component) and potential (realization, row, site) in meV,
        the latter with barriers; alpha (realization, row) in meV nm; x (site) in µm; the height of
        the barriers in meV as attribute.
    """
    table = in_rows(chosen)
    wires = [
        [wire_of(table, i, row, fixed) for row in range(len(ROWS))]
        for i in range(table.sizes["realization"])
    ]
    potential = np.array([[wire.potential_with_barriers for wire in pair] for pair in wires])
    attrs = {"units": "meV", "long_name": "disorder potential with barriers"}
    x = positions(wires[0][0].sites, wires[0][0].lattice)
    drawn = table.assign(potential=(table["potential"].dims, potential, attrs)).assign_coords(
        x=("site", x, {"units": "um", "long_name": "position along the wire"})
    )
    return drawn.assign_attrs(barrier=wires[0][0].barrier[0])


def draw_disorder(figure: Figure, data: xr.Dataset, bottom: float = 0.0) -> None:
    """Draw a row of components and a row of potentials, `bottom` inches above the figure's foot."""
    count = data.sizes["realization"]
    width = (FULL_WIDTH - LEFT - RIGHT - (count - 1) * GAP) / count
    for i, letter in enumerate(letters(data)):
        left = LEFT + i * (width + GAP)
        upper = inches(figure, left, bottom + COMPONENTS[0], width, COMPONENTS[1])
        lower = inches(figure, left, bottom + POTENTIAL[0], width, POTENTIAL[1])
        _draw_components(upper, data, i)
        _draw_potentials(lower, data, i)
        upper.set_title(f"realization {letter}")
        if i > 0:
            upper.tick_params(labelleft=False)
            lower.tick_params(labelleft=False)
        else:
            upper.set_ylabel("$c_n$ [meV]")
            lower.set_ylabel(r"$V_\mathrm{dis}(x)$ [meV]")
            note = rf"$\leftarrow$ barrier, {data.attrs['barrier']:g} meV"
            lower.annotate(note, (0.06, 0.97), xycoords="axes fraction", va="top", fontsize=8)
    handles = figure.axes[0].get_legend_handles_labels()[0]
    figure.legend(handles=handles[::-1], loc="upper right", ncols=2)
    write(figure, 0.04, bottom + COMPONENTS[0] + COMPONENTS[1] + 0.18, "(a)")
    write(figure, 0.04, bottom + POTENTIAL[0] + POTENTIAL[1] + 0.18, "(b)")


def _draw_components(axes: Axes, data: xr.Dataset, i: int) -> None:
    n = data["component"].to_numpy()
    true, predicted = data["components"][i].to_numpy()
    axes.axhline(0.0, color="0.6", lw=0.5)
    axes.bar(n, true, 0.55, color=INPUT, alpha=0.55, lw=0, label="input")
    axes.plot(n, predicted, "D", color=PREDICTION, mfc="none", ms=4, label="prediction")
    largest = 1.15 * float(np.abs(data["components"]).max())
    axes.set(ylim=(-largest, largest), xlim=(n[0] - 0.6, n[-1] + 0.6), xlabel="$n$")
    axes.set_xticks(n[:: 1 + (n.size - 1) // 10])


def _draw_potentials(axes: Axes, data: xr.Dataset, i: int) -> None:
    x = data["x"].to_numpy()
    true, predicted = data["potential"][i].to_numpy()
    axes.axhline(0.0, color="0.6", lw=0.5)
    axes.plot(x, true, color=INPUT, lw=1.2, label="input")
    axes.plot(x, predicted, "--", color=PREDICTION, lw=1.2, dashes=(3, 1.5), label="prediction")
    inner = data["potential"][..., 1:-1]  # without the barriers
    largest = float(np.abs(inner).max())
    axes.set(ylim=(-1.15 * largest, 1.5 * largest), xlim=(-0.02 * x[-1], 1.02 * x[-1] + x[0]))
    axes.set_xlabel(r"$x$ [µm]")
    ticks = [tick for tick in MaxNLocator(3).tick_values(0.0, x[-1]) if tick < 1.02 * x[-1]]
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    keep_labels_inside(axes.xaxis)
