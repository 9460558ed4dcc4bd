"""Figure S7: topological visibility over μ and field, of test wires and of their predictions.

The realizations of Figure 3, whose cut at μ = 0 is dotted. T_IV is det r of the left end at zero
energy, with the device's barriers; the right end's is the same. Negative is topological.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from command import Request, figure_script
from disorder_landscape import Nanowire, topological_visibility
from disorder_landscape.symbols import T_IV_COLOURS, T_IV_SYMBOL
from plotting import (
    FULL_WIDTH,
    colour_bar,
    draw_map,
    inches,
    label_rows,
    outer_labels,
)
from wires import ROWS, drawn_realizations, letters, simulate_rows

LEFT, RIGHT, BOTTOM, TOP, GAP, ROW_GAP = 0.56, 0.56, 0.38, 0.24, 0.08, 0.24
"""In inches."""
PANEL_HEIGHT = 1.15
CUT = 0.0
"""μ of Figure 3 in meV."""


def data(request: Request) -> xr.Dataset:
    """Return T_IV (realization, row, mu, B) of the left end and alpha (realization, row)."""
    config, figures = request.config, request.config.figures
    mu = np.linspace(0.0, config.dataset.mu_max, figures.visibility_refinement * figures.mu_points)
    B = np.linspace(0.0, config.dataset.B_max, figures.visibility_refinement * figures.B_points)

    def simulate(wire: Nanowire) -> xr.Dataset:
        return topological_visibility(wire, mu, B).sel(lead="L", drop=True).to_dataset()

    chosen = drawn_realizations(request.evaluation(), config)
    return simulate_rows(chosen, config.dataset.wire, simulate)


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    columns = data.sizes["realization"]
    width = (FULL_WIDTH - LEFT - RIGHT - (columns - 1) * GAP) / columns
    height = BOTTOM + TOP + 2 * PANEL_HEIGHT + ROW_GAP
    figure = Figure(figsize=(FULL_WIDTH, height))
    panels = np.empty((len(ROWS), columns), dtype=object)
    norm = Normalize(-1.0, 1.0)
    for (row, i), _ in np.ndenumerate(panels):
        bottom = height - TOP - PANEL_HEIGHT - row * (PANEL_HEIGHT + ROW_GAP)
        axes = inches(figure, LEFT + i * (width + GAP), bottom, width, PANEL_HEIGHT)
        draw_map(axes, data["T_IV"][i, row], "mu", norm, T_IV_COLOURS)
        axes.axhline(CUT, color="r", ls=":", lw=1.5, clip_on=False)
        panels[row, i] = axes
    outer_labels(panels, "B", "mu")
    label_rows(panels, ROWS, "mu")
    varies = len(np.unique(data["alpha"])) > 1
    for i, letter in enumerate(letters(data)):
        for row, axes in enumerate(panels[:, i]):
            alpha = rf"$\alpha$ = {float(data['alpha'][i, row]):.2f} meV nm" if varies else ""
            axes.set_title(alpha if row else f"({letter})  {alpha}", loc="left")
    place = (FULL_WIDTH - RIGHT + 0.1, BOTTOM, 0.09, 2 * PANEL_HEIGHT + ROW_GAP)
    bar = colour_bar(figure, place, norm, T_IV_COLOURS, data["T_IV"])
    bar.set_label(T_IV_SYMBOL, labelpad=-2)
    return figure


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
