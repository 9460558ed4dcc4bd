"""Inversions of wires with something that the model lacks: which wrong answers are noticed.

Writes unmodelled.csv, a row per inversion: 102 wires with one thing other than the model has it,
and 100 without, for the false alarms. What is there is not repeated: an interrupted run goes on.
Example: python results/unmodelled.py --noise 0.01 --kinds gap nothing
"""

from __future__ import annotations

from pathlib import Path

from disorder_landscape.chain import FIVE, MODELS
from disorder_landscape.studies.rows import complete, study_parser
from disorder_landscape.studies.unmodelled import KEYS, KINDS, NOTHING, Task, unmodelled_row

COMMAND = "python results/unmodelled.py"
WIRES, GOOD = 17, 100
"""Of each kind, and without anything unmodelled."""


def main() -> None:
    """Carry out what is missing."""
    output = Path(__file__).resolve().parent / "unmodelled.csv"
    parser = study_parser(__doc__, output, [0.01])
    parser.add_argument("--models", nargs="+", choices=MODELS, default=[FIVE])
    parser.add_argument("--kinds", nargs="+", choices=list(KINDS), default=list(KINDS))
    arguments = parser.parse_args()

    tasks = [
        Task(model, noise, kind, index)
        for index in range(GOOD)
        for noise in arguments.noise
        for model in arguments.models
        for kind in arguments.kinds
        if kind == NOTHING or index < WIRES
    ]
    complete(unmodelled_row, tasks, arguments.output, KEYS, COMMAND, arguments.workers)


if __name__ == "__main__":
    main()
