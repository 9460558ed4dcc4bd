"""Figure S12: from the network's guess to the disorder, and how much the data say of it.

(a) How far the potentials are off, root mean square over the sites, for fresh wires of both models
over the errors of the conductances: the network's guesses, the inversions that start from them, and
the inversions' own error bars (medians). Circles: answers that their verdict does not accept.
(b) The error bar of V that the conductances allow, by their derivatives at the true wire, over the
number of disorder components, for noise of 0.01 e²/h and several grids of µ × B × V_bias (medians
over wires): the data fix all components that are drawn, and more data fix them better. Drawn from
results/inversions.csv and results/uniqueness.csv, which `make inversion-study` measures. The paper
has neither.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from command import Request, figure_script
from disorder_landscape.claims.study_tables import INVERSIONS, UNIQUENESS
from disorder_landscape.inference.verdict import CONVERGED
from disorder_landscape.runs import FIVE, TEN
from plotting import FULL_WIDTH, INPUT, PREDICTION, inches

NAMES = {FIVE: "5 components and α", TEN: "10 components"}
GUESS, ANSWER, BAR = "network_error", "site_error", "spread"
NOISE = 0.01
"""Of (b), in e²/h."""
SETTING = ["components", "points", "biases"]
GRIDS = {(10, 5): "C0", (20, 5): "C1", (20, 21): "C2", (40, 21): "C3"}
"""Points of µ and of B, biases; and the colours."""
SHIFT = 0.18
"""Of guesses and answers to either side."""
HEIGHT, TOP, BOTTOM, LEFT, GAP, RIGHT = 2.2, 0.25, 0.45, 0.6, 0.12, 0.1
"""In inches."""


def data(request: Request) -> xr.Dataset:
    """Return errors (inversion) and allowed error bars (setting) in µeV."""
    table = pd.read_csv(INVERSIONS)
    model = table["model"].map(list(NAMES).index)
    allowed = pd.read_csv(UNIQUENESS)
    allowed = allowed[allowed["noise"] == NOISE].groupby(SETTING, as_index=False)["spread"].median()
    return xr.Dataset(
        {
            "model": ("inversion", model, {"note": ", ".join(NAMES)}),
            "noise": ("inversion", table["noise"], {"units": "e^2/h"}),
            **{
                name: ("inversion", 1e3 * table[name], {"units": "ueV"})
                for name in (GUESS, ANSWER, BAR)
            },
            "accepted": ("inversion", (table["verdict"] == CONVERGED).astype(int)),
            **{name: ("setting", allowed[name]) for name in SETTING},
            "allowed": ("setting", 1e3 * allowed["spread"], {"units": "ueV"}),
        }
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(FULL_WIDTH, TOP + HEIGHT + BOTTOM))
    width = (FULL_WIDTH - 2 * LEFT - GAP - RIGHT) / 3
    panels = [inches(figure, LEFT + i * (width + GAP), BOTTOM, width, HEIGHT) for i in range(2)]
    for model, (axes, name) in enumerate(zip(panels, NAMES.values(), strict=True)):
        _errors(axes, data.isel(inversion=(data["model"] == model).to_numpy()))
        axes.set_title(f"{'' if model else '(a) '}{name}")
    panels[0].set_ylabel("error of $V$ [µeV]")
    panels[1].tick_params(labelleft=False)
    panels[0].legend(loc="lower right", handletextpad=0.3)
    last = inches(figure, FULL_WIDTH - width - RIGHT, BOTTOM, width, HEIGHT)
    _allowed(last, data)
    return figure


def _errors(axes: Axes, errors: xr.Dataset) -> None:
    """Draw the errors of one model's wires, a column for each noise."""
    shown = np.unique(errors["noise"])
    rng = np.random.default_rng(0)
    of_noise = [errors.isel(inversion=(errors["noise"] == noise).to_numpy()) for noise in shown]
    for column, some in enumerate(of_noise):
        jitter = column + rng.uniform(-0.1, 0.1, some.sizes["inversion"])
        refused = (some["accepted"] == 0).to_numpy()
        for name, shift, colour, label in (
            (GUESS, -SHIFT, PREDICTION, "network"),
            (ANSWER, SHIFT, INPUT, "inversion"),
        ):
            once = None if column else label
            axes.plot(jitter + shift, some[name], ".", ms=2.2, mew=0, color=colour, label=once)
        circles = jitter[refused] + SHIFT, some[ANSWER][refused]
        axes.plot(*circles, "o", ms=4, mew=0.6, mfc="none", color="k")
        if shown[column] > 0:  # without errors of measurement it is the simulation's accuracy
            bar = [np.median(some[BAR])] * 2
            once = "own error bar" if column == 1 else None
            axes.plot(column + np.array([0.02, 0.34]), bar, "k-", lw=1, label=once)
    axes.set(yscale="log", ylim=(5e-7, 1e3), xlim=(-0.5, len(shown) - 0.5))
    axes.set_xticks(range(len(shown)), [f"{noise:g}" for noise in shown])
    axes.set_xlabel(r"noise [$e^2/h$]")


def _allowed(axes: Axes, data: xr.Dataset) -> None:
    """Draw the error bars that the data allow."""
    for (points, biases), colour in GRIDS.items():
        there = ((data["points"] == points) & (data["biases"] == biases)).to_numpy()
        label = rf"{points}$\times${points}$\times${biases}"
        n, bar = (data[name].to_numpy()[there] for name in ("components", "allowed"))
        axes.plot(n, bar, "o-", ms=3, lw=1, color=colour, label=label)
    axes.set(xscale="log", yscale="log", ylim=(0.2, 900), xlabel="disorder components $n$")
    axes.set_ylabel("allowed error bar of $V$ [µeV]")
    every = np.unique(data["components"])
    axes.set_xticks(every, [f"{n}" for n in every])
    axes.minorticks_off()
    axes.set_title(rf"(b) noise {NOISE:g} $e^2/h$")
    axes.legend(loc="upper left", title=r"$\mu \times B \times V_\mathrm{bias}$")


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
