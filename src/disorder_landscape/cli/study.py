"""`landscape study`: many trainings that differ in a few settings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.cli.options import Build, Workers, resumable
from disorder_landscape.parts import needs


@needs("learning")
def study(
    plan: Annotated[Path, typer.Argument(help="TOML file of the study, in configs/studies.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder of the table.")] = Path(
        "results"
    ),
    build: Build = Path("build"),
    workers: Workers = 2,
) -> None:
    """Carry a study out: every training that its table lacks; an interrupted one goes on.

    The table is results/<name of the study>.csv, one row per training.

    Example: landscape study configs/studies/learning_curves.toml
    """
    from disorder_landscape.studies.plan import load_study
    from disorder_landscape.studies.runner import run_study

    planned = load_study(plan)
    table = output / f"{planned.name}.csv"
    with resumable():
        run_study(planned, table, build, workers)
    print(f"wrote {table}: {len(planned.runs)} trainings")
