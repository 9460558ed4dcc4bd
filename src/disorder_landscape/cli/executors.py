"""The options of the commands that may run elsewhere, and what they mean."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.cli.options import refuse
from disorder_landscape.executors.executor import Executor
from disorder_landscape.executors.local import LocalProcesses


class Where(StrEnum):
    """Where tasks are carried out."""

    LOCAL = "local"
    SLURM = "slurm"
    DASK = "dask"


ExecutorName = Annotated[
    Where,
    typer.Option(
        "--executor",
        help="Processes of this machine, jobs of Slurm (--site) or a Dask cluster (--scheduler).",
    ),
]
SiteFile = Annotated[
    Path | None, typer.Option("--site", help="TOML file with a site's settings for Slurm.")
]
DryRun = Annotated[
    bool, typer.Option("--dry-run", help="Print the scripts for sbatch, and submit nothing.")
]
Scheduler = Annotated[
    str | None, typer.Option("--scheduler", help="Address of a Dask scheduler, tcp://HOST:8786.")
]


def check_options_of(context: typer.Context, where: Where) -> None:
    """Refuse options that would be without effect with an executor.

    Raises
    ------
    ArgumentError
        If there are any.
    """
    if where is Where.SLURM:
        refuse(context, ["workers", "share", "limit"], "with --executor slurm")
    else:
        refuse(context, ["site", "dry_run"], "without --executor slurm")
    if where is not Where.DASK:
        refuse(context, ["scheduler"], "without --executor dask")


def executor_of(where: Where, workers: int, scheduler: str | None) -> Executor:
    """Return the executor of a command's options; of Slurm's jobs nothing is left to be done.

    Raises
    ------
    ArgumentError
        If the address of the Dask scheduler is missing, or nobody answers there.
    """
    if where is not Where.DASK:
        return LocalProcesses(workers)
    if scheduler is None:
        raise ArgumentError("scheduler", "be given with --executor dask", "it is missing")
    from disorder_landscape.executors.dask_cluster import DaskCluster

    cluster = DaskCluster(scheduler)
    cluster.require_answer()  # before anything is made
    return cluster


def on_slurm(
    command: Sequence[str],
    site_file: Path | None,
    missing: Callable[[], int],
    folder: Path,
    dry_run: bool,
) -> None:
    """Let jobs of Slurm do what is missing, or print their scripts.

    Raises
    ------
    ArgumentError
        As `slurm.run`, or if the site's file is missing or wrong.
    """
    from disorder_landscape.executors import slurm
    from disorder_landscape.executors.site import load_site

    if site_file is None:
        raise ArgumentError("site", "be given with --executor slurm", "it is missing")
    site = load_site(site_file)
    if dry_run:
        jobs = min(site.jobs, max(missing(), 1))
        print("\n".join(slurm.scripts(command, site, jobs, folder)), end="")
    else:
        slurm.run(command, site, missing, folder)
