"""Figure 2: realizations that the network needs for R² = 0.77, over the number of components.

Each point is where measured learning curves (Figure S11) cross R² = 0.77: the geometric mean over
seeds, bars from the smallest to the largest. Straight lines on logarithmic axes: the fit to these
points, and the paper's. Drawn from results/learning_curves.csv, which
`landscape study learning_curves` measures.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from command import Request, figure_script
from disorder_landscape.chain import REPOSITORY
from disorder_landscape.claims.claim import paper_value
from disorder_landscape.studies.crossings import (
    PowerLaw,
    fit_power_law,
    learning_curves,
    realizations_needed,
)
from disorder_landscape.studies.trainings_table import read_table
from plotting import COLUMN, INPUT, PREDICTION, inches

TABLE = REPOSITORY / "results" / "learning_curves.csv"


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
    n, needed = realizations_needed(curves)
    fit = fit_power_law(n, needed)
    attrs = {"units": "1", "long_name": "training realizations for R2 = 0.77"}
    return xr.Dataset(
        {
            "realizations": (("components", "seed"), crossings, attrs),
            "needed": ("components", needed, attrs | {"note": "geometric mean over seeds"}),
        },
        coords={"components": n.astype(int)},
        attrs={"prefactor": fit.prefactor, "exponent": fit.exponent, "fit_R2": fit.R2},
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(COLUMN, 2.9))
    axes = inches(figure, 0.62, 0.42, COLUMN - 0.72, 2.38)
    n = data["components"].to_numpy()
    crossings = data["realizations"].to_numpy()
    mean = data["needed"].to_numpy()
    bars = [mean - np.nanmin(crossings, axis=1), np.nanmax(crossings, axis=1) - mean]
    x = np.geomspace(0.9 * n[0], 1.1 * n[-1], 50)
    ours = PowerLaw(*(data.attrs[name] for name in ("prefactor", "exponent", "fit_R2")))
    for law, name, style, colour in (
        (_papers_law(), "paper", "--", PREDICTION),
        (ours, "fit", "-", INPUT),
    ):
        axes.plot(x, law(x), style, color=colour, lw=1, label=_formula(name, law))
    axes.errorbar(n, mean, bars, fmt="o", color="k", ms=3.5, lw=0.8, capsize=2, label="measured")
    axes.set(xscale="log", yscale="log", xlabel="disorder components $n$")
    axes.set_ylabel("training realizations for $R^2 = 0.77$")
    axes.set_xticks(n, [f"{value}" for value in n])
    axes.minorticks_off()
    axes.legend(loc="upper left")
    note = rf"fit: $R^2 = {ours.R2:.4f}$"
    axes.text(0.97, 0.05, note, transform=axes.transAxes, ha="right")
    return figure


def _papers_law() -> PowerLaw:
    return PowerLaw(*(paper_value(f"fig2-{name}") for name in ("prefactor", "exponent", "fit")))


def _formula(name: str, law: PowerLaw) -> str:
    return rf"{name}: ${law.prefactor:.3g}\,n^{{{law.exponent:.2f}}}$"


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
