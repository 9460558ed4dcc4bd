"""Figure 5: spin-orbit coupling of test wires, as drawn and as predicted.

(a) Representative test samples: input in blue, prediction in orange. (b) All test samples,
prediction over input; Δα is the standard deviation of the error.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from command import Request, figure_script
from disorder_landscape.arguments import require
from plotting import COLUMN, INPUT, PREDICTION, inches, write

LABEL = r"$\alpha$ [meV nm]"


def data(request: Request) -> xr.Dataset:
    """Return alpha and alpha_predicted of all test samples, and which of them (a) shows.

    Returns
    -------
    xarray.Dataset
        alpha and alpha_predicted (realization) in meV nm, shown (realization); delta_alpha in
        meV nm as attribute.
    """
    evaluation = request.evaluation()
    shown = np.arange(evaluation.sizes["realization"]) < request.config.figures.alpha_samples
    there = "delta_alpha" in evaluation.attrs
    require(there, "preset", "have α as a label, for Figure 5", "α is fixed in it")
    alphas = evaluation[["alpha", "alpha_predicted"]].assign(shown=("realization", shown))
    alphas.attrs = {"delta_alpha": evaluation.attrs["delta_alpha"]}
    return alphas


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(COLUMN, 4.6))
    samples = inches(figure, 0.42, 2.98, COLUMN - 0.5, 1.4)
    scatter = inches(figure, 0.42, 0.38, COLUMN - 0.5, 2.1)
    true, predicted = data["alpha"].to_numpy(), data["alpha_predicted"].to_numpy()
    shown = data["shown"].to_numpy()
    limits = (min(*true, *predicted) - 0.2, max(*true, *predicted) + 0.2)

    number = np.arange(1, shown.sum() + 1)
    samples.vlines(number, true[shown], predicted[shown], color="0.7", lw=0.8, zorder=1)
    samples.plot(number, true[shown], "o", color=INPUT, ms=3.2, label="input")
    samples.plot(
        number, predicted[shown], "D", color=PREDICTION, mfc="none", ms=3, label="prediction"
    )
    samples.set(xlabel="test sample", ylabel=LABEL, xlim=(0, number[-1] + 1), ylim=limits)
    samples.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.0)

    scatter.plot(limits, limits, color="0.5", lw=0.8)
    scatter.plot(true, predicted, ".", color="k", ms=2.5, alpha=0.5, mew=0)
    scatter.set(xlabel=f"input {LABEL}", ylabel=f"predicted {LABEL}", xlim=limits, ylim=limits)
    scatter.set_aspect("equal")
    scatter.xaxis.set_major_locator(MaxNLocator(4))
    scatter.yaxis.set_major_locator(MaxNLocator(4))
    note = (
        rf"$\Delta\alpha = {data.attrs['delta_alpha']:.3f}$ meV nm" + f"\n{true.size} test samples"
    )
    scatter.text(0.05, 0.95, note, transform=scatter.transAxes, va="top", linespacing=1.2)
    write(figure, 0.04, figure.get_figheight() - 0.05, "(a)")
    write(figure, 0.04, 2.6, "(b)")
    return figure


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
