"""Figure 2: realizations that a network needs for R² = 0.77, over the number of components.

Each point is where measured learning curves (Figure S11) cross R² = 0.77: the geometric mean over
seeds, bars from the smallest to the largest; an arrow where the longest curve stays below. Straight
lines on logarithmic axes are power laws: the fits to these points, and the paper's; dotted is the
exponential that fits the paper's network best. Drawn from what `landscape study learning_curves`
and `landscape study learning_curves_residual` have measured: the paper's network by its recipe, and
a residual one from mirrored, compressed data.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from command import Request, figure_script
from disorder_landscape.claims.claim import paper_value
from disorder_landscape.runs import REPOSITORY
from disorder_landscape.studies.crossings import (
    PowerLaw,
    fit_power_law,
    learning_curves,
    realizations_needed,
)
from disorder_landscape.studies.trainings_table import read_table
from plotting import COLUMN, INPUT, PREDICTION, inches

RESULTS = REPOSITORY / "results"
TABLES = {
    "paper's network": RESULTS / "learning_curves.csv",
    "residual network": RESULTS / "learning_curves_residual.csv",
}
COLOURS = dict(zip(TABLES, ("k", INPUT), strict=True))


def data(request: Request) -> xr.Dataset:
    """Return network, components, seed and realizations of each crossing; fits by network (fit).

    And of curves that do not cross network, components and largest realizations (bound).
    """
    parts = zip(*map(_measured, TABLES), strict=True)
    dims = ("crossing", "fit", "bound")
    merged: xr.Dataset = xr.merge(
        [xr.concat(part, dim) for part, dim in zip(parts, dims, strict=True)]
    )
    return merged


def _measured(network: str) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """Return the crossings of a network's curves, what is fitted to them, and where none is."""
    curves = learning_curves(read_table(TABLES[network]))
    rows = [
        (curve.components, seed, crossing)
        for curve in curves
        for seed, crossing in zip(curve.seeds, curve.crossings(), strict=True)
        if np.isfinite(curve.crossings()).all()
    ]
    components, seeds, realizations = zip(*rows, strict=True)
    attrs = {"units": "1", "long_name": "training realizations for R2 = 0.77"}
    crossings = xr.Dataset(
        {
            "network": ("crossing", [network] * len(rows)),
            "components": ("crossing", list(components)),
            "seed": ("crossing", list(seeds)),
            "realizations": ("crossing", list(realizations), attrs),
        }
    )
    n, needed = realizations_needed(curves)
    power, exponential = fit_power_law(n, needed), fit_power_law(np.exp(n), needed)
    fits = {
        "fitted_network": network,
        "prefactor": power.prefactor,
        "exponent": power.exponent,
        "fit_R2": power.R2,
        "exponential_prefactor": exponential.prefactor,
        "exponential_rate": exponential.exponent,
        "exponential_fit_R2": exponential.R2,
    }
    below = [curve for curve in curves if not np.isfinite(curve.crossings()).all()]
    bounds = {
        "bound_network": [network] * len(below),
        "bound_components": [curve.components for curve in below],
        "at_least": [curve.realizations[-1] for curve in below],
    }
    return (
        crossings,
        xr.Dataset({name: ("fit", [value]) for name, value in fits.items()}),
        xr.Dataset({name: ("bound", values) for name, values in bounds.items()}),
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(COLUMN, 3.3))
    axes = inches(figure, 0.62, 0.42, COLUMN - 0.72, 2.78)
    n = np.unique(np.concatenate([data["components"], data["bound_components"]])).astype(int)
    x = np.geomspace(0.9 * n[0], 1.1 * n[-1], 50)
    papers = PowerLaw(*(paper_value(f"fig2-{name}") for name in ("prefactor", "exponent", "fit")))
    axes.plot(x, papers(x), "--", color=PREDICTION, lw=1, label=_formula("paper", papers))
    for fit in range(data.sizes["fit"]):
        _draw_network(axes, data, data.isel(fit=fit), x)
    for network, count, least in zip(
        *(data[name].values for name in ("bound_network", "bound_components", "at_least")),
        strict=True,
    ):
        axes.errorbar(
            count, least, least, lolims=True, fmt="o", color=COLOURS[network], ms=3, lw=0.8, mfc="w"
        )
    deciding = data.isel(fit=0)
    y = deciding["exponential_prefactor"].item() * np.exp(deciding["exponential_rate"].item() * x)
    axes.plot(x, y, ":", color="0.4", lw=1, label=_exponential(deciding))
    axes.set(xscale="log", yscale="log", xlabel="disorder components $n$")
    axes.set_ylabel("training realizations for $R^2 = 0.77$")
    axes.set_xticks(n, [f"{value}" for value in n])
    axes.minorticks_off()
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.35)  # room for the legend
    axes.legend(loc="upper left")
    return figure


def _draw_network(axes: Axes, data: xr.Dataset, fit: xr.Dataset, x: np.ndarray) -> None:
    network = str(fit["fitted_network"].item())
    law = PowerLaw(*(fit[name].item() for name in ("prefactor", "exponent", "fit_R2")))
    of_network = data.isel(crossing=np.flatnonzero(data["network"] == network))
    by_components = of_network["realizations"].groupby(of_network["components"])
    mean = np.exp(by_components.map(lambda crossings: np.log(crossings).mean()))
    bars = np.array([mean - by_components.min(), by_components.max() - mean])
    colour = COLOURS[network]
    axes.plot(x, law(x), "-", color=colour, lw=1, label=_formula(network, law))
    axes.errorbar(
        mean["components"], mean, bars, fmt="o", color=colour, ms=3, lw=0.8, capsize=2
    )  # fmt: skip


def _exponential(fit: xr.Dataset) -> str:
    rate, R2 = fit["exponential_rate"].item(), fit["exponential_fit_R2"].item()
    return rf"exponential: $e^{{{rate:.2f}\,n}}$, $R^2 = {R2:.4f}$"


def _formula(name: str, law: PowerLaw) -> str:
    return rf"{name}: ${law.prefactor:.3g}\,n^{{{law.exponent:.2f}}}$, $R^2 = {law.R2:.4f}$"


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
