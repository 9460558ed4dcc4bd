"""What a kind of study must offer: its tasks, the rows of each, and what follows from the table."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Protocol, TypeVar

from pydantic import BaseModel, ConfigDict

from disorder_landscape.executors.executor import WHOLE, Executor, Share
from disorder_landscape.executors.local import IN_THIS_PROCESS
from disorder_landscape.runs import CONFIGS
from disorder_landscape.studies.rows import Row

PLANS = CONFIGS / "studies"


def study_names() -> list[str]:
    """Return the names of the plans in configs/studies."""
    return sorted(path.stem for path in PLANS.glob("*.toml"))


@dataclass(frozen=True)
class Place:
    """Where studies are carried out, and by whom."""

    output: Path
    """Folder of the tables, and of what follows from them."""
    build: Path
    """Folder of datasets, models, and of tables that only these very solvers make."""
    executor: Executor = IN_THIS_PROCESS
    share: Share = WHOLE
    """Which of the tasks are looked at."""


@dataclass(frozen=True)
class Derived:
    """What follows from a table that is complete."""

    numbers: Mapping[str, Any] = field(default_factory=dict)
    """For <name>.json."""
    text: str = ""
    """For <name>.txt."""
    draw: Callable[[Path], None] | None = None
    """Writes <name>.png."""
    lines: Sequence[str] = ()
    """To be printed."""
    passed: bool = True
    """Whether the bounds hold that the study checks, if it does."""


class Part(BaseModel):
    """A table of a plan, with nothing in it that is not known."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Named(Protocol):
    """A table of a plan that tasks call by its name."""

    name: str


Group = TypeVar("Group", bound=Named)


def by_name(groups: Iterable[Group], name: str) -> Group:
    """Return the one that has this name."""
    (group,) = (group for group in groups if group.name == name)
    return group


def one_of(names: Iterable[str], name: str) -> str:
    """Return a name that a plan has, for pydantic, which makes a sentence of the error."""
    if name not in names:
        raise ValueError(f"it must be one of {', '.join(names)}")
    return name


class Plan(Part):
    """A study as its TOML file states it; each kind has a subclass, and a module of its own."""

    title: str

    keys: ClassVar[tuple[str, ...]]
    """Columns that tell the rows of a task from others'; attributes of a task, of the same name."""
    common: ClassVar[tuple[str, ...]] = ()
    """Fields on which all rows depend. The others say which tasks there are."""
    tasks_resume: ClassVar[bool] = False
    """Whether a task that is ended at any moment goes on from there when it is asked for again."""
    keeps_others: ClassVar[bool] = True
    """Whether a row stays in the table whose task the plan no longer has."""

    @abstractmethod
    def tasks(self) -> Sequence[Any]:
        """Return the tasks, in the order of the table."""

    def settings(self) -> dict[str, Any]:
        """Return what rows depend on besides their keys, as JSON may hold it."""
        return self.model_dump(mode="json", include=set(self.common))

    def prepare(self, tasks: Sequence[Any], place: Place) -> None:
        """Make what these tasks have in common, before they are carried out."""

    @abstractmethod
    def rows(self, task: Any, place: Place) -> Iterable[Mapping[str, object]]:
        """Carry a task out; return its rows, each with the keys."""

    def folder(self, place: Place) -> Path:
        """Return where the table is kept."""
        return place.output

    def derived(self, rows: Sequence[Row], place: Place) -> Derived:
        """Return what follows from the whole table."""
        return Derived()
