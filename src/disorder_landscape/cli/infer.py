"""`landscape infer`: the disorder that explains a measurement, or each of many."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from disorder_landscape.arguments import require
from disorder_landscape.cli.executors import (
    DryRun,
    ExecutorName,
    Scheduler,
    SiteFile,
    Where,
    check_options_of,
    executor_of,
    on_slurm,
)
from disorder_landscape.cli.options import (
    ShareOfTasks,
    Workers,
    check_outputs,
    made_here,
    refuse,
    resumable,
    wrote,
)
from disorder_landscape.executors.executor import Executor, parse_share
from disorder_landscape.inference.defaults import SAMPLES
from disorder_landscape.parts import needs

if TYPE_CHECKING:
    from disorder_landscape.inference.file import Task
    from disorder_landscape.inference.settings import Settings


@needs("inference")
def infer(
    context: typer.Context,
    measurements: Annotated[
        list[Path],
        typer.Argument(metavar="measurement...", help="netCDF files with G_LL ... G_RL."),
    ],
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", help="netCDF file; of several measurements, a folder of them."
        ),
    ],
    prior: Annotated[
        Path | None,
        typer.Option(help="TOML file of what is known of the device; else the model's dataset."),
    ] = None,
    model: Annotated[
        Path | None, typer.Option(help="Folder of a trained model, whose network guesses.")
    ] = None,
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
        int,
        typer.Option(min=2, help="Samples of the posterior that are written, an even number."),
    ] = SAMPLES,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the ensembles.")] = 0,
    discrepancy: Annotated[
        bool,
        typer.Option(
            "--discrepancy",
            help="Allow for errors beside the noise, where the noise does not explain the misfit.",
        ),
    ] = False,
    plot: Annotated[
        Path | None,
        typer.Option(help="Picture or page (.html) of the result; of several, a folder."),
    ] = None,
    workers: Workers = 2,
    share: ShareOfTasks = "1/1",
    executor: ExecutorName = Where.LOCAL,
    site: SiteFile = None,
    dry_run: DryRun = False,
    scheduler: Scheduler = None,
) -> None:
    """Find the disorder that explains a measurement, with error bars and a verdict.

    The prior says what is unknown besides the disorder: alpha = [6.4, 9.6] in its file, say, or
    temperature = {mean = 0.05, std = 0.01}. The network's guess is refined with the exact
    simulation, by ensembles of wires; so is the prior, without a model, with --from-prior or where
    a guess has led astray. Some conductances may be missing or NaN. Interrupted, the same command
    goes on (through OUTPUT.unfinished.json).

    Several measurements, with a folder as OUTPUT, are shared out among the workers or jobs; what is
    in the folder is not repeated.

    Example: landscape infer wire.nc --model data_small/models/five_components_and_alpha_noisy
    --noise 0.01 -o inferred.nc --plot inferred.png

    Example: landscape infer device.nc --prior configs/priors/device.toml --noise 0.005 -o found.nc
    """
    from disorder_landscape.inference.file import Task
    from disorder_landscape.inference.folder import tasks_of_folder
    from disorder_landscape.inference.problem.noise import parse_noise
    from disorder_landscape.inference.settings import Settings

    check_options_of(context, executor)
    errors = None if noise is None else parse_noise(noise)
    settings = Settings(prior, model, errors, from_prior, samples, seed, discrepancy, made_here())
    is_file = len(measurements) == 1 and output.suffix and not output.is_dir()
    fits = len(measurements) == 1 or output.suffix != ".nc"
    require(fits, "output", "name a folder, for several measurements", f"it is '{output}'")
    if is_file:
        alone = executor is Where.LOCAL and parse_share(share).is_whole
        must = "be a folder, where jobs, other machines or a share of the tasks are asked for"
        require(alone, "output", must, f"it is '{output}'")
        refuse(context, ["workers"], "for one measurement, which takes all cores")
        _infer_alone(settings, Task(measurements[0], output, plot))
        return
    with resumable():
        tasks = tasks_of_folder(measurements, output, plot, settings)
        if executor is Where.SLURM:
            command = _command(tasks, output, plot, noise, settings)
            missing = partial(_count_missing, tasks)
            on_slurm(command, site, missing, output / "jobs", dry_run)
            if dry_run:
                return
        chosen = parse_share(share).of(tasks)
        _infer_each(settings, chosen, executor_of(executor, workers, scheduler))


def _infer_alone(settings: Settings, task: Task) -> None:
    """Find what explains one measurement, on all cores, and print what was found."""
    from disorder_landscape.dataset.store import read_dataset
    from disorder_landscape.files import check_writable
    from disorder_landscape.inference.file import infer_file
    from disorder_landscape.inference.given import network_given, observation_of
    from disorder_landscape.inference.landscape_hint import landscape_hint
    from disorder_landscape.inference.noise_hints import noise_hint
    from disorder_landscape.inference.plot import PAGE
    from disorder_landscape.inference.problem.noise import stated_noise
    from disorder_landscape.inference.progress import announce_inference, inference_progress
    from disorder_landscape.inference.report import summary
    from disorder_landscape.learning.model import existing_folder, load_model_config
    from disorder_landscape.model.parameters import NOISE_FLOOR

    output, plot = task.output, task.plot
    check_outputs(output, plot, [task.measurement], [PAGE])
    check_writable("output", task.unfinished)
    measured = read_dataset(task.measurement)
    errors = stated_noise(measured.attrs) if settings.noise is None else settings.noise
    prior, network = settings.prior_and_network()
    observation = observation_of(measured, prior, errors)
    network_given(observation, prior, network)
    if settings.noise is None and "noise" not in measured.attrs:
        print(f"No noise is stated: {NOISE_FLOOR:g} e²/h is taken (--noise says another).")
    if settings.model is not None and not settings.from_prior:
        training = load_model_config(existing_folder(settings.model)).training
        if hint := noise_hint(training, errors):
            print(hint)
    if hint := landscape_hint(observation):
        print(hint)
    announce_inference(observation)
    with resumable(), inference_progress() as progress:
        result = infer_file(settings, task, progress)
    print("\n".join(summary(result)))
    print(wrote(output, plot))


def _infer_each(settings: Settings, tasks: Sequence[Task], executor: Executor) -> None:
    """Find what explains each of many measurements that has no result yet.

    Raises
    ------
    Exit
        With status 1 if there is no result for some.
    """
    from tqdm import tqdm

    from disorder_landscape.estimates import Pace
    from disorder_landscape.inference.folder import infer_one_of_many

    missing = [task for task in tasks if not task.is_done]
    outcomes = []
    bar = tqdm(total=len(tasks), initial=len(tasks) - len(missing), desc="infer", unit=" files")
    at_a_time = min(executor.at_a_time, max(len(missing), 1))
    pace = Pace("infer", len(missing), bar.write, warm_up=0, at_a_time=at_a_time)
    with bar:
        infer_one = partial(infer_one_of_many, settings)
        for outcome in executor.each_result(infer_one, missing, may_be_ended=True):
            outcomes.append(outcome)
            bar.write(f"{outcome.task.measurement}: {outcome.verdict or outcome.error}")
            bar.update()
            pace.step()
    failed = sum(outcome.error != "" for outcome in outcomes)
    drawn = sum(not outcome.is_new for outcome in outcomes)
    verdicts = Counter(one.verdict for one in outcomes if one.is_new and not one.error)
    new = ", ".join(f"{n} {verdict}" for verdict, n in verdicts.most_common())
    there = len(tasks) - failed
    said = [f"{there} result{' is' if there == 1 else 's are'} there"]
    said += ([f"new: {new}"] if new else []) + ([f"only drawn: {drawn}"] if drawn else [])
    print("; ".join(said))
    if failed:
        print(f"without a result: {failed}; the errors are above", file=sys.stderr)
        raise typer.Exit(1)


def _count_missing(tasks: Sequence[Task]) -> int:
    return sum(not task.is_done for task in tasks)


def _command(
    tasks: Sequence[Task], output: Path, plot: Path | None, noise: str | None, settings: Settings
) -> list[str]:
    """Return the command by which a job does its share of the same."""
    options: dict[str, object] = {
        "--output": output.resolve(),
        "--samples": settings.samples,
        "--seed": settings.seed,
    }
    for name, path in {"prior": settings.prior, "model": settings.model, "plot": plot}.items():
        if path is not None:
            options[f"--{name}"] = path.resolve()
    if noise is not None:
        options["--noise"] = noise
    words = [str(word) for option in options.items() for word in option]
    files = [str(task.measurement.resolve()) for task in tasks]
    switches = {"--from-prior": settings.from_prior, "--discrepancy": settings.discrepancy}
    return ["infer", *files, *words, *(name for name, is_on in switches.items() if is_on)]
