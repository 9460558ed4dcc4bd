"""How many combinations of the disorder the data fix, over components, grids and noise.

Writes uniqueness.csv, a row per wire, setting and noise. What is there is not repeated.
"""

from __future__ import annotations

import argparse
from itertools import product
from pathlib import Path

import pandas as pd
from tqdm import tqdm

from disorder_landscape.studies.inversions import write_rows
from disorder_landscape.studies.uniqueness import Setting, information_rows

COMPONENTS = (5, 10, 15, 20, 30, 54)
POINTS = (10, 20, 40)
BIASES = (5, 21)
COMMAND = "python claims/uniqueness.py"


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
    table = pd.read_csv(path) if path.exists() else pd.DataFrame()
    keys = list(vars(Setting(1, 1, 1, 0)))
    there = set(table[keys].itertuples(index=False, name=None)) if len(table) else set()
    for index, *setting in tqdm(
        list(product(range(arguments.wires), POINTS, BIASES, COMPONENTS)), unit=" settings"
    ):
        points, biases, components = setting
        one = Setting(components, points, biases, index)
        if tuple(vars(one).values()) in there:
            continue
        table = pd.concat([table, pd.DataFrame(information_rows(one))], ignore_index=True)
        write_rows(table.round({"spread": 7, "prior_spread": 7}), path, [*keys, "noise"], COMMAND)
    write_rows(table, path, [*keys, "noise"], COMMAND)


if __name__ == "__main__":
    main()
