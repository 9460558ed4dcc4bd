"""Maps of the conductance matrix, input above prediction, for Figures 3 and S5."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.symbols import symbol
from plotting import (
    FULL_WIDTH,
    colour_bar,
    conductance_scale,
    conductance_unit,
    draw_map,
    inches,
    keep_labels_inside,
    label_rows,
    outer_labels,
    write,
)
from wires import ROWS, alphas, letters

LEFT = {"bias": 0.74, "mu": 0.56}
RIGHT, BETWEEN_BLOCKS, GAP = 0.08, 0.22, 0.05
"""Margins, and gaps between blocks and between panels, in inches."""
TITLE, BARS = 0.36, 0.83
"""Room above and below the panels of a block, in inches."""


def blocks_height(realizations: int, y: str) -> float:
    """Return the room in inches that the blocks of so many realizations need."""
    return -(-realizations // 2) * _block_size(y)[1]


def draw_conductance_blocks(
    figure: Figure, data: xr.Dataset, y: str, names: Sequence[str] | None = None
) -> None:
    """Draw a block of 2 × 4 maps per realization, two blocks side by side, at the figure's foot.

    Input and prediction share the norm of each conductance.

    Parameters
    ----------
    figure : Figure
        Of full width, and at least of `blocks_height`.
    data : Dataset
        G_LL … G_RL (realization, row, B, y) in e²/h and alpha (realization, row).
    y : {"bias", "mu"}
        Upward axis.
    names : sequence of str, optional
        Of the blocks; by default a, b, c, …
    """
    block_width, block_height, panel = _block_size(y)
    head = blocks_height(data.sizes["realization"], y)
    for i, name in enumerate(names or letters(data)):
        left = LEFT[y] + (i % 2) * (block_width + BETWEEN_BLOCKS)
        top = head - (i // 2) * block_height
        write(figure, left, top - 0.03, f"({name})  {alphas(data, i)}")
        panels = _draw_maps(figure, data.isel(realization=i), y, left, top - TITLE, panel)
        if i % 2 == 0:
            label_rows(panels, ROWS, y)
        else:  # the block to the left is labelled
            for axes in panels[:, 0]:
                axes.set_ylabel("")
                axes.tick_params(labelleft=False)
        _draw_colour_bars(figure, data.isel(realization=i), left, top - block_height + 0.39, panel)


def _block_size(y: str) -> tuple[float, float, float]:
    """Return width and height of a block and the width of a panel, in inches."""
    panel = (FULL_WIDTH - LEFT[y] - RIGHT - BETWEEN_BLOCKS - 6 * GAP) / 8
    return 4 * panel + 3 * GAP, TITLE + 2 * panel + GAP + BARS, panel


def _draw_maps(
    figure: Figure, data: xr.Dataset, y: str, left: float, top: float, panel: float
) -> np.ndarray:
    """Draw one realization's maps; return their axes, shape (row, column)."""
    panels = np.empty((len(ROWS), len(CONDUCTANCES)), dtype=object)
    for (row, column), _ in np.ndenumerate(panels):
        name = CONDUCTANCES[column]
        bottom = top - panel - row * (panel + GAP)
        axes = inches(figure, left + column * (panel + GAP), bottom, panel, panel)
        draw_map(axes, data[name].isel(row=row), y, *conductance_scale(data[name]))
        if row == 0:
            axes.set_title(symbol(name))
        panels[row, column] = axes
    outer_labels(panels, "B", y)
    return panels


def _draw_colour_bars(
    figure: Figure, data: xr.Dataset, left: float, bottom: float, panel: float
) -> None:
    """Draw one colour bar below each conductance's maps."""
    for column, name in enumerate(CONDUCTANCES):
        place = (left + column * (panel + GAP) + 0.05, bottom, panel - 0.1, 0.07)
        scale = conductance_scale(data[name])
        bar = colour_bar(figure, place, *scale, data[name], conductance_unit(name)[0])
        keep_labels_inside(bar.ax.xaxis)
    pair = 2 * panel + GAP
    for i, name in enumerate(CONDUCTANCES[::2]):
        label = f"$G$ {conductance_unit(name)[1]}"
        write(figure, left + i * (pair + GAP) + pair / 2, bottom - 0.17, label, ha="center")
