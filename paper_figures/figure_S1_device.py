"""Figure S1: sketch of the device.

A semiconductor wire under a grounded superconductor, its ends connected through tunnel barriers to
a left and a right lead. The drawing is not to scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from command import Request, figure_script
from disorder_landscape import Nanowire
from disorder_landscape.model.parameters import SITES
from plotting import FULL_WIDTH, INPUT, PREDICTION, inches
from solids import DEPTH, draw_box

SEMICONDUCTOR, SUPERCONDUCTOR, LEAD, BARRIER = "#9CC3E6", "#C4C4C4", "#E9C46A", "#7A5C80"
CURRENT, FIELD = PREDICTION, INPUT
HEIGHT = 2.55
"""Of the figure, in inches; all that follows is in inches from its lower left corner."""
LEFT, BOTTOM, RIGHT, TOP = 1.93, 1.0, 4.83, 1.35
"""Front of the semiconductor."""
SUPERCONDUCTOR_HEIGHT, LEAD_LENGTH, BARRIER_LENGTH, WIDTH = 0.26, 0.6, 0.12, 0.85
"""WIDTH is how far everything reaches backwards."""
GROUND = 0.36
ARROW = {
    "arrowstyle": "-|>,head_width=0.18,head_length=0.35",
    "color": "k",
    "lw": 0.8,
    "shrinkA": 0,
    "shrinkB": 0,
}


def data(request: Request) -> xr.Dataset:
    """Return the length in µm and the barriers in meV that the sketch states."""
    wire = Nanowire(np.zeros(SITES))
    return xr.Dataset(
        {
            "length": ((), wire.length, {"units": "um", "long_name": "length of the wire"}),
            "barrier": ("lead", list(wire.barrier), {"units": "meV", "long_name": "barriers"}),
        },
        coords={"lead": ["L", "R"]},
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(FULL_WIDTH, HEIGHT))
    axes = inches(figure, 0, 0, FULL_WIDTH, HEIGHT)
    axes.set(xlim=(0, FULL_WIDTH), ylim=(0, HEIGHT))
    axes.axis("off")
    _draw_solids(axes)
    _draw_lengths(axes, data)
    middle = BOTTOM + (TOP - BOTTOM) / 2
    behind = DEPTH[0] * WIDTH / 2, DEPTH[1] * WIDTH / 2
    outer = BARRIER_LENGTH + LEAD_LENGTH
    _draw_circuit(axes, "L", LEFT - outer, middle, -1)
    _draw_circuit(axes, "R", RIGHT + outer + behind[0], middle + behind[1], 1, covered=behind[0])
    _draw_superconductor_ground(axes)
    _draw_directions(axes)
    return figure


def _draw_solids(axes: Axes) -> None:
    """Draw from left to right, so that each box covers the hidden side of the one before."""
    height, top = TOP - BOTTOM, SUPERCONDUCTOR_HEIGHT
    inner, outer = BARRIER_LENGTH, BARRIER_LENGTH + LEAD_LENGTH
    draw_box(axes, (LEFT - outer, BOTTOM), (LEAD_LENGTH, height, WIDTH), LEAD)
    draw_box(axes, (LEFT - inner, BOTTOM), (BARRIER_LENGTH, height, WIDTH), BARRIER)
    draw_box(axes, (LEFT, BOTTOM), (RIGHT - LEFT, height, WIDTH), SEMICONDUCTOR)
    draw_box(axes, (RIGHT, BOTTOM), (BARRIER_LENGTH, height, WIDTH), BARRIER)
    draw_box(axes, (RIGHT + inner, BOTTOM), (LEAD_LENGTH, height, WIDTH), LEAD)
    draw_box(axes, (LEFT, TOP), (RIGHT - LEFT, top, WIDTH), SUPERCONDUCTOR)
    text: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 5}
    axes.text((LEFT + RIGHT) / 2, (BOTTOM + TOP) / 2, "semiconductor", **text)
    axes.text((LEFT + RIGHT) / 2, TOP + top / 2, "superconductor", **text)
    for x in (LEFT - inner - LEAD_LENGTH / 2, RIGHT + inner + LEAD_LENGTH / 2):
        axes.text(x, (BOTTOM + TOP) / 2, "lead", **text)


def _draw_lengths(axes: Axes, data: xr.Dataset) -> None:
    """Draw the wire's length, and name the barriers."""
    ruler = BOTTOM - 0.2
    axes.annotate("", (LEFT, ruler), (RIGHT, ruler), arrowprops=ARROW | {"arrowstyle": "<|-|>"})
    length = rf"$L$ = {float(data['length']):g} µm"
    box = {"facecolor": "w", "edgecolor": "none", "pad": 1.5}
    middle = (LEFT + RIGHT) / 2
    axes.text(middle, ruler, length, ha="center", va="center", bbox=box)
    for i, lead in enumerate("LR"):
        line = ",  ".join(_definition(lead, other) for other in "LR")
        axes.text(middle, GROUND - 0.01 - 0.19 * i, line, ha="center", va="center")
    for side, x, ha in (
        ("L", LEFT - BARRIER_LENGTH / 2, "right"),
        ("R", RIGHT + BARRIER_LENGTH / 2, "left"),
    ):
        barrier = float(data["barrier"].sel(lead=side))
        name = rf"$V_\mathrm{{Barrier}}^\mathrm{{{side}}}$ = {barrier:g} meV"
        shift = -0.06 if side == "L" else 0.06
        axes.plot([x, x], [BOTTOM, ruler - 0.16], color="k", lw=0.6)
        axes.text(x + shift, ruler - 0.12, name, ha=ha, va="center", fontsize=8)


