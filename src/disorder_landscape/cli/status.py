"""`landscape status`: how much of a run is there."""

from __future__ import annotations

from pathlib import Path

from disorder_landscape.cli.options import Build, ConfigFile


def status(config: ConfigFile, build: Build = Path("build")) -> None:
    """How much of a run is there.

    Example: landscape status --config configs/small.toml
    """
    from disorder_landscape import chain, runs
    from disorder_landscape.dataset import shards
    from disorder_landscape.executors.slurm import said_of_jobs

    run = runs.open_run(config, build)
    now = shards.status(run.config.dataset, run.dataset_folder)
    print(
        f"dataset     {now.realizations} of {now.realizations_in_all} realizations in "
        f"{now.shards} of {now.shards_in_all} shards, {now.bytes / 1e6:.1f} MB"
    )
    if now.largest_error is not None:
        print(f"accuracy    estimated errors of up to {now.largest_error:.2g} e²/h")
    jobs = said_of_jobs(chain.jobs_folder(run))
    if jobs:
        print(f"jobs        {jobs}")
    begun = run.model_folder.exists()
    print(f"model       {'trained' if run.is_trained else 'begun' if begun else 'not begun'}")
    print(f"evaluation  {'there' if run.evaluation_file.exists() else 'not there'}")
