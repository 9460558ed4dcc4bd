"""Inversions of the same measurements from two starts, the network's guess and the prior alone.

Writes starts.csv, a row per measurement. What is there is not repeated: an interrupted run goes on.
Example: python claims/starts.py --models five_components_and_alpha --wires 10
"""

from __future__ import annotations

import argparse
from pathlib import Path

from disorder_landscape.chain import MODELS
from disorder_landscape.studies.inversions import KEYS, Task
from disorder_landscape.studies.rows import complete
from disorder_landscape.studies.starts import starts_row

COMMAND = "python claims/starts.py"


def main() -> None:
    """Carry out what is missing."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    folder = Path(__file__).resolve().parent
    parser.add_argument("-o", "--output", type=Path, default=folder / "starts.csv")
    parser.add_argument("--models", nargs="+", choices=MODELS, default=list(MODELS))
    parser.add_argument("--noise", nargs="+", type=float, default=[0.01])
    parser.add_argument("--wires", type=int, default=20)
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()

    tasks = [
        Task(model, noise, index)
        for index in range(arguments.wires)
        for noise in arguments.noise
        for model in arguments.models
    ]
    complete(starts_row, tasks, arguments.output, KEYS, COMMAND, arguments.workers)


if __name__ == "__main__":
    main()
