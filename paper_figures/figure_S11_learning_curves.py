"""Figure S11: the learning curves behind Figure 2.

R² on test realizations over training realizations, one panel for all numbers of components: dots
are single trainings, lines go through their mean over seeds. Dotted: R² = 0.77.
"""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from command import Request, figure_script
from disorder_landscape.studies.crossings import R2_AIMED_AT
from disorder_landscape.studies.trainings_table import read_table
from figure_2_scaling import TABLE
from plotting import FULL_WIDTH, inches, trainings


def data(request: Request) -> xr.Dataset:
    """Return components, realizations, seed and R2 of every training (training)."""
    return trainings(read_table(TABLE), ["realizations"])


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(FULL_WIDTH, 2.8))
    axes = inches(figure, 0.52, 0.42, FULL_WIDTH - 1.5, 2.28)
    numbers = np.unique(data["components"])
    colours = mpl.colormaps["viridis"](np.linspace(0.0, 0.9, len(numbers)))
    for colour, n in zip(colours, numbers, strict=True):
        of_n = data.isel(training=np.flatnonzero(data["components"] == n))
        mean = of_n["R2"].groupby(of_n["realizations"]).mean()
        axes.plot(of_n["realizations"], of_n["R2"], ".", color=colour, ms=4, alpha=0.6)
        axes.plot(mean["realizations"], mean, "-", color=colour, lw=1, label=f"{n}")
    axes.axhline(R2_AIMED_AT, color="0.4", ls=":", lw=1)
    axes.set(xscale="log", xlabel="training realizations", ylabel="$R^2$ on test realizations")
    axes.set_ylim(max(0.0, float(data["R2"].min()) - 0.05), 1.0)
    axes.legend(title="components", loc="upper left", bbox_to_anchor=(1.0, 1.03))
    return figure


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
