"""Plans: TOML files in configs/studies, one of each study, read by their kind."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, RootModel

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.studies.accuracy import AccuracyPlan
from disorder_landscape.studies.calibration import CalibrationPlan
from disorder_landscape.studies.components import ComponentsPlan
from disorder_landscape.studies.devices import DevicesPlan
from disorder_landscape.studies.evidence import EvidencePlan
from disorder_landscape.studies.hot_to_cold import HotToColdPlan
from disorder_landscape.studies.inversions import InversionsPlan
from disorder_landscape.studies.noise import NoisePlan
from disorder_landscape.studies.odd_wires import OddWiresPlan
from disorder_landscape.studies.rows import Row, read_rows, stored_settings
from disorder_landscape.studies.smoothers import SmoothersPlan
from disorder_landscape.studies.starts import StartsPlan
from disorder_landscape.studies.study import PLANS, Place, Plan, study_names
from disorder_landscape.studies.temperatures import TemperaturesPlan
from disorder_landscape.studies.trainings import TrainingsPlan
from disorder_landscape.studies.uniqueness import UniquenessPlan
from disorder_landscape.studies.unmodelled import UnmodelledPlan
from disorder_landscape.studies.verification import VerificationPlan
from disorder_landscape.toml_file import checked

AnyPlan = (
    AccuracyPlan
    | CalibrationPlan
    | ComponentsPlan
    | DevicesPlan
    | EvidencePlan
    | HotToColdPlan
    | InversionsPlan
    | NoisePlan
    | OddWiresPlan
    | SmoothersPlan
    | StartsPlan
    | TemperaturesPlan
    | TrainingsPlan
    | UniquenessPlan
    | UnmodelledPlan
    | VerificationPlan
)
"""A plan of any kind, as its key `kind` says."""


class _File(RootModel[Annotated[AnyPlan, Field(discriminator="kind")]]):
    """A plan's file."""


@dataclass(frozen=True, eq=False)
class Study:
    """A plan with its name.

    Parameters
    ----------
    name : str
        The file's.
    plan : Plan
    command : str
        What carries it out.
    """

    name: str
    plan: Plan
    command: str

    @cached_property
    def tasks(self) -> Sequence[Any]:
        """The plan's tasks."""
        return self.plan.tasks()

    def table(self, place: Place) -> Path:
        """Return the file of the table."""
        return self.plan.folder(place) / f"{self.name}.csv"

    def table_of_share(self, place: Place) -> Path:
        """Return the file in which a share of the tasks is kept until the table has it too."""
        table, share = self.table(place), place.share
        if share.is_whole:
            return table
        return table.with_name(f"{self.name}.share-{share.number}-of-{share.count}.csv")

    def tables_of_shares(self, place: Place) -> list[Path]:
        """Return these files of all shares that there are."""
        return sorted(self.table(place).parent.glob(f"{self.name}.share-*-of-*.csv"))

    def missing(self, place: Place) -> list[Any]:
        """Return the tasks of this share that no table has a row of."""
        tables = {self.table(place), *self.tables_of_shares(place)}
        there = {self.key_of_row(row) for table in tables for row in read_rows(table)}
        return [task for task in place.share.of(self.tasks) if self.key(task) not in there]

    def check_tables(self, place: Place) -> None:
        """Require that no table has rows of other settings than the plan's.

        Raises
        ------
        ArgumentError
            If one has.
        """
        now = self.plan.settings()
        for table in (self.table(place), *self.tables_of_shares(place)):
            then = stored_settings(table)
            for name in sorted(now.keys() & then.keys()):
                must = "have rows of this plan, or none: move the table, or use another --output"
                which, old, new = _where_they_differ(name, then[name], now[name])
                but = f"'{table.name}' is of {which} = {old}, and the plan of {new}"
                require(old == new, "output", must, but)

    def key(self, task: Any) -> tuple[Any, ...]:
        """Return what tells a task from every other."""
        return tuple(getattr(task, name) for name in self.plan.keys)

    def key_of_row(self, row: Row) -> tuple[Any, ...]:
        """Return the key of the task that a row is of.

        Raises
        ------
        ArgumentError
            If it lacks a column, or there is another kind of thing in it.
        """
        try:
            return tuple(
                of(row[name]) for name, of in zip(self.plan.keys, self._types, strict=True)
            )
        except (KeyError, ValueError):
            must = f"have a table of this study, with the columns {', '.join(self.plan.keys)}"
            raise ArgumentError("output", must, f"'{self.name}.csv' has not") from None

    @cached_property
    def _types(self) -> list[type]:
        return [type(value) for value in self.key(self.tasks[0])]


def _where_they_differ(name: str, old: Any, new: Any) -> tuple[str, Any, Any]:
    """Return the name of the first setting that differs, in two of a name, and both values."""
    if not (isinstance(old, dict) and isinstance(new, dict)) or old == new:
        return name, old, new
    inner = next(key for key in {**old, **new} if old.get(key) != new.get(key))
    return _where_they_differ(f"{name}, {inner}", old.get(inner), new.get(inner))


def load_study(name: str | Path) -> Study:
    """Read a study's plan.

    Parameters
    ----------
    name : str or path
        Of a plan in configs/studies, without its ending, or a TOML file.

    Raises
    ------
    ArgumentError
        If it cannot be read, has an unknown or invalid key, or two of its tasks are the same.
    """
    path = Path(name)
    if path.suffix != ".toml":
        must = f"be a TOML file, or one of {', '.join(study_names())}"
        require(str(name) in study_names(), "study", must, f"it is '{name}'")
        path = PLANS / f"{name}.toml"
    ours = path.resolve().parent == PLANS
    command = f"landscape study {path.stem if ours else path}"
    study = Study(path.stem, checked(_File, path, "study").root, command)
    require(len(study.tasks) > 0, "study", "have tasks", f"'{path}' has none")
    (key, times), *_ = Counter(study.key(task) for task in study.tasks).most_common(1)
    said = ", ".join(map(str, key))
    require(times == 1, "study", "have different tasks", f"'{path}' has {said} twice")
    return study
