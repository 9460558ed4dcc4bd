"""How long `make figures` will take on this machine, said before it begins."""

from __future__ import annotations

import argparse

from disorder_landscape.dataset import shards
from disorder_landscape.dataset.realizations import simulate
from disorder_landscape.estimates import announce_repeated
from disorder_landscape.machine import cores
from disorder_landscape.runs import preset_run
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
    run = preset_run(parser.parse_args().preset)
    config, wires = run.config.dataset, float(DRAWING)
    if not run.shipped and not run.is_trained:
        there = shards.status(config, run.dataset_folder).realizations
        wires += (config.realizations - there) / min(
            WORKERS, cores()
        ) + TRAINING * config.realizations
    with compiled.threads_at_work(1):
        announce_repeated("make figures", lambda k: simulate(config, range(k, k + 1)), wires)


if __name__ == "__main__":
    main()
