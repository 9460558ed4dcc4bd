"""Our values, from the files that studies have left, and how those files were made.

A study leaves a table, results/<study>.csv, and results/<study>.json with an object `provenance`:
the command, and what else is known (minutes, machine, versions, `sha256` of the table, which is
checked then). Where there is no such object, the plan of the study, configs/studies/<study>.toml,
says what its command is, and the column `minutes` how long it took. Files under data_small have
checksums in data_small/SHA256SUMS, and a model's config.json says what made it. Quick measurements
are kept in results/measured.json, each with machine, versions and minutes.
"""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path
from statistics import median
from typing import Any

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.claims.claim import Claim, Measured, ResultMissingError, Stored
from disorder_landscape.claims.derived import DERIVED
from disorder_landscape.claims.value import Value, mean_over_seeds
from disorder_landscape.files import read_json, write_json
from disorder_landscape.runs import REPOSITORY

MEASURED_FILE = "results/measured.json"
"""What `make claims` has measured before, from the root of the repository."""

_REDUCE: dict[str, Callable[[list[float]], Value]] = {
    "only": lambda values: Value(values[0]),
    "mean": mean_over_seeds,
    "median": lambda values: Value(median(values)),
    "min": lambda values: Value(min(values)),
    "max": lambda values: Value(max(values)),
    "sum": lambda values: Value(sum(values)),
}


def stored_value(claim: Claim, source: Stored | Measured, root: Path = REPOSITORY) -> Value:
    """Return a value of ours from the repository.

    Raises
    ------
    ResultMissingError
        If there is no such file or no such row, or the quick measurement has never been stored.
    ArgumentError
        If the file is there but damaged, or holds no such value.
    """
    if isinstance(source, Measured):
        return Value(float(_stored_measurement(claim, source, root)["value"]))
    path = root / source.file
    if not path.exists():
        raise ResultMissingError(f"there is no {source.file}")
    if source.key is not None:
        value = Value(_from_json(path, source))
    elif source.column is not None:
        value = _from_csv(path, source, source.where)
        if source.minus is not None:
            value = Value(value.value - _from_csv(path, source, source.minus).value)
    else:
        must = f"name one of {', '.join(DERIVED)}"
        require(source.derive in DERIVED, "derive", must, f"it is '{source.derive}'")
        value = DERIVED[str(source.derive)](path)
    scaled = value.scaled(source.times)
    return scaled.from_one() if source.from_one else scaled


def provenance(claim: Claim, source: Stored | Measured, root: Path = REPOSITORY) -> dict[str, Any]:
    """Return how a value was made, after checking its file.

    Raises
    ------
    ResultMissingError
        If the value is not there.
    ArgumentError
        If the file does not tell how it was made, or is another than the one whose checksum is
        kept.
    """
    if isinstance(source, Measured):
        stored = _stored_measurement(claim, source, root)
        return {name: stored[name] for name in stored if name != "value"}
    path = root / source.file
    if not path.exists():
        raise ResultMissingError(f"there is no {source.file}")
    data = root / "data_small"
    if path.is_relative_to(data):
        lines = (data / "SHA256SUMS").read_text("utf-8").splitlines()
        sums = {name: digest for digest, name in (line.split(maxsplit=1) for line in lines)}
        _check_sum(path, sums.get(path.relative_to(data).as_posix()), "data_small/SHA256SUMS")
        made: dict[str, Any] = _read_json(path.with_name("config.json"))
    else:
        made = _made_by_study(path, root)
    must = "tell the command that made it in its provenance"
    require("command" in made, source.file, must, "it does not")
    return {name: made[name] for name in made if isinstance(made[name], str | int | float)}


def _made_by_study(path: Path, root: Path) -> dict[str, Any]:
    """Return what the JSON file of a study says of how it was made, or what its plan says."""
    beside, plan = path.with_suffix(".json"), root / "configs" / "studies" / f"{path.stem}.toml"
    made: dict[str, Any] = {}
    if path.suffix == ".csv":
        minutes = [float(row["minutes"]) for row in _read_csv(path) if row.get("minutes")]
        if minutes:
            made["minutes"] = sum(minutes)
        if plan.exists():
            made["command"] = f"landscape study {plan.stem}"
    if beside.exists():
        made.update(_read_json(beside).get("provenance", {}))
    if path.suffix == ".csv" and "sha256" in made:
        _check_sum(path, made["sha256"], beside.name)
    return made


def _stored_measurement(claim: Claim, source: Measured, root: Path) -> dict[str, Any]:
    if source.needs is not None and not (root / source.needs).exists():
        raise ResultMissingError(f"there is no {source.needs}")
    path = root / MEASURED_FILE
    stored = _read_json(path) if path.exists() else {}
    if claim.id not in stored:
        raise ResultMissingError(f"`make claims ONLY={claim.id} STORE=1` measures it")
    measurement: dict[str, Any] = stored[claim.id]
    return measurement


def _from_json(path: Path, source: Stored) -> float:
    content: Any = _read_json(path)
    for name in str(source.key).split("/"):
        if not isinstance(content, dict) or name not in content:
            raise ArgumentError(source.file, f"hold {source.key}", f"it lacks '{name}'")
        content = content[name]
    return _number(content, source)


def _from_csv(path: Path, source: Stored, where: Mapping[str, str | float]) -> Value:
    rows = _read_csv(path)
    for column in (*where, source.column):
        present = bool(rows) and column in rows[0]
        require(present, source.file, f"have a column {column}", "it has none, or no row")
    kept = [row for row in rows if all(_same(row[c], v) for c, v in where.items())]
    conditions = ", ".join(f"{column} = {value}" for column, value in where.items())
    if not kept:
        raise ResultMissingError(f"{source.file} has no row with {conditions}")
    one_is_enough = source.reduce != "only" or len(kept) == 1
    require(one_is_enough, source.file, f"have one row with {conditions}", f"it has {len(kept)}")
    return _REDUCE[source.reduce]([_number(row[str(source.column)], source) for row in kept])


def _read_csv(path: Path) -> list[dict[str, str]]:
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _same(cell: str, value: str | float) -> bool:
    try:
        return cell == value or float(cell) == float(value)
    except ValueError:
        return False


def _number(value: Any, source: Stored) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        what = source.key or source.column
        raise ArgumentError(source.file, f"hold a number as {what}", f"it is {value!r}") from None


def _read_json(path: Path) -> dict[str, Any]:
    return read_json(path, path.name, "be a JSON file")


def _check_sum(path: Path, expected: object, listed_in: str) -> None:
    found = hashlib.sha256(path.read_bytes()).hexdigest()
    must = f"have the checksum in {listed_in}"
    require(found == expected, path.name, must, "it has another, so it is another file")


def store(measured: Mapping[str, Mapping[str, Any]], root: Path = REPOSITORY) -> None:
    """Keep quick measurements, by id of their claim: value, minutes, machine and versions."""
    path = root / MEASURED_FILE
    stored = _read_json(path) if path.exists() else {}
    write_json(path, dict(sorted({**stored, **measured}.items())))
