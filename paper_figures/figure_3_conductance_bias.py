"""Figure 3: conductance over bias and field at μ = 0, of test wires and of their predictions.

For each realization the upper row is the conductance matrix of the input wire, the lower row the
one simulated with the disorder and the spin-orbit coupling that the network predicts.
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

MU = 0.0
"""In meV."""


def data(request: Request) -> xr.Dataset:
    """Return G_LL … G_RL (realization, row, B, bias) in e²/h and alpha (realization, row)."""
    config, figures = request.config, request.config.figures
    B = np.linspace(0.0, config.dataset.B_max, figures.B_points)
    bias = np.linspace(-figures.bias_max, figures.bias_max, figures.bias_points)

    def simulate(wire: Nanowire) -> xr.Dataset:
        G = conductance(
            wire,
            MU,
            B,
            bias,
            temperature=config.dataset.temperature,
        )
        return G[list(CONDUCTANCES)].isel(mu=0)

    chosen = drawn_realizations(request.evaluation(), config)
    return simulate_rows(chosen, config.dataset.wire, simulate)


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(FULL_WIDTH, blocks_height(data.sizes["realization"], "bias")))
    draw_conductance_blocks(figure, data, "bias")
    return figure


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
