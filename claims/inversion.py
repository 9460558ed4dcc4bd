"""Inversions of 200 fresh wires for each model and noise: accuracy, calibration, verdicts.

Writes inversions.csv, a row per inversion. What is there is not repeated: an interrupted run goes
on. Example: python claims/inversion.py --noise 0 0.01 --wires 50
"""

from __future__ import annotations

import argparse
from pathlib import Path

import pandas as pd
from tqdm import tqdm

from disorder_landscape.chain import MODELS
from disorder_landscape.physics.compilation import compile_kernels
from disorder_landscape.studies.inversions import KEYS, Task, inversion_row
from disorder_landscape.studies.noise import NOISE
from disorder_landscape.studies.rows import missing, read_rows, write_rows
from disorder_landscape.workers import each_result

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
    table = read_rows(arguments.output, KEYS)
    left = missing(tasks, table, KEYS)
    compile_kernels()
    with tqdm(total=len(tasks), initial=len(tasks) - len(left), unit=" wires") as bar:
        for row in each_result(inversion_row, left, arguments.workers):
            table = pd.concat([table, pd.DataFrame([row])], ignore_index=True)
            write_rows(table, arguments.output, KEYS, COMMAND)
            bar.update()
    write_rows(table, arguments.output, KEYS, COMMAND)


if __name__ == "__main__":
    main()
