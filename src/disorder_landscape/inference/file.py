"""From the file of a measurement to the file of what `infer` finds, alone or as one of many."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.dataset.hdf5 import open_hdf5
from disorder_landscape.dataset.store import read_dataset, write_dataset
from disorder_landscape.files import check_writable
from disorder_landscape.inference.infer import infer
from disorder_landscape.inference.plot import plot_inference
from disorder_landscape.inference.problem.measurement import PAPERS_SETTINGS, measurement_of
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.inference.stages import Progress, silent
from disorder_landscape.learning.model import CONFIG, NETWORK, SCALER
from disorder_landscape.locks import kept_from_others

PICTURES = (".html", ".pdf", ".png", ".svg")
"""Endings that name a picture, not a folder of pictures."""
ASKED = "asked"
"""Attribute of a result: the measurement, the model and the options that it answers."""


@dataclass(frozen=True)
class Settings:
    """What `infer` is told about a measurement besides its file.

    Parameters
    ----------
    prior : Path or None
        TOML file of what is known; without it the model's dataset says so.
    model : Path or None
        Folder of the model whose network guesses.
    noise : float or dict, optional
    from_prior : bool
    samples : int
    seed : int
    discrepancy : bool
        As in `infer`.
    made : mapping
        Provenance of the results.
    """

    prior: Path | None
    model: Path | None
    noise: float | dict[str, float] | None
    from_prior: bool
    samples: int
    seed: int
    discrepancy: bool
    made: Mapping[str, str]


@dataclass(frozen=True)
class Task:
    """A measurement, and where its result goes.

    Parameters
    ----------
    measurement, output : Path
        netCDF files.
    plot : Path, optional
    """

    measurement: Path
    output: Path
    plot: Path | None = None

    @property
    def unfinished(self) -> Path:
        """The file through which an interrupted inversion goes on."""
        return self.output.with_name(f"{self.output.name}.unfinished.json")

    @property
    def is_done(self) -> bool:
        """Whether all its files are there."""
        return self.output.exists() and (self.plot is None or self.plot.exists())


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
    is_file = plots is not None and (plots.is_file() or plots.suffix in PICTURES)
    require(not is_file, "plot", "name a folder, as output does", f"it is '{plots}'")
    must = "have names of their own, since their results have the same"
    require(not twice, "measurement", must, f"there are several of {', '.join(twice)}")
    given = _given(settings)
    tasks = []
    for path in measurements:
        require(path.is_file(), "measurement", "be a netCDF file", f"there is no '{path}'")
        plot = None if plots is None else plots / f"{path.stem}.png"
        task = Task(path, output / f"{path.stem}.nc", plot)
        same = task.output.resolve() == path.resolve()
        must = "be another folder than that of the measurements"
        require(not same, "output", must, f"both have '{path.name}'")
        check_writable("output", task.unfinished)
        if plot is not None:
            check_writable("plot", plot)
        if task.output.exists():
            stored = _asked_of(task.output)
            must = "be a folder for results of these measurements with these options"
            but = f"'{task.output}' is another one's (delete it, or give another folder)"
            require(stored == _asked(path, settings, given), "output", must, but)
        tasks.append(task)
    return tasks


def infer_file(settings: Settings, task: Task, progress: Progress = silent) -> xr.Dataset:
    """Find what explains the measurement in a file, and write the result and its picture.

    Of two processes with the same output one waits.

    Raises
    ------
    ArgumentError
        As `infer`, or if a file cannot be read or written.
    """
    with _alone_with(task):
        return _infer_file(settings, task, progress)


def _infer_file(settings: Settings, task: Task, progress: Progress = silent) -> xr.Dataset:
    measured = read_dataset(task.measurement)
    prior, network = _prior_and_network(settings)
    result = infer(
        measured,
        prior,
        settings.noise,
        network,
        settings.samples,
        settings.seed,
        discrepancy=settings.discrepancy,
        checkpoint=task.unfinished,
        progress=progress,
    )
    _draw(result, measured, task.plot)  # before the result is written, which tells of the end
    asked = _asked(task.measurement, settings, _given(settings))
    attrs = {**settings.made, ASKED: asked}
    of_channels = ["misfit", "discrepancy"]  # some may be without data
    write_dataset(result, task.output, attrs, may_lack=of_channels)
    task.unfinished.unlink(missing_ok=True)
    return result


def _draw(result: xr.Dataset, measured: xr.Dataset, plot: Path | None) -> None:
    """Draw a result, where a picture is asked for."""
    if plot is not None:
        plot_inference(result, measurement_of(measured, PAPERS_SETTINGS), plot)


def prior_of(settings: Settings) -> Prior | Path:
    """Return what the settings say of the device before the measurement.

    Raises
    ------
    ArgumentError
        If neither a prior nor a model is given, or it cannot be read.
    """
    return _prior_and_network(settings)[0]


def _prior_and_network(settings: Settings) -> tuple[Prior | Path, Path | bool]:
    """Return the two arguments of `infer`."""
    network = False if settings.from_prior or settings.model is None else settings.model
    if settings.prior is not None:
        return Prior.from_toml(settings.prior), network
    if settings.model is not None:
        return settings.model, network
    must = "be given, or a model whose dataset says what is known"
    raise ArgumentError("prior", must, "there is neither")


def _alone_with(task: Task) -> AbstractContextManager[None]:
    """Wait for other processes with the same output, and let them wait."""
    return kept_from_others(task.output.parent, task.output.name)


@dataclass(frozen=True)
class Outcome:
    """What came of one of many measurements: a verdict, or the error that hindered it."""

    task: Task
    verdict: str = ""
    error: str = ""


def infer_one_of_many(settings: Settings, task: Task) -> Outcome:
    """Do as `infer_file`, or draw the result that is there; an error does not hinder the others."""
    try:
        with _alone_with(task):
            if not task.output.exists():
                result = _infer_file(settings, task)
            else:
                result = read_dataset(task.output)
                if not task.is_done:
                    _draw(result, read_dataset(task.measurement), task.plot)
        return Outcome(task, verdict=str(result.attrs["verdict"]))
    except ArgumentError as error:
        return Outcome(task, error=str(error))


def _asked(measurement: Path, settings: Settings, given: Mapping[str, str]) -> str:
    """Return what a result depends on, as JSON text."""
    asked = {
        "measurement": _hash([measurement]),
        **given,
        "noise": settings.noise,
        "from_prior": settings.from_prior,
        "samples": settings.samples,
        "seed": settings.seed,
        **({"discrepancy": True} if settings.discrepancy else {}),
    }
    return json.dumps(asked, sort_keys=True)


def _asked_of(output: Path) -> str:
    """Return what a result says that it answers; nothing if it is no result."""
    try:
        with open_hdf5(output) as file:
            asked = file.attrs.get(ASKED, "")
    except OSError:
        return ""
    return asked if isinstance(asked, str) else ""


def _given(settings: Settings) -> dict[str, str]:
    """Return the hashes of the prior and of the model; one without a network serves as prior."""
    given = {}
    if settings.prior is not None:
        given["prior"] = _hash([settings.prior])
    if settings.model is not None:
        paths = [settings.model / name for name in (CONFIG, SCALER, NETWORK)]
        given["model"] = _hash([path for path in paths if path.exists()])
    return given


def _hash(paths: Sequence[Path]) -> str:
    content = hashlib.sha256()
    for path in paths:
        try:
            content.update(path.read_bytes())
        except OSError as error:
            but = f"'{path}' cannot be read ({error.strerror})"
            raise ArgumentError("file", "be readable", but) from None
    return content.hexdigest()
