"""Figure S13: what test wires look like inside, and the wires that the network predicts.

The realizations of Figure S7 at the point that is marked in the maps: the local density of states
with the leads attached, and both Majorana components of the lowest level without them; the level of
the input, then of the prediction. Not in the paper, whose abstract promises the wave functions.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from command import Request, figure_script
from disorder_landscape import Nanowire, local_density_of_states, modes, topological_visibility
from disorder_landscape.model.disorder import positions
from disorder_landscape.symbols import T_IV_COLOURS, T_IV_SYMBOL, axis_label
from plotting import (
    FULL_WIDTH,
    INPUT,
    PREDICTION,
    colour_bar,
    draw_map,
    inches,
)
from wires import ROWS, drawn_realizations, letters, simulate_rows

LEFT, RIGHT, BOTTOM, TOP, GAP = 0.6, 0.62, 0.4, 0.22, 0.12
"""In inches."""
HEIGHTS, ROW_GAPS = (0.9, 1.0, 1.0, 0.9), (0.42, 0.08, 0.08)
"""Of the rows of panels from above, and between them."""
MU, FIELD = 0.1, 0.6
"""The marked point, in meV and T."""
ENERGIES = np.linspace(-0.1, 0.1, 201)
"""In meV."""
WITHIN = 0.995
"""Share of the densities of states that the colour scale covers: single peaks hide the rest."""


def data(request: Request) -> xr.Dataset:
    """Return T_IV, LDOS and |γ|² of each realization's input and prediction."""
    config, figures = request.config, request.config.figures
    mu = np.linspace(0.0, config.dataset.mu_max, figures.mu_points)
    B = np.linspace(0.0, config.dataset.B_max, figures.B_points)

    def simulate(wire: Nanowire) -> xr.Dataset:
        density = local_density_of_states(
            wire, MU, FIELD, ENERGIES, temperature=config.dataset.temperature
        )
        found = modes(wire, MU, FIELD)
        visibility = topological_visibility(wire, mu, B).sel(lead="L", drop=True)
        weights = {name: (abs(found[f"majorana_{name}"]) ** 2).sum("nambu") for name in ("A", "B")}
        return xr.Dataset(
            {
                "T_IV": visibility.variable,
                "LDOS": (density.LDOS_electron + density.LDOS_hole).isel(mu=0, B=0).variable,
                "E_1": found.level[0].variable,
                **{f"gamma_{name}": weight.variable for name, weight in weights.items()},
            },
            coords={"mu": mu, "B": B, "energy": ENERGIES},
        )

    chosen = drawn_realizations(request.evaluation(), config)
    simulated = simulate_rows(chosen, config.dataset.wire, simulate)
    return simulated.assign_attrs(lattice=Nanowire.lattice)


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    columns = data.sizes["realization"]
    width = (FULL_WIDTH - LEFT - RIGHT - (columns - 1) * GAP) / columns
    height = BOTTOM + TOP + sum(HEIGHTS) + sum(ROW_GAPS)
    figure = Figure(figsize=(FULL_WIDTH, height))
    bottoms = height - TOP - np.cumsum(HEIGHTS) - np.cumsum((0, *ROW_GAPS))
    panels = np.array(
        [
            [inches(figure, LEFT + i * (width + GAP), bottom, width, tall) for i in range(columns)]
            for bottom, tall in zip(bottoms, HEIGHTS, strict=True)
        ],
        dtype=object,
    )
    x = positions(data.sizes["site"], data.attrs["lattice"])
    norms = Normalize(-1.0, 1.0), Normalize(0.0, float(data["LDOS"].quantile(WITHIN).round(1)))
    highest = 1.05 * float(max(data["gamma_A"].max(), data["gamma_B"].max()))
    for i, letter in enumerate(letters(data)):
        above, *middle, below = panels[:, i]
        draw_map(above, data["T_IV"][i, 0], "mu", norms[0], T_IV_COLOURS)
        above.plot(FIELD, MU, "kx", ms=5, mew=1.2)
        above.set_title(f"({letter})", loc="left")
        above.set_xlabel(axis_label("B"), labelpad=1)
        for row, axes in enumerate(middle):
            axes.pcolormesh(
                x,
                1e3 * data["energy"],
                data["LDOS"][i, row],
                norm=norms[1],
                cmap="magma",
                shading="nearest",
                rasterized=True,
            )
            axes.tick_params(labelbottom=False)
            axes.set_yticks([-80, 0, 80], ["−80", "0", "80"])
        for row, (colour, line) in enumerate(((INPUT, "-"), (PREDICTION, "--"))):
            for name in ("gamma_A", "gamma_B"):
                label = ROWS[row] if name == "gamma_A" else None
                below.plot(x, data[name][i, row], color=colour, ls=line, lw=0.8, label=label)
        energies = ", ".join(f"{1e3 * float(E):.2g}" for E in data["E_1"][i])
        below.text(
            0.5, 0.97, rf"$E_1$ = {energies} µeV", transform=below.transAxes, ha="center", va="top"
        )
        below.set_ylim(0, highest)
        below.set_xlim(x[0], x[-1])
        below.set_xticks([0, 1, 2], ["0", "1", "2"])
        below.set_xlabel("position [µm]")
        for axes in panels[:, i] if i else ():
            axes.tick_params(labelleft=False)
    panels[3, 0].legend(loc="upper center", bbox_to_anchor=(0.5, 0.86), frameon=False)
    panels[0, 0].set_ylabel(axis_label("mu"))
    for name, axes in zip(ROWS, panels[1:3, 0], strict=True):
        axes.set_ylabel(rf"$\it{{{name}}}$" + "\nenergy [µeV]", linespacing=1.1)
    panels[3, 0].set_ylabel(r"$|\gamma_{A,B}|^2$")
    at = FULL_WIDTH - RIGHT + 0.1
    bar = colour_bar(
        figure, (at, bottoms[0], 0.09, HEIGHTS[0]), norms[0], T_IV_COLOURS, data["T_IV"]
    )
    bar.set_label(T_IV_SYMBOL, labelpad=-2)
    tall = bottoms[1] + HEIGHTS[1] - bottoms[2]
    bar = colour_bar(figure, (at, bottoms[2], 0.09, tall), norms[1], "magma", data["LDOS"])
    bar.set_label("LDOS [1/meV per site]")
    return figure


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
