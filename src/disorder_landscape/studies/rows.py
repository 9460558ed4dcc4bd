"""Tables of studies that are no trainings: a row for each task, found again by its keys."""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

import pandas as pd
from tqdm import tqdm

from disorder_landscape.dataset.store import provenance
from disorder_landscape.files import replacing, write_json
from disorder_landscape.workers import each_result

Task = TypeVar("Task")


def read_rows(path: Path, keys: list[str]) -> pd.DataFrame:
    """Return the table; empty if there is none."""
    return pd.read_csv(path) if path.exists() else pd.DataFrame(columns=keys)


def write_rows(table: pd.DataFrame, path: Path, keys: list[str], command: str) -> None:
    """Write a table, sorted, and beside it what made it (JSON, with the table's checksum)."""
    content = table.sort_values(keys).to_csv(index=False).encode()
    with replacing(path) as temporary:
        temporary.write_bytes(content)
    made = {**provenance(command), "sha256": hashlib.sha256(content).hexdigest()}
    write_json(path.with_suffix(".json"), {"provenance": made})


def add_rows(rows: pd.DataFrame, path: Path, keys: list[str], command: str) -> None:
    """Write rows into a table, and keep those that others have added to it in the meantime."""
    table = pd.concat([read_rows(path, keys), rows], ignore_index=True)
    write_rows(table.drop_duplicates(keys), path, keys, command)


def missing(tasks: Sequence[Task], table: pd.DataFrame, keys: list[str]) -> list[Task]:
    """Return the tasks that the table has no row of; the keys are attributes of a task."""
    there = set(table[keys].itertuples(index=False, name=None))
    return [task for task in tasks if tuple(getattr(task, key) for key in keys) not in there]


def study_parser(doc: str | None, output: Path, noise: Sequence[float]) -> argparse.ArgumentParser:
    """Return the command line of a study that `complete` carries out: where, at which noise, how.

    Parameters
    ----------
    doc : str, optional
        The script's own, for --help.
    output : Path
        The table, if none is named.
    noise : sequence of float
        In e²/h, if none is named.
    """
    parser = argparse.ArgumentParser(
        description=doc, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", type=Path, default=output)
    parser.add_argument("--noise", nargs="+", type=float, default=list(noise))
    parser.add_argument("--workers", type=int, default=2)
    return parser


def complete(
    function: Callable[[Task], dict[str, object]],
    tasks: Sequence[Task],
    path: Path,
    keys: list[str],
    command: str,
    workers: int,
) -> None:
    """Carry out the tasks that a table has no row of, and write each row as it comes."""
    left = missing(tasks, read_rows(path, keys), keys)
    with tqdm(total=len(tasks), initial=len(tasks) - len(left), unit=" wires") as bar:
        for row in each_result(function, left, workers):
            add_rows(pd.DataFrame([row]), path, keys, command)
            bar.update()
