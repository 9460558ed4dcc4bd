"""Inversions of 200 fresh wires for each model and noise: accuracy, calibration, verdicts.

Writes inversions.csv, a row per inversion. What is there is not repeated: an interrupted run goes
on. Example: python claims/inversion.py --noise 0 0.01 --wires 50
"""

from __future__ import annotations

from pathlib import Path

from disorder_landscape.chain import MODELS
from disorder_landscape.studies.inversions import KEYS, inversion_row, tasks_of
from disorder_landscape.studies.noise import NOISE
from disorder_landscape.studies.rows import complete, study_parser

COMMAND = "python claims/inversion.py"


def main() -> None:
    """Carry out what is missing."""
    output = Path(__file__).resolve().parent / "inversions.csv"
    parser = study_parser(__doc__, output, NOISE)
    parser.add_argument("--models", nargs="+", choices=MODELS, default=list(MODELS))
    parser.add_argument("--wires", type=int, default=200)
    arguments = parser.parse_args()

    tasks = tasks_of(arguments.models, arguments.noise, arguments.wires)
    complete(inversion_row, tasks, arguments.output, KEYS, COMMAND, arguments.workers)


if __name__ == "__main__":
    main()
