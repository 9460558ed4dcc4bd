"""Pieces that the figures share: sizes, labels, colour scales, maps and colour bars."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.axis import Axis, XAxis
from matplotlib.cm import ScalarMappable
from matplotlib.collections import QuadMesh
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from disorder_landscape.studies.crossings import R2_AIMED_AT
from disorder_landscape.studies.trainings_table import read_table
from disorder_landscape.symbols import LOCAL, axis_label, colour_scale

COLUMN, FULL_WIDTH = 3.404, 7.06
"""REVTeX's widths in inches."""

TICKS = {"B": (0.0, 0.4, 0.8), "mu": (0.0, 0.3, 0.6), "bias": (-0.04, 0.0, 0.04)}

INPUT, PREDICTION = "#0072B2", "#D55E00"
"""Blue and vermilion of Okabe and Ito, told apart by colour-blind readers and in grey."""
CLIPPED_SHARE = 0.01
"""Share of the nonlocal conductances that a colour scale may cut off: sharp peaks hide the rest."""


def paper_style() -> AbstractContextManager[None]:
    """Return the context in which figures are drawn and saved."""
    context: AbstractContextManager[None] = style.context(
        Path(__file__).with_name("style.mplstyle")
    )
    return context


def inches(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Add axes whose place is given in inches from the figure's lower left corner."""
    w, h = figure.get_size_inches()
    axes: Axes = figure.add_axes((left / w, bottom / h, width / w, height / h))
    return axes


def trainings(tables: Mapping[str, Path], names: Sequence[str]) -> xr.Dataset:
    """Return network, some columns, components, seed and R2 of all trainings (training).

    Of the studies' tables of several networks.
    """
    columns = ("components", *names, "seed", "R2")
    found = [(network, one) for network, path in tables.items() for one in read_table(path)]
    of_each = {name: np.array([getattr(one, name) for _, one in found]) for name in columns}
    of_each["network"] = np.array([network for network, _ in found])
    return xr.Dataset({name: ("training", values) for name, values in of_each.items()})


def network_panels(
    figure: Figure, data: xr.Dataset, ylabel: str, right: float
) -> Iterator[tuple[Axes, xr.Dataset]]:
    """Add axes for R² of two networks side by side; yield each with the trainings it is for.

    Dotted is the R² of Fig. 2; so many inches are free to their right.
    """
    networks = list(dict.fromkeys(data["network"].to_numpy()))
    width = (FULL_WIDTH - 0.64 - right) / 2
    for i, network in enumerate(networks):
        axes = inches(figure, 0.52 + i * (width + 0.12), 0.42, width, 2.1)
        axes.set(title=network, ylabel="" if i else ylabel)
        axes.tick_params(labelleft=not i)
        axes.axhline(R2_AIMED_AT, color="0.4", ls=":", lw=1)
        yield axes, data.isel(training=np.flatnonzero(data["network"] == network))


def write(figure: Figure, left: float, top: float, text: str, ha: str = "left") -> None:
    """Write text below a place given in inches."""
    w, h = figure.get_size_inches()
    figure.text(left / w, top / h, text, ha=ha, va="top")


def conductance_scale(G: xr.DataArray) -> tuple[Normalize, str]:
    """Return norm and colour map for all maps of one conductance.

    Local ones are drawn from 0 to their maximum, nonlocal ones symmetrically about 0, their
    sharpest peaks cut off.
    """
    largest = G.max() if G.name in LOCAL else np.quantile(np.abs(G), 1 - CLIPPED_SHARE)
    scale = colour_scale(str(G.name), _rounded_up(float(largest)))
    return Normalize(scale["vmin"], scale["vmax"]), scale["cmap"]


def conductance_unit(name: str) -> tuple[float, str]:
    """Return the unit in e²/h in which a conductance is labelled, and its words."""
    return (1.0, "[$e^2/h$]") if name in LOCAL else (1e-3, r"[$10^{-3}\,e^2/h$]")


def _rounded_up(value: float) -> float:
    """Return the next larger round number, for colour bars to end at."""
    if value <= 0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    steps = (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9, 10)
    return next(float(f"{step * power:.2g}") for step in steps if value <= step * power)


def draw_map(axes: Axes, values: xr.DataArray, y: str, norm: Normalize, colours: str) -> QuadMesh:
    """Draw a map over B and y, one cell centred on each grid point, in a rasterised mesh."""
    axes.set_label(str(values.name))
    grid = values.transpose(y, "B")
    mesh = axes.pcolormesh(
        grid["B"], grid[y], grid, norm=norm, cmap=colours, shading="nearest", rasterized=True
    )
    set_ticks(axes, "x", "B", grid["B"].to_numpy())
    set_ticks(axes, "y", y, grid[y].to_numpy())
    return mesh


def set_ticks(axes: Axes, which: str, quantity: str, grid: np.ndarray) -> None:
    """Put ticks at round numbers within the grid, the outer labels within the axes' extent."""
    ticks = [tick for tick in TICKS[quantity] if grid[0] - 1e-9 <= tick <= grid[-1] + 1e-9]
    axis = axes.xaxis if which == "x" else axes.yaxis
    axis.set_ticks(ticks, [f"{tick:g}".replace("-", "−") for tick in ticks])
    keep_labels_inside(axis)


def keep_labels_inside(axis: Axis) -> None:
    """Align the outer two tick labels inwards, so that neighbouring panels' do not collide."""
    labels = axis.get_ticklabels()
    if len(labels) > 1:
        first, last = labels[0], labels[-1]
        if isinstance(axis, XAxis):
            first.set_horizontalalignment("left")
            last.set_horizontalalignment("right")
        else:
            first.set_verticalalignment("bottom")
            last.set_verticalalignment("top")


def outer_labels(panels: np.ndarray, x: str, y: str) -> None:
    """Label shared axes at the outside only.

    Parameters
    ----------
    panels : array of Axes, shape (row, column)
    x, y : str
        Names of the quantities.
    """
    for (row, column), axes in np.ndenumerate(panels):
        bottom, left = row == panels.shape[0] - 1, column == 0
        axes.tick_params(labelbottom=bottom, labelleft=left)
        axes.set_xlabel(axis_label(x) if bottom else "")
        axes.set_ylabel(axis_label(y) if left else "")


def label_rows(panels: np.ndarray, rows: Sequence[str], y: str) -> None:
    """Write what each row of panels shows beside the label of its upward axis."""
    for row, axes in zip(rows, panels[:, 0], strict=True):
        axes.set_ylabel(rf"$\it{{{row}}}$" + "\n" + axis_label(y), linespacing=1.1)


def colour_bar(
    figure: Figure,
    place: Sequence[float],
    norm: Normalize,
    colours: str,
    values: xr.DataArray,
    unit: float = 1.0,
) -> Colorbar:
    """Draw a colour bar whose ends are arrows where values lie beyond them.

    Parameters
    ----------
    figure : Figure
    place : left, bottom, width, height
        In inches; upright if it is higher than wide.
    norm, colours
        Of the maps.
    values : DataArray
        All that is drawn with this norm.
    unit : float
        Tick labels are in this unit.
    """
    assert norm.vmin is not None
    assert norm.vmax is not None
    margin = 1e-6 * (norm.vmax - norm.vmin)  # rounding is no clipping
    low = float(values.min()) < norm.vmin - margin
    high = float(values.max()) > norm.vmax + margin
    extend = {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[low, high]
    upright = place[3] > place[2]
    bar = figure.colorbar(
        ScalarMappable(norm, mpl.colormaps[colours]),
        cax=inches(figure, *place),
        orientation="vertical" if upright else "horizontal",
        extend=extend,
        extendfrac=0.08,
    )
    bar.outline.set_linewidth(0.6)
    ticks = sorted({norm.vmin, 0.0, norm.vmax})
    bar.set_ticks(ticks, labels=[f"{tick / unit:g}".replace("-", "−") for tick in ticks])
    return bar
