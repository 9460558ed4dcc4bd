"""`landscape generate`: the dataset of a run."""

from __future__ import annotations

from pathlib import Path

from disorder_landscape.cli.options import Build, ConfigFile, Workers, resumable


def generate(config: ConfigFile, build: Build = Path("build"), workers: Workers = 2) -> None:
    """Make the dataset of a run; called again it makes what is missing.

    Example: landscape generate --config configs/small.toml --workers 2
    """
    from disorder_landscape import chain

    with resumable():
        chain.generate(chain.open_run(config, build), workers)
