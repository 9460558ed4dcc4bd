"""Tables of studies, as CSV: text stays as it is, so that what is there keeps its digits."""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.dataset.store import provenance
from disorder_landscape.files import read_json, replacing, write_json
from disorder_landscape.model.parameters import FloatArray

Row = dict[str, str]

CHECKSUM, CHECKSUM_BEFORE = "sha256", "sha256_before"
"""Keys of a table's provenance: a run that is killed may leave either the new table or the last."""
SETTINGS = "settings"
"""Key of what rows depend on besides what they state."""


def read_rows(path: Path) -> list[Row]:
    """Return the rows of a table; none if there is no file.

    Raises
    ------
    ArgumentError
        If it cannot be read, or is not what was written.
    """
    if not path.exists():
        return []
    must = "hold tables as studies have written them"
    try:
        content = path.read_bytes()
        rows = list(csv.DictReader(io.StringIO(content.decode(), newline=""), strict=True))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        but = f"'{path}' cannot be read ({error})"
        raise ArgumentError("output", must, but) from None
    made = stored_numbers(path).get("provenance", {})
    stated = [made[key] for key in (CHECKSUM, CHECKSUM_BEFORE) if key in made]
    same = not stated or hashlib.sha256(content).hexdigest() in stated
    but = f"'{path}' was changed, or is damaged; restore it, or delete the .json beside to keep it"
    require(same, "output", must, but)
    return rows


def write_rows(
    path: Path, rows: Sequence[Row], command: str, settings: Mapping[str, object] | None = None
) -> None:
    """Write a table, and beside it what made it (JSON, with settings and the table's checksum).

    What followed from other rows is no longer there.
    """
    text = io.StringIO(newline="")
    columns = list(dict.fromkeys(column for row in rows for column in row))
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    content = text.getvalue().encode()
    made: dict[str, object] = {**provenance(command), CHECKSUM: hashlib.sha256(content).hexdigest()}
    if settings:
        made[SETTINGS] = settings
    if path.exists():
        made[CHECKSUM_BEFORE] = hashlib.sha256(path.read_bytes()).hexdigest()
    same = made.get(CHECKSUM_BEFORE) == made[CHECKSUM]
    followed = stored_numbers(path) if same else {}
    write_json(path.with_suffix(".json"), {**followed, "provenance": made})
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def stored_settings(path: Path) -> dict[str, Any]:
    """Return the settings with which a table was made; nothing if it states none."""
    return dict(stored_numbers(path).get("provenance", {}).get(SETTINGS, {}))


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
