"""Inversions of 200 fresh wires for each model and noise: accuracy, calibration, verdicts.

Writes inversions.csv, a row per inversion. What is there is not repeated: an interrupted run goes
on. Example: python results/inversion.py --noise 0 0.01 --wires 50
"""

from __future__ import annotations

from pathlib import Path

from disorder_landscape.studies.fresh_wires import carry_out, inversion_row
from disorder_landscape.studies.noise import NOISE

COMMAND = "python results/inversion.py"


def main() -> None:
    """Carry out what is missing."""
    output = Path(__file__).resolve().parent / "inversions.csv"
    carry_out(inversion_row, __doc__, output, NOISE, 200, COMMAND)


if __name__ == "__main__":
    main()
