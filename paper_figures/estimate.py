"""How long `make figures` will take on this machine, said before it begins."""

from __future__ import annotations

import argparse
import sys

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.dataset import shards
from disorder_landscape.dataset.realizations import simulate
from disorder_landscape.estimates import announce_repeated
from disorder_landscape.machine import cores
from disorder_landscape.runs import MODELS, Run, preset_run
from disorder_landscape.solver import compiled

WORKERS = 2
TRAINING = 0.39
"""Seconds that a training takes, over those that one core would take to simulate its dataset, …"""
DRAWING = 1700
"""… and wires that are simulated in the time of all figures (PRESET=small, Intel Xeon)."""


def main() -> None:
    """Measure for a second, and say it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--preset", default="small")
    preset = parser.parse_args().preset
    try:
        runs = [preset_run(preset, model=model) for model in MODELS]
        wires = DRAWING + sum(_wires(run) * _points(run) for run in runs) / _points(runs[0])
    except ArgumentError as error:
        print(f"estimate.py: {error}", file=sys.stderr)
        sys.exit(2)
    config = runs[0].config.dataset
    with compiled.threads_at_work(1):
        announce_repeated("make figures", lambda k: simulate(config, range(k, k + 1)), wires)


def _wires(run: Run) -> float:
    """Return how many wires of a run one core could simulate while the run is made."""
    if run.shipped or run.is_trained:
        return 0.0
    config = run.config.dataset
    left = config.realizations - shards.status(config, run.dataset_folder).realizations
    return left / min(WORKERS, cores()) + TRAINING * config.realizations


def _points(run: Run) -> int:
    """Return the number of pairs (μ, B), to which the time of a wire is proportional."""
    return run.config.dataset.mu_points * run.config.dataset.B_points


if __name__ == "__main__":
    main()
