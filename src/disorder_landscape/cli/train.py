"""`landscape train`: the network of a run."""

from __future__ import annotations

from pathlib import Path

from disorder_landscape.cli.options import Build, ConfigFile, resumable
from disorder_landscape.parts import needs


@needs("learning")
def train(config: ConfigFile, build: Build = Path("build")) -> None:
    """Train the network of a run; an interrupted training goes on where it was.

    Example: landscape train --config configs/small.toml
    """
    from disorder_landscape import chain, runs

    with resumable():
        chain.train(runs.open_run(config, build))
