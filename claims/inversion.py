"""Inversions of 200 fresh wires for each model and noise: accuracy, calibration, verdicts.

Writes inversions.csv, a row per inversion. What is there is not repeated: an interrupted run goes
on. Example: python claims/inversion.py --noise 0 0.01 --wires 50
"""

from __future__ import annotations

import argparse
from pathlib import Path

from disorder_landscape.chain import MODELS
from disorder_landscape.studies.inversions import KEYS, Task, inversion_row
from disorder_landscape.studies.noise import NOISE
from disorder_landscape.studies.rows import complete

COMMAND = "python claims/inversion.py"


def main() -> None:
    """Carry out what is missing."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    folder = Path(__file__).resolve().parent
    parser.add_argument("-o", "--output", type=Path, default=folder / "inversions.csv")
    parser.add_argument("--models", nargs="+", choices=MODELS, default=list(MODELS))
    parser.add_argument("--noise", nargs="+", type=float, default=list(NOISE))
    parser.add_argument("--wires", type=int, default=200)
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()

    tasks = [
        Task(model, noise, index)
        for index in range(arguments.wires)
        for noise in arguments.noise
        for model in arguments.models
    ]
    complete(inversion_row, tasks, arguments.output, KEYS, COMMAND, arguments.workers)


if __name__ == "__main__":
    main()
