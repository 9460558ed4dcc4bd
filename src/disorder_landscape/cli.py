"""The command line: thin; each command reads its options and calls the library."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.arguments import ArgumentError, number_in, require
from disorder_landscape.parts import MissingPartError, needs

app = typer.Typer(
    help="Simulate disordered Majorana nanowires, and read their disorder off their conductance.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)

ConfigFile = Annotated[Path, typer.Option("--config", "-c", help="TOML file of the run.")]
Build = Annotated[Path, typer.Option(help="Folder of the results, one subfolder per run.")]
Workers = Annotated[int, typer.Option(min=1, max=1024, help="Processes, one thread each.")]


def main() -> None:
    """Run the command line; bad input, or a missing part, is one sentence and exit code 2."""
    try:
        app()
    except (ArgumentError, MissingPartError) as error:
        print(f"landscape: {error}", file=sys.stderr)
        sys.exit(2)


@contextmanager
def resumable() -> Iterator[None]:
    """Tell whoever presses Ctrl-C how to go on."""
    try:
        yield
    except KeyboardInterrupt:
        print("\nlandscape: interrupted; the same command goes on from here", file=sys.stderr)
        raise typer.Exit(130) from None


def made_here() -> dict[str, str]:
    """Return the provenance of what this command line makes."""
    from disorder_landscape.dataset.store import provenance

    return provenance(" ".join(["landscape", *sys.argv[1:]]))


@app.command()
def simulate(
    potential: Annotated[
        Path | None, typer.Option(help="V_dis per site in meV: .csv, .npy or .nc file.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Draw the potential with this seed instead.")
    ] = None,
    components: Annotated[
        int, typer.Option(help="Disorder components of a drawn potential; 0: pristine.")
    ] = 5,
    sites: Annotated[int, typer.Option(help="Sites of the wire, 10 nm each.")] = 300,
    alpha: Annotated[float, typer.Option(help="Spin-orbit coupling in meV nm.")] = 8.0,
    g: Annotated[float, typer.Option(help="Lande g-factor.")] = 25.0,
    gamma: Annotated[float, typer.Option(help="Coupling to the superconductor in meV.")] = 0.15,
    delta0: Annotated[float, typer.Option(help="Gap of the superconductor in meV.")] = 0.12,
    barrier: Annotated[
        str, typer.Option(help="Barrier on the end sites in meV: one number, or left,right.")
    ] = "15",
    temperature: Annotated[float, typer.Option(help="In K; 0 is the bare conductance.")] = 0.05,
    mu: Annotated[str, typer.Option(help="Chemical potentials in meV.")] = "0",
    B: Annotated[str, typer.Option("--B", help="Magnetic fields in T.")] = "0:0.8:81",
    theta: Annotated[
        float, typer.Option(help="Angle of the field relative to the wire in degrees.")
    ] = 0.0,
    bias: Annotated[str, typer.Option(help="Bias voltages in meV.")] = "-0.04:0.04:81",
    solver: Annotated[str, typer.Option(help="fast, or kwant (the reference).")] = "fast",
    output: Annotated[Path, typer.Option("--output", "-o", help="netCDF file.")] = Path("wire.nc"),
    plot: Annotated[Path | None, typer.Option(help="Picture of a quick look.")] = None,
) -> None:
    """Conductance matrix and topological visibility of one wire.

    Grids are numbers ("0.3"), lists ("0,0.1") or ranges ("start:stop:points").

    Example: landscape simulate --seed 1 --mu 0 --B 0:0.8:81 --bias -0.04:0.04:81 -o wire.nc
    --plot wire.png
    """
    import numpy as np
    from tqdm import tqdm

    from disorder_landscape import simulation
    from disorder_landscape.dataset.store import write_dataset
    from disorder_landscape.files import check_netcdf, check_writable
    from disorder_landscape.model.disorder import disorder_realization
    from disorder_landscape.model.parameters import Nanowire

    check_netcdf("output", output)
    if plot is not None:
        simulation.check_plot(plot)
        check_writable("plot", plot)
    both = "one of --potential and --seed at most"
    require(potential is None or seed is None, "potential", f"come with {both}", "both are given")
    require(sites >= 2, "sites", "be 2 or more", f"it is {sites}")
    must = f"be from 0 to {sites - 1}"
    require(0 <= components < sites, "components", must, f"it is {components}")
    if potential is not None:
        V = simulation.read_potential(potential, sites)
    elif seed is None or components == 0:
        V = np.zeros(sites)
    else:
        V = disorder_realization(np.random.default_rng(seed), components, sites)[1]
    barriers = simulation.parse_barrier(barrier)
    wire = Nanowire(V, alpha=alpha, g=g, gamma=gamma, delta0=delta0, barrier=barriers)
    angle = math.radians(number_in("theta", theta, -360.0, 360.0, "degrees"))
    grids = {
        name: simulation.parse_grid(name, text)
        for name, text in {"mu": mu, "B": B, "bias": bias}.items()
    }
    with tqdm(unit=" settings", delay=1, desc="simulate") as bar:

        def progress(done: int, in_all: int) -> None:
            bar.total = in_all
            bar.update(done)

        result = simulation.simulate_wire(wire, grids, temperature, solver, angle, progress)
    write_dataset(result, output, made_here())
    if plot is not None:
        simulation.plot_simulation(result, plot)
    print(f"wrote {output}" + (f" and {plot}" if plot else ""))


@app.command()
def generate(config: ConfigFile, build: Build = Path("build"), workers: Workers = 2) -> None:
    """Make the dataset of a run; called again it makes what is missing.

    Example: landscape generate --config configs/small.toml --workers 2
    """
    from disorder_landscape import chain

    with resumable():
        chain.generate(chain.open_run(config, build), workers)


@app.command()
def status(config: ConfigFile, build: Build = Path("build")) -> None:
    """How much of a run is there.

    Example: landscape status --config configs/small.toml
    """
    from disorder_landscape import chain
    from disorder_landscape.dataset import shards

    run = chain.open_run(config, build)
    now = shards.status(run.config.dataset, run.dataset_folder)
    print(
        f"dataset     {now.realizations} of {now.realizations_in_all} realizations in "
        f"{now.shards} of {now.shards_in_all} shards, {now.bytes / 1e6:.1f} MB"
    )
    begun = run.model_folder.exists()
    print(f"model       {'trained' if run.is_trained else 'begun' if begun else 'not begun'}")
    print(f"evaluation  {'there' if run.evaluation_file.exists() else 'not there'}")


@app.command()
@needs("learning")
def train(config: ConfigFile, build: Build = Path("build")) -> None:
    """Train the network of a run; an interrupted training goes on where it was.

    Example: landscape train --config configs/small.toml
    """
    from disorder_landscape import chain

    with resumable():
        chain.train(chain.open_run(config, build))


@app.command()
@needs("learning")
def evaluate(config: ConfigFile, build: Build = Path("build")) -> None:
    """Score the network of a run on its test realizations.

    Example: landscape evaluate --config configs/small.toml
    """
    from disorder_landscape import chain

    run = chain.open_run(config, build)
    scores = chain.evaluate(run).attrs
    print(f"R2 (standard-scaled)  {scores['R2']:.4f}")
    print(f"dV_dis(x_i)           {scores['delta_V']:.4f} meV")
    if "delta_alpha" in scores:
        print(f"d alpha               {scores['delta_alpha']:.4f} meV nm")
    if "delta_mean" in scores:
        print(f"d mean of V           {scores['delta_mean']:.4f} meV")
    for name, value in scores.items():
        if name.startswith("R2_"):
            print(f"R2 of {name.removeprefix('R2_'):8s}        {value:.4f}")
    print(f"wrote {run.evaluation_file}")


@app.command()
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
    from disorder_landscape.files import check_netcdf
    from disorder_landscape.learning.prediction import predict as predict_labels
    from disorder_landscape.model.quantities import CONDUCTANCES

    check_netcdf("output", output)
    same = output.resolve() == measurement.resolve()
    require(not same, "output", "be another file than the measurement", f"both are '{output}'")
    Y = predict_labels(model, read_dataset(measurement, CONDUCTANCES)[list(CONDUCTANCES)])
    write_dataset(Y, output, made_here())
    print(f"wrote {output}")


@app.command()
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
    seed: Annotated[int, typer.Option(min=0, help="Seed of all random numbers.")] = 0,
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
    from disorder_landscape.inference.plot import plot_inference
    from disorder_landscape.inference.problem.measurement import measurement_of
    from disorder_landscape.inference.problem.observation import stated_noise
    from disorder_landscape.inference.progress import inference_progress
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
    hint = "" if from_prior else noise_hint(load_model_config(model).training, errors)
    if hint:
        print(hint, file=sys.stderr)
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


@app.command()
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
    controls: Annotated[int, typer.Option(help="Wires with wrong disorder, 19 or more.")] = 50,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the wrong disorder.")] = 0,
    shifts: Annotated[
        str, typer.Option(help="Shifts of V in meV to try, as of a gate's offset.")
    ] = "-0.03:0.03:13",
    output: Annotated[Path | None, typer.Option("--output", "-o", help="netCDF file.")] = None,
) -> None:
    """Compare measurements with the predicted wire, and with wires of wrong disorder.

    A measurement states theta (radians), barrier (left and right, meV) and temperature (K) as
    attributes, as landscape simulate writes them. It may have any grid of mu, B and bias: landscape
    simulate --seed 1 --mu 0.1,0.3 --B 0.2:0.8:7 --bias -0.03,0.01 --theta 30 --barrier 15,12 -o
    other.nc

    Example: landscape verify Y.nc other.nc --model data_small/models/five_components_and_alpha
    """
    from tqdm import tqdm

    from disorder_landscape.dataset.store import read_dataset, write_dataset
    from disorder_landscape.files import check_netcdf
    from disorder_landscape.inference.report import parse_noise
    from disorder_landscape.inference.verification.comparison import table
    from disorder_landscape.inference.verify import verify as compare
    from disorder_landscape.learning.model import load_model_config
    from disorder_landscape.model.quantities import CONDUCTANCES
    from disorder_landscape.simulation import parse_grid

    if output is not None:
        check_netcdf("output", output)
        read = {path.resolve() for path in (prediction, *measurements)}
        must = "be another file than those that are read"
        require(output.resolve() not in read, "output", must, f"it is '{output}'")
    config = None if model is None else load_model_config(model).dataset
    predicted = read_dataset(prediction, ("potential", "alpha"))
    measured = [read_dataset(path, CONDUCTANCES) for path in measurements]
    tried = parse_grid("shifts", shifts)
    errors = None if noise is None else parse_noise(noise)
    with tqdm(unit=" settings", delay=1, desc="verify") as bar:

        def progress(done: int, in_all: int) -> None:
            bar.total = in_all
            bar.update(done)

        result = compare(predicted, measured, errors, controls, seed, config, tried, progress)
    result = result.assign_coords(measurement=[str(path) for path in measurements])
    if output is not None:
        write_dataset(result, output, made_here(), may_lack=["p_samples"])  # where they are few
    print("\n".join(table(result)))
    if output is not None:
        print(f"wrote {output}")


@app.command()
@needs("learning")
def study(
    plan: Annotated[Path, typer.Argument(help="TOML file of the study, in configs/studies.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder of the table.")] = Path(
        "claims"
    ),
    build: Build = Path("build"),
    workers: Workers = 2,
) -> None:
    """Carry a study out: every training that its table lacks; an interrupted one goes on.

    The table is claims/<name of the study>.csv, one row per training.

    Example: landscape study configs/studies/learning_curves.toml
    """
    from disorder_landscape.studies.plan import load_study
    from disorder_landscape.studies.runner import run_study

    planned = load_study(plan)
    table = output / f"{planned.name}.csv"
    with resumable():
        run_study(planned, table, build, workers)
    print(f"wrote {table}: {len(planned.runs)} trainings")


@app.command()
@needs("figures")
def bench(
    repeats: Annotated[int, typer.Option(min=1, help="Measurements, of which the median.")] = 5,
    output: Annotated[Path, typer.Option(help="Folder of the table and the plot.")] = Path(
        "build/bench"
    ),
) -> None:
    """Time the fast solver against Kwant at its best, in one run of a few minutes.

    Example: landscape bench --repeats 5 --output build/bench
    """
    from tqdm import tqdm

    from disorder_landscape.bench_report import report

    with tqdm(total=repeats + 1, unit=" turns", desc="bench") as bar:
        lines = report(repeats, output, bar.update)
    print("\n".join([*lines, f"wrote {output}/bench.txt, bench.json and bench.png"]))
