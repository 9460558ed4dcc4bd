"""`landscape predict`: a trained network's guess from a measurement."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.cli.options import check_outputs, made_here, wrote
from disorder_landscape.parts import needs


@needs("learning")
def predict(
    measurement: Annotated[Path, typer.Argument(help="netCDF file with G_LL ... G_RL.")],
    model: Annotated[Path, typer.Option(help="Folder of a trained model.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="netCDF file.")],
) -> None:
    """Let a trained network guess disorder and alpha from conductances on its grid.

    The shipped model's grid is that of: landscape simulate --mu 0:0.6:15 --B 0:0.8:15
    --bias -0.04,-0.02,0,0.02,0.04 -o wire.nc

    Example: landscape predict wire.nc --model data_small/models/five_components_and_alpha -o Y.nc
    """
    from disorder_landscape.dataset.store import read_dataset, write_dataset
    from disorder_landscape.learning.prediction import predict as predict_labels
    from disorder_landscape.model.quantities import CONDUCTANCES

    check_outputs(output, read=[measurement])
    Y = predict_labels(model, read_dataset(measurement, CONDUCTANCES)[list(CONDUCTANCES)])
    write_dataset(Y, output, made_here())
    print(wrote(output))
