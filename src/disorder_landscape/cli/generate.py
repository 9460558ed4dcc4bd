"""`landscape generate`: the dataset of a run."""

from __future__ import annotations

from pathlib import Path

import typer

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
from disorder_landscape.cli.options import Build, ConfigFile, ShareOfTasks, Workers, resumable
from disorder_landscape.executors.executor import parse_share


def generate(
    context: typer.Context,
    config: ConfigFile,
    build: Build = Path("build"),
    workers: Workers = 2,
    share: ShareOfTasks = "1/1",
    executor: ExecutorName = Where.LOCAL,
    site: SiteFile = None,
    dry_run: DryRun = False,
    scheduler: Scheduler = None,
) -> None:
    """Make the dataset of a run; called again it makes what is missing.

    Example: landscape generate --config configs/small.toml --workers 2
    """
    from disorder_landscape import chain, runs
    from disorder_landscape.dataset.shards import missing_shards

    check_options_of(context, executor)
    run, taken = runs.open_run(config, build), parse_share(share)
    with resumable():
        if executor is Where.SLURM:

            def missing() -> int:
                return len(missing_shards(run.config.dataset, run.dataset_folder))

            options = ["--config", str(config.resolve()), "--build", str(build.resolve())]
            on_slurm(["generate", *options], site, missing, chain.jobs_folder(run), dry_run)
            if dry_run:
                return
        chain.generate(run, executor_of(executor, workers, scheduler), taken)
