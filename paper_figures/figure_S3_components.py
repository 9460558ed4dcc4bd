"""Figure S3: disorder components that a fidelity F asks for, over correlation and wire length.

Wires of (a) 2 µm, (b) 3 µm, (c) 4 µm. F is the normalised inner product of the disorder potential
and of its truncation, averaged over random potentials; the three numbers that the paper states are
ringed.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from command import Request, figure_script
from disorder_landscape.model.disorder import fidelity_by_components
from plotting import FULL_WIDTH, inches, write

SITES = (200, 300, 400)
"""Wires of 2, 3 and 4 µm."""
CORRELATION_LENGTHS = (1, 2, 3, 4, 5, 6, 7)
"""ℓ in sites, up to where the kernel is cut: beyond, the cut and not ℓ sets the smoothness."""
FIDELITIES = (0.8, 0.9, 0.95, 0.97, 0.99)
STATED = ((3, 0.95, 6), (7, 0.95, -4), (7, 0.97, 4))
"""ℓ and F of which S-II.3 states the number, at 3 µm; how far its label is shifted, in points."""
LEFT, RIGHT, BOTTOM, TOP, GAP, HEIGHT = 0.52, 0.06, 0.4, 0.24, 0.12, 2.1


def data(request: Request) -> xr.Dataset:
    """Return components (sites, correlation_length, fidelity), the numbers required.

    The request says nothing that matters here: no network is involved.
    """
    required = np.array(
        [
            [
                np.searchsorted(fidelity_by_components(length, sites), FIDELITIES) + 1
                for length in CORRELATION_LENGTHS
            ]
            for sites in SITES
        ]
    )
    dims = ("sites", "correlation_length", "fidelity")
    attrs = {"long_name": "components required", "units": "1"}
    return xr.Dataset(
        {"components": (dims, required, attrs)},
        coords={
            "sites": list(SITES),
            "correlation_length": list(CORRELATION_LENGTHS),
            "fidelity": list(FIDELITIES),
        },
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    count = data.sizes["sites"]
    width = (FULL_WIDTH - LEFT - RIGHT - (count - 1) * GAP) / count
    figure = Figure(figsize=(FULL_WIDTH, BOTTOM + HEIGHT + TOP))
    for i, sites in enumerate(data["sites"].to_numpy()):
        axes = inches(figure, LEFT + i * (width + GAP), BOTTOM, width, HEIGHT)
        _draw_length(axes, data.sel(sites=sites), sites == 300)
        axes.set(xlim=(0.6, 8.2), yscale="log", ylim=(9, 400), yticks=[10, 20, 50, 100, 200])
        axes.yaxis.set_major_formatter("{x:g}")
        axes.minorticks_off()
        if i > 0:
            axes.tick_params(labelleft=False)
        write(
            figure,
            LEFT + i * (width + GAP),
            BOTTOM + HEIGHT + 0.19,
            f"({chr(ord('a') + i)})  {sites / 100:g} µm",
        )
    figure.axes[0].set_ylabel("components required")
    figure.axes[-1].legend(title="fidelity $F$", loc="upper right", reverse=True)
    return figure


def _draw_length(axes: Axes, data: xr.Dataset, mark: bool) -> None:
    """Draw the curves of one length of wire."""
    length = data["correlation_length"].to_numpy()
    colours = colormaps["viridis"](np.linspace(0.0, 0.85, data.sizes["fidelity"]))
    for colour, fidelity in zip(colours, data["fidelity"].to_numpy(), strict=True):
        curve = data["components"].sel(fidelity=fidelity).to_numpy()
        axes.plot(length, curve, "o-", color=colour, ms=3, lw=1, label=f"{fidelity:g}")
    if mark:
        for stated_length, fidelity, shift in STATED:
            n = int(data["components"].sel(correlation_length=stated_length, fidelity=fidelity))
            axes.plot(stated_length, n, "o", mfc="none", mec="#D55E00", ms=6, mew=1.2)
            axes.annotate(
                f"{n}", (stated_length, n), (6, shift), textcoords="offset points", va="center",
                color="#D55E00",
            )  # fmt: skip
    axes.set_xlabel(r"correlation length $\ell$ [sites]")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
