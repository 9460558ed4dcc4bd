"""The rows of a study of trainings."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from disorder_landscape.studies.rows import Row, read_rows


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
    return [_from_text(row) for row in read_rows(path)]


def _from_text(row: Row) -> Result:
    convert: dict[str, Any] = {"int": int, "float": float, "bool": "True".__eq__, "str": str}
    values: dict[str, Any] = {}
    for field in fields(Result):
        kind = str(field.type)
        text = row[field.name]
        empty = kind.endswith("None") and not text
        values[field.name] = None if empty else convert[kind.split(" ")[0]](text)
    return Result(**values)
