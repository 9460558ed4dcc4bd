"""Inversions of the same measurements from two starts, the network's guess and the prior alone.

Writes starts.csv, a row per measurement. What is there is not repeated: an interrupted run goes on.
Example: python results/starts.py --models five_components_and_alpha --wires 10
"""

from __future__ import annotations

from pathlib import Path

from disorder_landscape.studies.fresh_wires import carry_out
from disorder_landscape.studies.starts import starts_row

COMMAND = "python results/starts.py"


def main() -> None:
    """Carry out what is missing."""
    output = Path(__file__).resolve().parent / "starts.csv"
    carry_out(starts_row, __doc__, output, [0.01], 20, COMMAND)


if __name__ == "__main__":
    main()
