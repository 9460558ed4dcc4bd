"""Figure 2: realizations that the network needs for R² = 0.77, over the number of components.

Each point is where measured learning curves (Figure S11) cross R² = 0.77: the geometric mean over
seeds, bars from the smallest to the largest. Straight lines on logarithmic axes: the fit to these
points, and the paper's. Drawn from claims/learning_curves.csv, which
`landscape study configs/studies/learning_curves.toml` measures.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from command import Request, figure_script
from disorder_landscape.chain import REPOSITORY
from disorder_landscape.studies.crossings import fit_power_law, learning_curves
from disorder_landscape.studies.table import read_table
from plotting import COLUMN, INPUT, PREDICTION, inches

TABLE = REPOSITORY / "claims" / "learning_curves.csv"
PAPER = (0.0672, 4.9232)
"""Prefactor and exponent of the paper's fit."""


def data(request: Request) -> xr.Dataset:
    """Return realizations (components, seed) at the crossings; the fit as attributes."""
    curves = [
        curve
        for curve in learning_curves(read_table(TABLE))
        if np.isfinite(curve.crossings()).all()
    ]
    seeds = max(len(curve.seeds) for curve in curves)
    crossings = np.full((len(curves), seeds), np.nan)
    for i, curve in enumerate(curves):
        crossings[i, : len(curve.seeds)] = curve.crossings()
    n = np.array([curve.components for curve in curves], dtype=float)
    fit = fit_power_law(n, _geometric_mean(crossings))
    attrs = {"units": "1", "long_name": "training realizations for R2 = 0.77"}
    return xr.Dataset(
        {"realizations": (("components", "seed"), crossings, attrs)},
        coords={"components": n.astype(int)},
        attrs={"prefactor": fit.prefactor, "exponent": fit.exponent, "fit_R2": fit.R2},
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(COLUMN, 2.9))
    axes = inches(figure, 0.62, 0.42, COLUMN - 0.72, 2.38)
    n = data["components"].to_numpy()
    crossings = data["realizations"].to_numpy()
    mean = _geometric_mean(crossings)
    bars = [mean - np.nanmin(crossings, axis=1), np.nanmax(crossings, axis=1) - mean]
    x = np.geomspace(0.9 * n[0], 1.1 * n[-1], 50)
    ours = (data.attrs["prefactor"], data.attrs["exponent"])
    axes.plot(
        x, PAPER[0] * x ** PAPER[1], "--", color=PREDICTION, lw=1, label=_law("paper", *PAPER)
    )
    axes.plot(x, ours[0] * x ** ours[1], "-", color=INPUT, lw=1, label=_law("fit", *ours))
    axes.errorbar(n, mean, bars, fmt="o", color="k", ms=3.5, lw=0.8, capsize=2, label="measured")
    axes.set(xscale="log", yscale="log", xlabel="disorder components $n$")
    axes.set_ylabel("training realizations for $R^2 = 0.77$")
    axes.set_xticks(n, [f"{value}" for value in n])
    axes.minorticks_off()
    axes.legend(loc="upper left")
    note = rf"fit: $R^2 = {data.attrs['fit_R2']:.4f}$"
    axes.text(0.97, 0.05, note, transform=axes.transAxes, ha="right")
    return figure


def _geometric_mean(crossings: np.ndarray) -> np.ndarray:
    return np.asarray(np.exp(np.nanmean(np.log(crossings), axis=1)))


def _law(name: str, prefactor: float, exponent: float) -> str:
    return rf"{name}: ${prefactor:.3g}\,n^{{{exponent:.2f}}}$"


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
