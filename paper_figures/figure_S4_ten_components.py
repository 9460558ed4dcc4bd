"""Figure S4: four test wires of ten disorder components, and what the network says they are.

(a) Components of the discrete cosine transform. (b) Potential with boundary effects: on the first
and last site the barriers reach far beyond the axis. (c-f) Conductance over bias and field at
μ = 0: input wire above, below the one with the predicted disorder; α = 8 meV nm is fixed and known.
"""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

import figure_3_conductance_bias as figure_3
from command import Request, figure_script
from conductance_maps import blocks_height, draw_conductance_blocks
from disorder_landscape.runs import TEN
from disorder_panels import HEIGHT, disorder_data, draw_disorder
from plotting import FULL_WIDTH
from wires import drawn_realizations


def data(request: Request) -> xr.Dataset:
    """Return what Figures 4 and 3 show, of this figure's wires."""
    chosen = drawn_realizations(request.evaluation(), request.config)
    disorder = disorder_data(chosen, request.config.dataset.wire)
    conductances = figure_3.data(request).drop_vars("alpha")
    return disorder.assign(conductances.data_vars)


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    count = data.sizes["realization"]
    blocks = blocks_height(count, "bias")
    figure = Figure(figsize=(FULL_WIDTH, blocks + HEIGHT))
    draw_disorder(figure, data, bottom=blocks)
    draw_conductance_blocks(figure, data, "bias", [chr(ord("c") + i) for i in range(count)])
    return figure


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments, model=TEN)


if __name__ == "__main__":
    main()