def _definition(lead: str, other: str) -> str:
    """Return how a conductance is defined (caption of Fig. S1)."""
    sign = "" if lead == other else "-"
    I, V = rf"dI_\mathrm{{{lead}}}", rf"dV_\mathrm{{{other}}}"
    return rf"$G_\mathrm{{{lead}{other}}} = {sign}{I}/{V}$"


def _draw_circuit(
    axes: Axes, side: str, x: float, y: float, outward: int, covered: float = 0.0
) -> None:
    """Draw current, voltage source and ground of a lead from its end at (x, y).

    The first part of the wire, of the length covered, lies before the lead.
    """
    source, radius = x + outward * (0.8 + covered), 0.17
    axes.plot([x, source, source], [y, y, GROUND], color="k", lw=0.8, zorder=3)
    middle = (y + GROUND) / 2 + 0.02
    axes.plot(source, middle, "o", ms=144 * radius, mfc="w", mec="k", mew=0.8, zorder=4)
    axes.text(
        source, middle, rf"$V_\mathrm{{{side}}}$", ha="center", va="center_baseline", zorder=5
    )
    _draw_ground(axes, source, GROUND)
    start, stop = x + outward * (0.6 + covered), x + outward * (0.2 + covered)
    axes.annotate(
        "", (stop, y), (start, y), arrowprops=ARROW | {"lw": 1.8, "color": CURRENT}, zorder=4
    )
    name = rf"$I_\mathrm{{{side}}}$"
    axes.text((start + stop) / 2, y + 0.08, name, ha="center", va="bottom", color=CURRENT)


def _draw_superconductor_ground(axes: Axes) -> None:
    """Connect the top of the superconductor to the ground."""
    x, end = RIGHT - 0.1, RIGHT + 1.0
    y = TOP + SUPERCONDUCTOR_HEIGHT + DEPTH[1] * WIDTH / 2
    up = y + 0.32
    axes.plot([x, x, end, end], [y, up, up, up - 0.12], color="k", lw=0.8, zorder=4)
    axes.plot(x, y, "ko", ms=2.5, zorder=4)
    _draw_ground(axes, end, up - 0.12)


def _draw_ground(axes: Axes, x: float, y: float) -> None:
    for i, half in enumerate((0.1, 0.065, 0.03)):
        axes.plot([x - half, x + half], [y - 0.035 * i] * 2, color="k", lw=0.9, zorder=4)


def _draw_directions(axes: Axes) -> None:
    """Draw the field and the coordinates."""
    y = TOP + SUPERCONDUCTOR_HEIGHT + DEPTH[1] * WIDTH + 0.22
    start, stop = LEFT + 0.95, LEFT + 1.85
    axes.annotate("", (stop, y), (start, y), arrowprops=ARROW | {"lw": 1.8, "color": FIELD})
    axes.text(stop + 0.08, y, "$B$", color=FIELD, ha="left", va="center")
    x, y = 0.3, HEIGHT - 0.62
    for name, tip, ha, va in (
        ("$x$", (0.42, 0.0), "left", "center"),
        ("$y$", (0.62 * DEPTH[0], 0.62 * DEPTH[1]), "left", "bottom"),
        ("$z$", (0.0, 0.42), "center", "bottom"),
    ):
        end = (x + tip[0], y + tip[1])
        axes.annotate("", end, (x, y), arrowprops=ARROW)
        axes.text(end[0] + (0.03 if ha == "left" else 0.0), end[1] + 0.01, name, ha=ha, va=va)


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
