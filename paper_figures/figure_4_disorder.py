"""Figure 4: disorder of test wires and of their predictions, in components and in real space.

The realizations of Figure 3. (a) Components of the discrete cosine transform. (b) Potential with
boundary effects: on the first and last site the barriers reach far beyond the axis.
"""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from command import Request, figure_script
from disorder_panels import HEIGHT, disorder_data, draw_disorder
from plotting import FULL_WIDTH
from wires import drawn_realizations


def data(request: Request) -> xr.Dataset:
    """Return components and potential of input and prediction, as `disorder_data`."""
    chosen = drawn_realizations(request.evaluation(), request.config)
    return disorder_data(chosen, request.config.dataset.wire)


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(FULL_WIDTH, HEIGHT))
    draw_disorder(figure, data)
    return figure


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
