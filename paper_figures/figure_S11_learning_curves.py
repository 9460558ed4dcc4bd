"""Figure S11: the learning curves behind Figure 2.

R² on test realizations over training realizations, by the paper's network and by the residual one,
one colour for each number of components: dots are single trainings, lines go through their mean
over seeds. Dotted: R² = 0.77.
"""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from command import Request, figure_script
from figure_2_scaling import TABLES
from plotting import FULL_WIDTH, network_panels, trainings


def data(request: Request) -> xr.Dataset:
    """Return network, components, realizations, seed and R2 of every training (training)."""
    return trainings(TABLES, ["realizations"])


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(FULL_WIDTH, 2.8))
    numbers = np.unique(data["components"])
    colours = dict(
        zip(numbers, mpl.colormaps["viridis"](np.linspace(0.0, 0.9, len(numbers))), strict=True)
    )
    low = max(0.0, float(data["R2"].min()) - 0.05)
    for axes, of_network in network_panels(figure, data, "$R^2$ on test realizations", 1.01):
        _draw_curves(axes, of_network, colours)
        axes.set(xscale="log", xlabel="training realizations", ylim=(low, 1.0))
    handles = [mpl.lines.Line2D([], [], color=colour, lw=1) for colour in colours.values()]
    axes.legend(handles, numbers, title="components", loc="upper left", bbox_to_anchor=(1.0, 1.03))
    return figure


def _draw_curves(axes: Axes, data: xr.Dataset, colours: dict[int, np.ndarray]) -> None:
    for n in np.unique(data["components"]):
        of_n = data.isel(training=np.flatnonzero(data["components"] == n))
        mean = of_n["R2"].groupby(of_n["realizations"]).mean()
        axes.plot(of_n["realizations"], of_n["R2"], ".", color=colours[n], ms=4, alpha=0.6)
        axes.plot(mean["realizations"], mean, "-", color=colours[n], lw=1)


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
