"""`landscape study`: many trainings, inversions or checks that differ in a few settings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.arguments import ArgumentError, require
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
from disorder_landscape.cli.options import Build, ShareOfTasks, Workers, refuse, resumable
from disorder_landscape.executors.executor import parse_share
from disorder_landscape.executors.slurm import jobs_folder
from disorder_landscape.parts import needs


@needs("learning")
def study(
    context: typer.Context,
    plan: Annotated[
        str | None, typer.Argument(help="Name of a plan in configs/studies, or a TOML file.")
    ] = None,
    listed: Annotated[
        bool, typer.Option("--list", help="Print the studies, and how far each has come.")
    ] = False,
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder of the tables.")] = Path(
        "results"
    ),
    build: Build = Path("build"),
    workers: Workers = 2,
    limit: Annotated[
        int | None, typer.Option(min=0, help="So many of the missing tasks only.")
    ] = None,
    share: ShareOfTasks = "1/1",
    executor: ExecutorName = Where.LOCAL,
    site: SiteFile = None,
    dry_run: DryRun = False,
    scheduler: Scheduler = None,
) -> None:
    """Carry out what the table of a study lacks; an interrupted study goes on.

    The table is results/<name of the study>.csv; what follows from it is beside it. The exit status
    is 1 where the study checks bounds and one fails.

    Example: landscape study learning_curves
    """
    from disorder_landscape.studies.plan import load_study
    from disorder_landscape.studies.runner import carry_out
    from disorder_landscape.studies.study import PLANS, Place, study_names

    must = "be carried out in a clone of the repository, which has the plans"
    require(PLANS.is_dir(), "study", must, "this installation has none")
    if listed:
        executors = ("executor", "site", "dry_run", "scheduler")
        refuse(context, ["plan", "workers", "limit", "share", *executors], "with --list")
    check_options_of(context, executor)
    place = Place(output, build, executor_of(executor, workers, scheduler), parse_share(share))
    if listed:
        for name in study_names():
            one = load_study(name)
            done = len(one.tasks) - len(one.missing(place))
            print(f"{name:16}  {done:5} of {len(one.tasks):5}  {one.plan.title}")
        return
    if plan is None:
        raise ArgumentError("study", "be the name of a study", "none is given; --list prints all")
    chosen = load_study(plan)
    before = len(chosen.missing(place))
    with resumable():
        if executor is Where.SLURM:
            options = ["--output", str(output.resolve()), "--build", str(build.resolve())]
            named = str(Path(plan).resolve()) if plan.endswith(".toml") else plan
            command = ["study", named, *options]
            jobs = jobs_folder(build, f"study-{chosen.name}")
            on_slurm(command, site, lambda: len(chosen.missing(place)), jobs, dry_run)
            if dry_run:
                return
        derived = carry_out(chosen, place, limit)
    left = len(chosen.missing(place))
    for line in derived.lines:
        print(line)
    said = f"{before - left} added, {left} missing" if before else "nothing was missing"
    there = len(place.share.of(chosen.tasks)) - left
    print(f"{chosen.table_of_share(place)}: {there} tasks, {said}")
    if not derived.passed:
        raise typer.Exit(1)
