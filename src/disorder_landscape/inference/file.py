"""From the file of a measurement to the file of what `infer` finds."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from disorder_landscape.dataset.store import read_dataset, write_dataset
from disorder_landscape.inference.infer import infer
from disorder_landscape.inference.plot import plot_inference
from disorder_landscape.inference.problem.measured_dataset import measurement_of
from disorder_landscape.inference.problem.measurement import PAPERS_SETTINGS
from disorder_landscape.inference.settings import ASKED, Settings, asked_for
from disorder_landscape.inference.stages import Progress, silent
from disorder_landscape.locks import kept_from_others


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


def infer_file(settings: Settings, task: Task, progress: Progress = silent) -> xr.Dataset:
    """Find what explains the measurement in a file, and write the result and its picture.

    Of two processes with the same output one waits.

    Raises
    ------
    ArgumentError
        As `infer`, or if a file cannot be read or written.
    """
    with alone_with(task):
        return infer_when_alone(settings, task, progress)


def infer_when_alone(settings: Settings, task: Task, progress: Progress = silent) -> xr.Dataset:
    """Do so, in a process that is `alone_with` the task."""
    measured = read_dataset(task.measurement)
    prior, network = settings.prior_and_network()
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
    draw(result, measured, task.plot)  # before the result is written, which tells of the end
    asked = asked_for(task.measurement, settings, settings.hashes())
    attrs = {**settings.made, ASKED: asked}
    of_channels = ["misfit", "discrepancy"]  # some may be without data
    write_dataset(result, task.output, attrs, may_lack=of_channels)
    task.unfinished.unlink(missing_ok=True)
    return result


def draw(result: xr.Dataset, measured: xr.Dataset, plot: Path | None) -> None:
    """Draw a result, where a picture is asked for."""
    if plot is not None:
        plot_inference(result, measurement_of(measured, PAPERS_SETTINGS), plot)


def alone_with(task: Task) -> AbstractContextManager[None]:
    """Wait for other processes with the same output, and let them wait."""
    return kept_from_others(task.output.parent, task.output.name)
