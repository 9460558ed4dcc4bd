"""Figure S2: R² over the width of the network, for several numbers of disorder components.

Left, the paper's network by its recipe, from all of its filters down; right, the residual one, from
a quarter of the paper's filters and as many training realizations as give it R² ≈ 0.77. Every
convolution's filters are multiplied by the fraction on the axis. Means over seeds; bars are their
standard errors, where there is more than one. Dotted: R² = 0.77. Drawn from what `landscape study
network_width` and `landscape study network_width_residual` have measured.
"""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from command import Request, figure_script
from disorder_landscape.runs import REPOSITORY
from plotting import FULL_WIDTH, network_panels, trainings

SHIFT = 1.07
"""Of the outermost curves along the axis, a factor."""
RESULTS = REPOSITORY / "results"
TABLES = {
    "paper's network": RESULTS / "network_width.csv",
    "residual network": RESULTS / "network_width_residual.csv",
}


def data(request: Request) -> xr.Dataset:
    """Return network, components, width_fraction, realizations, seed and R2 (training)."""
    return trainings(TABLES, ["width_fraction", "realizations"])


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(FULL_WIDTH, 2.8))
    low = float(data["R2"].min())
    for axes, of_network in network_panels(figure, data, "$R^2$", 0.1):
        _draw_widths(axes, of_network)
        axes.set_xlabel("fraction of the paper's filters")
        axes.set_ylim(low - 0.65 * (1 - low), 1.0)  # room for the legend
        axes.legend(title="components", loc="lower right")
    return figure


def _draw_widths(axes: Axes, data: xr.Dataset) -> None:
    widths = np.unique(data["width_fraction"])
    numbers = np.unique(data["components"])
    for colour, shift, n in zip(*_apart(len(numbers)), numbers, strict=True):
        of_n = data.isel(training=np.flatnonzero(data["components"] == n))
        R2 = of_n["R2"].groupby(of_n["width_fraction"])
        error = R2.std() / np.sqrt(np.maximum(R2.count() - 1, 1))
        axes.errorbar(
            widths * shift, R2.mean(), error, fmt="o-", color=colour, ms=2.5, lw=1, capsize=1.5,
            label=_label(n, of_n),
        )  # fmt: skip
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(FixedLocator(widths.tolist()))
    axes.xaxis.set_major_formatter(lambda x, _: f"1/{1 / x:g}" if x < 1 else "1")
    axes.xaxis.set_minor_locator(NullLocator())


def _apart(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return colours, and factors that keep the bars of so many curves apart."""
    colours = mpl.colormaps["viridis"](np.linspace(0.0, 0.9, count))
    return colours, np.geomspace(1 / SHIFT, SHIFT, count)


def _label(n: int, of_n: xr.Dataset) -> str:
    return f"{n} ({int(of_n['realizations'][0]):,} realizations)"


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
