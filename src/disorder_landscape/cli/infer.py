"""`landscape infer`: the disorder that explains a measurement."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.arguments import require
from disorder_landscape.cli.options import made_here, resumable
from disorder_landscape.parts import needs


@needs("inference")
def infer(
    measurement: Annotated[Path, typer.Argument(help="netCDF file with G_LL ... G_RL.")],
    model: Annotated[Path, typer.Option(help="Folder of a trained model.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="netCDF file.")],
    noise: Annotated[
        str | None,
        typer.Option(
            help="Error of the measured G in e^2/h, 0 to 1: one number, or LL,RR,LR,RL. By default "
            "the file's attribute noise, or 0.001."
        ),
    ] = None,
    from_prior: Annotated[
        bool, typer.Option("--from-prior", help="Without the network's guess, on any grid.")
    ] = False,
    samples: Annotated[
        int, typer.Option(help="Samples of the posterior that are written, an even number.")
    ] = 64,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the ensembles.")] = 0,
    plot: Annotated[Path | None, typer.Option(help="Picture of the result.")] = None,
) -> None:
    """Find the disorder that explains a measurement, with error bars and a verdict.

    The network's guess is refined with the exact simulation, by ensembles of wires; so is the
    disorder model's prior, with --from-prior or where a guess has led astray. Some conductances may
    be missing or NaN. Interrupted, the same command goes on (through OUTPUT.unfinished.json).

    Example: landscape infer wire.nc --model data_small/models/five_components_and_alpha_noisy
    --noise 0.01 -o inferred.nc --plot inferred.png
    """
    from disorder_landscape.dataset.store import read_dataset, write_dataset
    from disorder_landscape.files import check_netcdf, check_writable
    from disorder_landscape.inference.infer import infer as find
    from disorder_landscape.inference.infer import observation_of
    from disorder_landscape.inference.plot import plot_inference
    from disorder_landscape.inference.problem.measurement import measurement_of
    from disorder_landscape.inference.problem.observation import stated_noise
    from disorder_landscape.inference.progress import announce_inference, inference_progress
    from disorder_landscape.inference.report import noise_hint, parse_noise, summary
    from disorder_landscape.learning.model import load_model_config
    from disorder_landscape.simulation import check_plot

    check_netcdf("output", output)
    same = output.resolve() == measurement.resolve()
    require(not same, "output", "be another file than the measurement", f"both are '{output}'")
    if plot is not None:
        check_plot(plot)
        check_writable("plot", plot)
    measured = read_dataset(measurement)
    errors = stated_noise(measured.attrs) if noise is None else parse_noise(noise)
    config = load_model_config(model)
    hint = "" if from_prior else noise_hint(config.training, errors)
    if hint:
        print(hint, file=sys.stderr)
    announce_inference(observation_of(measured, config.dataset, errors))
    unfinished = output.with_name(f"{output.name}.unfinished.json")
    with resumable(), inference_progress() as progress:
        result = find(
            measured, model, errors, not from_prior, samples, seed, None, unfinished, progress
        )
    write_dataset(result, output, made_here(), may_lack=["misfit"])  # of channels without data
    if plot is not None:
        usual = {name: result.attrs[name] for name in ("theta", "barrier", "temperature")}
        plot_inference(result, measurement_of(measured, usual, complete=False), plot)
    unfinished.unlink(missing_ok=True)
    print("\n".join(summary(result)))
    print(f"wrote {output}" + (f" and {plot}" if plot else ""))
