"""From the files of many measurements to one result each, in a folder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.dataset.store import read_dataset
from disorder_landscape.files import check_writable
from disorder_landscape.inference.file import Task, alone_with, draw, infer_when_alone
from disorder_landscape.inference.plot import PAGE
from disorder_landscape.inference.settings import Settings, asked_for, asked_of
from disorder_landscape.pictures import picture_formats


def tasks_of_folder(
    measurements: Sequence[Path], output: Path, plots: Path | None, settings: Settings
) -> list[Task]:
    """Return one task for each measurement, with results of the same names in a folder.

    Raises
    ------
    ArgumentError
        If two measurements have one name, a result would replace its measurement, the folder holds
        the result of another measurement, model or option under one of these names, or pictures
        are to go into a file.
    """
    names = [path.stem for path in measurements]
    twice = sorted({name for name in names if names.count(name) > 1})
    if plots is not None:
        ending = plots.suffix.removeprefix(".")
        is_file = plots.is_file() or ending in (PAGE, *picture_formats())
        require(not is_file, "plot", "name a folder, as output does", f"it is '{plots}'")
    must = "have names of their own, since their results have the same"
    require(not twice, "measurement", must, f"there are several of {', '.join(twice)}")
    hashes = settings.hashes()
    tasks = []
    for path in measurements:
        but = f"'{path}' is a folder" if path.is_dir() else f"there is no '{path}'"
        require(path.is_file(), "measurement", "be a netCDF file", but)
        plot = None if plots is None else plots / f"{path.stem}.png"
        task = Task(path, output / f"{path.stem}.nc", plot)
        same = task.output.resolve() == path.resolve()
        must = "be another folder than that of the measurements"
        require(not same, "output", must, f"both have '{path.name}'")
        check_writable("output", task.unfinished)
        if plot is not None:
            check_writable("plot", plot)
        if task.output.exists():
            stored = asked_of(task.output)
            must = "be a folder for results of these measurements with these options"
            but = f"'{task.output}' is another one's (delete it, or give another folder)"
            require(stored == asked_for(path, settings, hashes), "output", must, but)
        tasks.append(task)
    return tasks


@dataclass(frozen=True)
class Inferred:
    """What came of one of many measurements: a verdict, or the error that hindered it."""

    task: Task
    verdict: str = ""
    error: str = ""
    is_new: bool = True
    """Whether it has been inferred now, and not only drawn."""


def infer_one_of_many(settings: Settings, task: Task) -> Inferred:
    """Do as `infer_file`, or draw the result that is there; an error does not hinder the others."""
    try:
        with alone_with(task):
            is_new = not task.output.exists()
            if is_new:
                result = infer_when_alone(settings, task)
            else:
                result = read_dataset(task.output)
                if not task.is_done:
                    draw(result, read_dataset(task.measurement), task.plot)
        return Inferred(task, verdict=str(result.attrs["verdict"]), is_new=is_new)
    except ArgumentError as error:
        return Inferred(task, error=str(error))
