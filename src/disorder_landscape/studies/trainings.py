"""A study's plan: the trainings it compares, read from a TOML file in configs/studies."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, model_validator

from disorder_landscape.arguments import require
from disorder_landscape.config import Config, checked


class _Runs(BaseModel):
    """Trainings that have a name and some settings in common."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    set: dict[str, dict[str, Any]] = Field(default_factory=dict)
    """Sections and keys of a configuration, instead of the base's."""
    together: dict[str, list[Any]] = Field(default_factory=dict)
    """Lists of values for "section.key", as long as each other, which go through together."""
    grid: dict[str, list[Any]] = Field(default_factory=dict)
    """Lists of values for "section.key"; every combination, also with `together`, is a training."""

    @model_validator(mode="after")
    def _as_long_as_each_other(self) -> _Runs:
        if len({len(values) for values in self.together.values()}) > 1:
            raise ValueError("together must have lists that are as long as each other")
        return self


class _Plan(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    title: str
    base: dict[str, dict[str, Any]]
    """A configuration, from which each training differs."""
    runs: list[_Runs]


@dataclass(frozen=True)
class PlannedRun:
    """One training of a study.

    Parameters
    ----------
    name : str
        Of the group of runs it belongs to.
    config : Config
    """

    name: str
    config: Config

    @property
    def key(self) -> str:
        """What tells it from every other training, in any study: 12 hexadecimal digits."""
        config = self.config
        parts = [
            config.dataset.hash,
            str(config.dataset.realizations),
            config.network.model_dump_json(exclude_defaults=True),
            config.training.model_dump_json(exclude_defaults=True),
        ]
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:12]


@dataclass(frozen=True)
class Study:
    """The trainings of a study, by their names' order in the file."""

    name: str
    title: str
    runs: tuple[PlannedRun, ...]


def load_study(path: str | Path) -> Study:
    """Read a study's TOML file.

    Raises
    ------
    ArgumentError
        If it cannot be read, has an unknown or invalid key, or two of its trainings are the same.
    """
    path = Path(path)
    plan = checked(_Plan, path, "study")
    runs = tuple(run for group in plan.runs for run in _expand(group, plan.base, path))
    keys = [run.key for run in runs]
    twice = sorted({run.name for run in runs if keys.count(run.key) > 1})
    require(not twice, "study", "have different runs", f"'{path}' has {', '.join(twice)} twice")
    return Study(path.stem, plan.title, runs)


def _expand(group: _Runs, base: Mapping[str, Any], path: Path) -> Iterator[PlannedRun]:
    """Yield a training for every combination of the group's grid and what goes together."""
    names = [*group.together, *group.grid]
    together = list(zip(*group.together.values(), strict=True)) or [()]
    for first, *others in product(together, *group.grid.values()):
        content = deepcopy(dict(base))
        for section, settings in group.set.items():
            content.setdefault(section, {}).update(settings)
        for name, value in zip(names, (*first, *others), strict=True):
            section, _, key = name.partition(".")
            content.setdefault(section, {})[key] = value
        yield PlannedRun(group.name, checked(Config, path, "study", content))
