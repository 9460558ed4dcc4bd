"""How many combinations of the disorder the data fix, over components, grids and noise.

Writes uniqueness.csv, a row per wire, setting and noise. What is there is not repeated.
"""

from __future__ import annotations

import argparse
from itertools import product
from pathlib import Path

import pandas as pd
from tqdm import tqdm

from disorder_landscape.studies.rows import add_rows, missing, read_rows
from disorder_landscape.studies.uniqueness import Setting, information_rows

COMPONENTS = (5, 10, 15, 20, 30, 54)
POINTS = (10, 20, 40)
BIASES = (5, 21)
KEYS = ["components", "points", "biases", "index"]
COMMAND = "python results/uniqueness.py"


def main() -> None:
    """Calculate what is missing and write the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    folder = Path(__file__).resolve().parent
    parser.add_argument("-o", "--output", type=Path, default=folder / "uniqueness.csv")
    parser.add_argument("--wires", type=int, default=3)
    arguments = parser.parse_args()

    path = arguments.output
    settings = [
        Setting(components, points, biases, index)
        for index, points, biases, components in product(
            range(arguments.wires), POINTS, BIASES, COMPONENTS
        )
    ]
    for one in tqdm(missing(settings, read_rows(path, KEYS), KEYS), unit=" settings"):
        rows = pd.DataFrame(information_rows(one)).round({"spread": 7, "prior_spread": 7})
        add_rows(rows, path, [*KEYS, "noise"], COMMAND)


if __name__ == "__main__":
    main()
