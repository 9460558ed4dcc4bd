"""The table of a study's results, one row per training, as CSV."""

from __future__ import annotations

import csv
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from disorder_landscape.files import replacing


@dataclass(frozen=True)
class Result:
    """What one training came to. Every setting that a study varies is in it."""

    name: str
    key: str
    """`PlannedRun.key`."""
    dataset: str
    """Hash of the dataset's configuration."""
    components: int
    amplitude: str
    realizations: int
    """Training realizations."""
    test_realizations: int
    architecture: str
    width_fraction: float
    weights: int
    """Numbers that the training adjusts."""
    compress_inputs: bool
    mirror: bool
    noise: float
    """Of the training data, in e²/h."""
    seed: int
    R2: float
    delta_V: float
    """In meV."""
    delta_alpha: float | None
    """In meV nm; none where α is fixed."""
    minutes: float
    """Of the training."""


def read_table(path: Path) -> list[Result]:
    """Return the rows of a study's table; none if there is no file."""
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return [_from_text(row) for row in csv.DictReader(file)]


def write_table(path: Path, results: list[Result]) -> None:
    """Write a study's table."""
    with replacing(path) as temporary, open(temporary, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Result)])
        writer.writeheader()
        writer.writerows(asdict(result) for result in results)


def _from_text(row: dict[str, str]) -> Result:
    convert: dict[str, Any] = {"int": int, "float": float, "bool": "True".__eq__, "str": str}
    values: dict[str, Any] = {}
    for field in fields(Result):
        kind = str(field.type)
        text = row[field.name]
        empty = kind.endswith("None") and not text
        values[field.name] = None if empty else convert[kind.split(" ")[0]](text)
    return Result(**values)
