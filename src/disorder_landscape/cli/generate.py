"""`landscape generate`: the dataset of a run."""

from __future__ import annotations

from pathlib import Path

from disorder_landscape.cli.options import Build, ConfigFile, ShareOfTasks, Workers, resumable
from disorder_landscape.executors.executor import parse_share
from disorder_landscape.executors.local import LocalProcesses


def generate(
    config: ConfigFile,
    build: Build = Path("build"),
    workers: Workers = 2,
    share: ShareOfTasks = "1/1",
) -> None:
    """Make the dataset of a run; called again it makes what is missing.

    Example: landscape generate --config configs/small.toml --workers 2
    """
    from disorder_landscape import chain

    taken = parse_share(share)
    with resumable():
        chain.generate(chain.open_run(config, build), LocalProcesses(workers), taken)
