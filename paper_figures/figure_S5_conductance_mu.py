"""Figure S5: conductance over μ and field at zero bias, of test wires and of their predictions.

The same realizations and rows as in Figure 3. Maps of this kind are what the network sees.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from command import Request, figure_script
from conductance_maps import blocks_height, draw_conductance_blocks
from disorder_landscape import Nanowire, conductance
from disorder_landscape.model.quantities import CONDUCTANCES
from plotting import FULL_WIDTH
from wires import drawn_realizations, simulate_rows

BIAS = 0.0
"""In meV."""


def data(request: Request) -> xr.Dataset:
    """Return G_LL … G_RL (realization, row, mu, B) in e²/h and alpha (realization, row)."""
    config, figures = request.config, request.config.figures
    mu = np.linspace(0.0, config.dataset.mu_max, figures.mu_points)
    B = np.linspace(0.0, config.dataset.B_max, figures.B_points)

    def simulate(wire: Nanowire) -> xr.Dataset:
        G = conductance(
            wire,
            mu,
            B,
            BIAS,
            temperature=config.dataset.temperature,
        )
        return G[list(CONDUCTANCES)].isel(bias=0)

    chosen = drawn_realizations(request.evaluation(), config)
    return simulate_rows(chosen, config.dataset.wire, simulate)


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(FULL_WIDTH, blocks_height(data.sizes["realization"], "mu")))
    draw_conductance_blocks(figure, data, "mu")
    return figure


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
