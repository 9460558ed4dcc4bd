"""Inversions of the same measurements from two starts, the network's guess and the prior alone.

Writes starts.csv, a row per measurement. What is there is not repeated: an interrupted run goes on.
Example: python claims/starts.py --models five_components_and_alpha --wires 10
"""

from __future__ import annotations

from pathlib import Path

from disorder_landscape.chain import MODELS
from disorder_landscape.studies.inversions import KEYS, tasks_of
from disorder_landscape.studies.rows import complete, study_parser
from disorder_landscape.studies.starts import starts_row

COMMAND = "python claims/starts.py"


def main() -> None:
    """Carry out what is missing."""
    output = Path(__file__).resolve().parent / "starts.csv"
    parser = study_parser(__doc__, output, [0.01])
    parser.add_argument("--models", nargs="+", choices=MODELS, default=list(MODELS))
    parser.add_argument("--wires", type=int, default=20)
    arguments = parser.parse_args()

    tasks = tasks_of(arguments.models, arguments.noise, arguments.wires)
    complete(starts_row, tasks, arguments.output, KEYS, COMMAND, arguments.workers)


if __name__ == "__main__":
    main()
