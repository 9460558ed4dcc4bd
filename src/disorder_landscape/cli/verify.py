"""`landscape verify`: measurements against the predicted wire."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.cli.options import check_outputs, made_here, wrote
from disorder_landscape.cli.texts import parse_grid
from disorder_landscape.inference.defaults import CONTROLS, SHIFTS
from disorder_landscape.parts import needs


@needs("inference")
def verify(
    prediction: Annotated[
        Path, typer.Argument(help="netCDF file of `landscape predict` or `landscape infer`.")
    ],
    measurements: Annotated[
        list[Path],
        typer.Argument(help="netCDF files with G_LL ... G_RL at settings the network never saw."),
    ],
    model: Annotated[
        Path | None,
        typer.Option(help="Folder of the model that predicted: its disorder is the control."),
    ] = None,
    noise: Annotated[
        str | None,
        typer.Option(
            help="Error of the measured G in e^2/h, one number or one for each channel; by "
            "default the one that each measurement states, or none."
        ),
    ] = None,
    controls: Annotated[
        int, typer.Option(help="Wires with wrong disorder, 19 or more.")
    ] = CONTROLS,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the wrong disorder.")] = 0,
    shifts: Annotated[
        str, typer.Option(help="Shifts of V in meV to try, as of a gate's offset.")
    ] = f"{SHIFTS[0]:g}:{SHIFTS[-1]:g}:{SHIFTS.size}",
    output: Annotated[Path | None, typer.Option("--output", "-o", help="netCDF file.")] = None,
) -> None:
    """Compare measurements with the predicted wire, and with wires of wrong disorder.

    A measurement states theta (radians), barrier (left and right, meV) and temperature (K) as
    attributes, as landscape simulate writes them. It may have any grid of mu, B and bias: landscape
    simulate --seed 1 --mu 0.1,0.3 --B 0.2:0.8:7 --bias -0.03,0.01 --theta 30 --barrier 15,12 -o
    other.nc

    Example: landscape verify Y.nc other.nc --model data_small/models/five_components_and_alpha
    """
    from disorder_landscape.dataset.store import read_dataset, write_dataset
    from disorder_landscape.estimates import settings_bar
    from disorder_landscape.inference.problem.noise import parse_noise
    from disorder_landscape.inference.verification.comparison import OF_CHANNELS, table
    from disorder_landscape.inference.verify import verify as compare
    from disorder_landscape.learning.model import load_model_config

    if output is not None:
        check_outputs(output, read=(prediction, *measurements))
    config = None if model is None else load_model_config(model).dataset
    predicted = read_dataset(prediction, ("potential",))
    measured = [read_dataset(path) for path in measurements]
    tried = parse_grid("shifts", shifts)
    errors = None if noise is None else parse_noise(noise)
    with settings_bar("verify") as progress:
        result = compare(predicted, measured, errors, controls, seed, config, tried, progress)
    result = result.assign_coords(measurement=[str(path) for path in measurements])
    if output is not None:
        write_dataset(result, output, made_here(), may_lack=["p_samples", *OF_CHANNELS])
    print("\n".join(table(result)))
    if output is not None:
        print(wrote(output))
