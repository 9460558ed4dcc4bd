"""Tables of studies, as CSV: text stays as it is, so that what is there keeps its digits."""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from disorder_landscape.dataset.store import provenance
from disorder_landscape.files import read_json, replacing, write_json
from disorder_landscape.model.parameters import FloatArray

Row = dict[str, str]


def read_rows(path: Path) -> list[Row]:
    """Return the rows of a table; none if there is no file."""
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write_rows(path: Path, rows: Sequence[Row], command: str) -> None:
    """Write a table, and beside it what made it (JSON, with the table's checksum)."""
    text = io.StringIO(newline="")
    columns = list(dict.fromkeys(column for row in rows for column in row))
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    content = text.getvalue().encode()
    with replacing(path) as temporary:
        temporary.write_bytes(content)
    made = {**provenance(command), "sha256": hashlib.sha256(content).hexdigest()}
    write_json(path.with_suffix(".json"), {**stored_numbers(path), "provenance": made})


def stored_numbers(path: Path) -> dict[str, Any]:
    """Return what the JSON file beside a table holds; nothing if there is none."""
    beside = path.with_suffix(".json")
    return read_json(beside, "output", "hold results of studies") if beside.exists() else {}


def as_text(row: Mapping[str, object]) -> Row:
    """Return a row as it is written: empty for None and NaN."""
    return {name: _text(value) for name, value in row.items()}


def _text(value: object) -> str:
    if isinstance(value, np.generic):
        value = value.item()
    return "" if value is None or value != value else str(value)


def rounded(row: Mapping[str, object]) -> dict[str, object]:
    """Return a row with five digits of each number that is not whole."""
    return {
        key: float(f"{value:.5g}") if isinstance(value, float | np.ndarray) else value
        for key, value in row.items()
    }


def numbers(rows: Iterable[Row], column: str) -> FloatArray:
    """Return a column's numbers, shape (row,); NaN where there is none."""
    return np.array([float(row[column] or np.nan) for row in rows])
