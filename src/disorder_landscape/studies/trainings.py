"""Kind "trainings": networks that are trained and scored, and differ in a few settings."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Sequence
from copy import deepcopy
from dataclasses import asdict, dataclass
from itertools import product
from multiprocessing import parent_process
from pathlib import Path
from typing import Any, ClassVar, Literal

from pydantic import BaseModel, Field, field_validator, model_validator

from disorder_landscape.chain import generate
from disorder_landscape.config import Config
from disorder_landscape.learning.model_files import METRICS, is_trained
from disorder_landscape.runs import Run, dataset_folder
from disorder_landscape.studies.study import PLANS, Part, Place, Plan, one_of, study_names
from disorder_landscape.studies.trainings_table import Result
from disorder_landscape.toml_file import checked

Sections = dict[str, dict[str, Any]]
"""Sections and keys of a configuration."""


class Runs(Part):
    """Trainings that have a name and some settings in common."""

    name: str
    set: Sections = Field(default_factory=dict)
    """Instead of the base's."""
    together: dict[str, list[Any]] = Field(default_factory=dict)
    """Lists of values for "section.key", as long as each other, which go through together."""
    grid: dict[str, list[Any]] = Field(default_factory=dict)
    """Lists of values for "section.key"; every combination, also with `together`, is a training."""

    @model_validator(mode="after")
    def _as_long_as_each_other(self) -> Runs:
        if len({len(values) for values in self.together.values()}) > 1:
            raise ValueError("together must have lists that are as long as each other")
        return self


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


class _Likeness(BaseModel):
    """What one plan may take from another."""

    base: Sections
    runs: tuple[Runs, ...]


class TrainedPlan(Plan):
    """A study of networks that it trains, or finds trained."""

    base: Sections = Field(default_factory=dict)
    """A configuration, from which each training differs."""
    runs: tuple[Runs, ...]
    like: str | None = None
    """A study in configs/studies: what its base, and `set` of its runs of the same names, say holds
    here too, where this plan says nothing else."""

    tasks_resume: ClassVar = True

    @field_validator("like")
    @classmethod
    def _there(cls, name: str | None) -> str | None:
        return name if name is None else one_of(study_names(), name)

    def trainings(self) -> list[PlannedRun]:
        """Return the trainings, in the order of the file.

        Raises
        ------
        ArgumentError
            If one of them has an unknown or invalid key.
        """
        base, sets = self.base, dict[str, Sections]()
        if self.like is not None:
            other = checked(_Likeness, PLANS / f"{self.like}.toml", "study")
            base, sets = _over(other.base, base), {run.name: run.set for run in other.runs}
        return [
            run
            for group in self.runs
            for run in _expand(group, _over(base, sets.get(group.name, {})), self.title)
        ]


class TrainingsPlan(TrainedPlan):
    """Trainings that are compared; a row each.

    Datasets and models are shared with all other studies, in build/datasets and build/models. An
    interrupted training goes on after its last saved epoch.
    """

    kind: Literal["trainings"]

    keys: ClassVar = ("key",)
    keeps_others: ClassVar = False

    def tasks(self) -> Sequence[PlannedRun]:
        """Return the trainings."""
        return self.trainings()

    def prepare(self, tasks: Sequence[PlannedRun], place: Place) -> None:
        """Generate the datasets."""
        generate_datasets(tasks, place)

    def rows(self, task: PlannedRun, place: Place) -> list[dict[str, object]]:
        """Train and score one network."""
        return [asdict(trained(task, place))]


def generate_datasets(runs: Sequence[PlannedRun], place: Place) -> None:
    """Make what is missing of the datasets of the trainings that are not finished."""
    unfinished = [run for run in runs if not _is_finished(run, place)]
    for config in {run.config.dataset: run.config for run in unfinished}.values():
        # A run's dataset is beside its folder.
        generate(Run(config.dataset.hash, config, place.build / "models"), place.executor)


def trained(run: PlannedRun, place: Place) -> Result:
    """Return what a training has come to, after what is missing of it; its dataset is there."""
    from disorder_landscape.learning.training import train_from_shards

    folder = model_folder(run, place.build)
    if not _is_finished(run, place):
        shards = dataset_folder(run.config.dataset, place.build)
        alone = parent_process() is None
        train_from_shards(run.config, shards, folder, "landscape study", progress=alone)
    return _result(run, folder)


def model_folder(run: PlannedRun, build: Path) -> Path:
    """Return the folder of a training's network."""
    return build / "models" / run.key


def _is_finished(run: PlannedRun, place: Place) -> bool:
    return is_trained(model_folder(run, place.build))


def _result(run: PlannedRun, folder: Path) -> Result:
    from disorder_landscape.learning.curves import training_seconds
    from disorder_landscape.learning.examples import split
    from disorder_landscape.learning.model import load_model, read_model_file

    dataset, network, training = run.config.dataset, run.config.network, run.config.training
    metrics = read_model_file(folder / METRICS)
    used = training.realizations or split(dataset.realizations, training.test_fraction)[0].stop
    weights = load_model(folder).network.trainable_weights
    return Result(
        name=run.name,
        key=run.key,
        dataset=dataset.hash,
        components=dataset.components,
        amplitude=dataset.amplitude,
        realizations=used,
        test_realizations=metrics["realizations"],
        architecture=network.architecture,
        width_fraction=network.width_fraction,
        weights=sum(math.prod(weight.shape) for weight in weights),
        compress_inputs=training.compress_inputs,
        mirror=training.mirror,
        noise=training.noise,
        seed=training.seed,
        R2=metrics["r2"],
        delta_V=metrics["delta_V"],
        delta_alpha=metrics["delta_alpha"],
        minutes=round(training_seconds(folder / "curves.csv") / 60, 2),
    )


def _over(first: Sections, then: Sections) -> Sections:
    """Return the sections of both, with what is said last."""
    return {name: {**first.get(name, {}), **then.get(name, {})} for name in {**first, **then}}


def _expand(group: Runs, base: Sections, title: str) -> Iterator[PlannedRun]:
    """Yield a training for every combination of the group's grid and what goes together."""
    names = [*group.together, *group.grid]
    together = list(zip(*group.together.values(), strict=True)) or [()]
    for first, *others in product(together, *group.grid.values()):
        content = deepcopy(_over(base, group.set))
        for name, value in zip(names, (*first, *others), strict=True):
            section, _, key = name.partition(".")
            content.setdefault(section, {})[key] = value
        yield PlannedRun(group.name, checked(Config, title, "study", content))
