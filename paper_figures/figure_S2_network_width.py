"""Figure S2: R² over the width of the network, for several numbers of disorder components.

Every convolution's filters are multiplied by the fraction on the axis. Each curve starts, at the
full width that was affordable, with as many training realizations as give R² ≈ 0.77. Means over
seeds; bars are their standard errors. Dotted: R² = 0.77. Drawn from what
`landscape study network_width_residual` has measured.
"""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from command import Request, figure_script
from disorder_landscape.chain import REPOSITORY
from disorder_landscape.studies.crossings import R2_AIMED_AT
from disorder_landscape.studies.trainings_table import read_table
from plotting import COLUMN, inches, trainings

SHIFT = 1.07
"""Of the outermost curves along the axis, a factor."""
TABLE = REPOSITORY / "results" / "network_width_residual.csv"


def data(request: Request) -> xr.Dataset:
    """Return components, width_fraction, realizations, seed and R2 of every training (training)."""
    return trainings(read_table(TABLE), ["width_fraction", "realizations"])


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(COLUMN, 2.7))
    axes = inches(figure, 0.52, 0.42, COLUMN - 0.62, 2.18)
    widths = np.unique(data["width_fraction"])
    numbers = np.unique(data["components"])
    for colour, shift, n in zip(*_apart(len(numbers)), numbers, strict=True):
        of_n = data.isel(training=np.flatnonzero(data["components"] == n))
        R2 = of_n["R2"].groupby(of_n["width_fraction"])
        error = R2.std(ddof=1) / np.sqrt(R2.count())
        axes.errorbar(
            widths * shift, R2.mean(), error, fmt="o-", color=colour, ms=2.5, lw=1, capsize=1.5,
            label=_label(n, of_n),
        )  # fmt: skip
    axes.axhline(R2_AIMED_AT, color="0.4", ls=":", lw=1)
    axes.set(xscale="log", xlabel="fraction of the paper's filters", ylabel="$R^2$")
    axes.xaxis.set_major_locator(FixedLocator(widths.tolist()))
    axes.xaxis.set_major_formatter(lambda x, _: f"1/{1 / x:g}" if x < 1 else "1")
    axes.xaxis.set_minor_locator(NullLocator())
    low, high = axes.get_ylim()
    axes.set_ylim(low - 0.3 * (high - low), high)  # room for the legend
    axes.legend(title="components", loc="lower right")
    return figure


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
