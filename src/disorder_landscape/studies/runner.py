"""Carry a study out: the tasks that its table has no row of, and what follows from the whole."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from tqdm import tqdm

from disorder_landscape.dataset.store import provenance
from disorder_landscape.estimates import Pace
from disorder_landscape.files import replacing, write_json
from disorder_landscape.locks import kept_from_others
from disorder_landscape.studies.plan import Study
from disorder_landscape.studies.rows import Row, as_text, read_rows, stored_numbers, write_rows
from disorder_landscape.studies.study import Derived, Place, Plan

WRITTEN_EVERY = 5.0
"""Seconds after which rows are written; those of an interrupted study are, too."""


def carry_out(study: Study, place: Place, limit: int | None = None) -> Derived:
    """Carry out what is missing of a study; return what follows, where it is complete then.

    What is there is not repeated, so that an interrupted study goes on where it was. A share of the
    tasks is kept in a table of its own, which the next run of the whole study takes into its table;
    of two such runs one waits.

    Parameters
    ----------
    study : Study
    place : Place
    limit : int, optional
        Only so many of the missing tasks.

    Raises
    ------
    ArgumentError
        If a table or a folder cannot be read or written, or has rows of other settings; what was
        finished stays.
    """
    study.check_tables(place)
    if not place.share.is_whole:
        return _carry_out(study, place, limit)
    with kept_from_others(study.table(place).parent, study.name):
        has_new = _gather_shares(study, place)
        return _carry_out(study, place, limit, has_new)


def _carry_out(study: Study, place: Place, limit: int | None, has_new: bool = False) -> Derived:
    # The first wires of all settings come first.
    missing = sorted(study.missing(place), key=lambda task: getattr(task, "index", 0))
    chosen = missing[:limit]
    if chosen:
        in_all = len(place.share.of(study.tasks))
        study.plan.prepare(chosen, place)
        bar = tqdm(total=in_all, initial=in_all - len(missing), desc=study.name, unit=" tasks")
        at_a_time = min(place.executor.at_a_time, len(chosen))
        pace = Pace(study.name, len(chosen), tqdm.write, warm_up=0, at_a_time=at_a_time)
        with bar:
            _complete(study, place, chosen, bar, pace)
    if study.missing(place) or not place.share.is_whole:
        return Derived()
    return _conclude(study, place, has_new or bool(chosen))


def _complete(study: Study, place: Place, tasks: Sequence[Any], bar: Any, pace: Pace) -> None:
    """Carry tasks out, and write their rows every few seconds and at the end."""
    new: list[Row] = []
    written = time.monotonic()
    try:
        for rows in _results(study.plan, place, tasks):
            new += rows
            bar.update()
            pace.step()
            if time.monotonic() - written > WRITTEN_EVERY:
                _add(study, place, new)
                new, written = [], time.monotonic()
    finally:
        if new:
            _add(study, place, new)


def _results(plan: Plan, place: Place, tasks: Sequence[Any]) -> Iterator[list[Row]]:
    return place.executor.each_result(partial(_rows, plan, place), tasks, plan.tasks_resume)


def _rows(plan: Plan, place: Place, task: Any) -> list[Row]:
    return [as_text(row) for row in plan.rows(task, place)]


def _gather_shares(study: Study, place: Place) -> bool:
    """Take what other runs have left in tables of their shares; whether there are any."""
    paths = study.tables_of_shares(place)
    for path in paths:
        with kept_from_others(path.parent, path.name):  # its own run may be adding rows
            _add(study, place, read_rows(path))
            path.unlink(missing_ok=True)
            path.with_suffix(".json").unlink(missing_ok=True)
    return bool(paths)


def _add(study: Study, place: Place, new: Iterable[Row]) -> None:
    """Write rows into the table, and keep those that others have added in the meantime."""
    path = study.table_of_share(place)
    order = {study.key(task): i for i, task in enumerate(study.tasks)}
    with kept_from_others(path.parent, path.name):
        there = read_rows(path)
        known = {study.key_of_row(row) for row in there}
        rows = [*there, *(row for row in new if study.key_of_row(row) not in known)]
        if not study.plan.keeps_others:
            rows = [row for row in rows if study.key_of_row(row) in order]
        rows.sort(key=lambda row: order.get(study.key_of_row(row), len(order)))
        write_rows(path, rows, study.command, study.plan.settings())


def _conclude(study: Study, place: Place, has_new: bool) -> Derived:
    """Return what follows from the whole table, and write it where it is not what is there."""
    table = study.table(place)
    derived = study.plan.derived(read_rows(table), place)
    stem = place.output / study.name
    text, picture = stem.with_suffix(".txt"), stem.with_suffix(".png")
    stored = stored_numbers(stem.with_suffix(".csv"))
    made = stored.pop("provenance", {})
    wanted = [path for path, there in ((text, derived.text), (picture, derived.draw)) if there]
    if stored == derived.numbers and not has_new and all(path.exists() for path in wanted):
        return derived
    if table.parent != place.output:
        made = provenance(study.command)
    if derived.numbers:
        write_json(stem.with_suffix(".json"), {**derived.numbers, "provenance": made})
    if derived.text:
        lines = [f"{name}: {value}" for name, value in made.items()]
        _write_text(text, "\n".join([derived.text, "", *lines]) + "\n")
    if derived.draw is not None:
        derived.draw(picture)
    return derived


def _write_text(path: Path, text: str) -> None:
    with replacing(path) as temporary:
        temporary.write_text(text, "utf-8")
