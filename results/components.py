"""Inversions of wires of 15 and 20 components, without any network, and of 30, with a weak one.

Writes components.csv, a row per inversion. What is there is not repeated: an interrupted run goes
on. Example: python results/components.py --components 15 --wires 4
"""

from __future__ import annotations

from pathlib import Path

from disorder_landscape.studies.components import KEYS, Task, components_row
from disorder_landscape.studies.rows import complete, study_parser

COMMAND = "python results/components.py"


def main() -> None:
    """Carry out what is missing."""
    output = Path(__file__).resolve().parent / "components.csv"
    parser = study_parser(__doc__, output, [0.001, 0.01])
    parser.add_argument("--components", nargs="+", type=int, default=[15, 20, 30])
    parser.add_argument("--wires", type=int, default=4)
    arguments = parser.parse_args()

    tasks = [
        Task(components, noise, index)
        for index in range(arguments.wires)
        for noise in arguments.noise
        for components in arguments.components
    ]
    complete(components_row, tasks, arguments.output, KEYS, COMMAND, arguments.workers)


if __name__ == "__main__":
    main()
