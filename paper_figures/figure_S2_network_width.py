"""Figure S2: R² over the width of the network, for several numbers of disorder components.

Every convolution's filters are multiplied by the fraction on the axis. Each curve starts, at the
full width that was affordable, with as many training realizations as give R² ≈ 0.77; dots are
single trainings, lines go through their mean over seeds. Drawn from results/network_width.csv,
which `landscape study network_width` measures.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from command import Request, figure_script
from disorder_landscape.chain import REPOSITORY
from disorder_landscape.studies.trainings_table import read_table
from plotting import COLUMN, draw_trainings, inches, trainings

TABLE = REPOSITORY / "results" / "network_width.csv"


def data(request: Request) -> xr.Dataset:
    """Return components, width_fraction, realizations, seed and R2 of every training (training)."""
    return trainings(read_table(TABLE), ["width_fraction", "realizations"])


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(COLUMN, 2.7))
    axes = inches(figure, 0.52, 0.42, COLUMN - 0.62, 2.18)
    draw_trainings(axes, data, "width_fraction", _label)
    widths = np.unique(data["width_fraction"])
    axes.set(xscale="log", xlabel="fraction of the paper's filters", ylabel="$R^2$")
    axes.xaxis.set_major_locator(FixedLocator(widths.tolist()))
    axes.xaxis.set_major_formatter(lambda x, _: f"1/{1 / x:g}" if x < 1 else "1")
    axes.xaxis.set_minor_locator(NullLocator())
    axes.legend(title="components", loc="lower right")
    return figure


def _label(n: int, of_n: xr.Dataset) -> str:
    return f"{n} ({int(of_n['realizations'][0]):,} realizations)"


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
