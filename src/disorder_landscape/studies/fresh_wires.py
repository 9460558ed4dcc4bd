"""Fresh wires, whose disorder is known and which no network has seen, for studies of inversions.

Wires, errors and answers are functions of (model, noise, index) alone, so that any order or
interruption gives the same table, and studies share wires.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import lru_cache, partial
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np
import pandas as pd
from pydantic import AfterValidator, Field

from disorder_landscape.config import DatasetConfig, Positive
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.inference.defaults import SAMPLES
from disorder_landscape.inference.invert import invert
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.measurement import Measurement, empty_measurement
from disorder_landscape.inference.problem.noise import noise_of_channels
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.result import evidence
from disorder_landscape.inference.verdict import verdict
from disorder_landscape.learning.model import TrainedModel, load_model
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.runs import MODELS, shipped_model
from disorder_landscape.solver.quadrature import thermal_quadrature
from disorder_landscape.studies.study import Part, Plan, one_of
from disorder_landscape.studies.truth import of_realization, unknowns_of

SEED = 2026
"""Of the fresh wires; the datasets' is 0."""
WRONG = 0.005, 4.0
"""An answer is wrong whose V is off by more than this in meV and by more than so many of its own
standard deviations, root mean square over the sites."""


ShippedModel = Annotated[str, AfterValidator(partial(one_of, MODELS))]
Noise = Annotated[float, Field(ge=0, le=1)]


@dataclass(frozen=True, order=True)
class Task:
    """One inversion: a shipped model's name, the noise in e²/h, the index of a fresh wire."""

    model: str
    noise: float
    index: int


class Wires(Part):
    """So many wires of each model, measured with each noise."""

    models: tuple[ShippedModel, ...]
    noise: tuple[Noise, ...]
    """In e²/h."""
    count: Positive


class FreshWiresPlan(Plan):
    """A study whose tasks are fresh wires of shipped models."""

    wires: tuple[Wires, ...]

    keys: ClassVar = ("model", "noise", "index")

    def tasks(self) -> Sequence[Task]:
        """Return the tasks, by model, noise and index."""
        return sorted(
            Task(model, noise, index)
            for group in self.wires
            for model in group.models
            for noise in group.noise
            for index in range(group.count)
        )


def network_of(model: str, noise: float) -> TrainedModel:
    """Return the shipped network for measurements with such errors in e²/h."""
    return model_of(shipped_model(model, noise))


@lru_cache
def model_of(folder: Path) -> TrainedModel:
    """Return a trained model, which is read once."""
    return load_model(folder)


def fresh_wire(task: Task) -> tuple[Observation, FloatArray]:
    """Return a measurement of a fresh wire, with errors, and its true unknowns (unknown,)."""
    config = network_of(task.model, task.noise).config.dataset
    return measured_wire(config, task.noise, task.index)


def measured_wire(
    config: DatasetConfig, noise: float, index: int
) -> tuple[Observation, FloatArray]:
    """Return a measurement of a fresh wire of a disorder model, with errors, and the truth."""
    config = config.model_copy(update={"seed": SEED})
    unknowns = unknowns_of(config)
    truth = of_realization(unknowns, realization(config, index))
    settings = empty_measurement(config)
    G, errors = _conductances_of_wire(config, index), noise_of_channels(noise)
    return Observation(measured(settings, G, noise, index), unknowns, errors), truth


@lru_cache(maxsize=1)
def _conductances_of_wire(config: DatasetConfig, index: int) -> FloatArray:
    """Return those of a wire, which a study measures with one noise after the other."""
    wire, setup = realization(config, index).wire, empty_measurement(config)
    return exact_conductances(wire, setup.mu, setup.B, setup.bias, setup.temperature)


def exact_conductances(
    wire: Nanowire, mu: FloatArray, B: FloatArray, bias: FloatArray, temperature: float
) -> FloatArray:
    """Return conductances in e²/h, shape (mu, B, bias, channel).

    They are averaged by quadrature, which is another route than the inversion's own.
    """
    G: FloatArray = thermal_quadrature([wire], mu, B, bias, temperature).conductance[0]
    return G


def measured(
    settings: Measurement, G: FloatArray, noise: float, index: int, part: int = 1
) -> Measurement:
    """Return conductances of a fresh wire with errors; parts of a measurement have their own."""
    rng = np.random.default_rng([SEED, index, part])
    return replace(settings, G=G + noise * rng.normal(size=G.shape))


@dataclass(frozen=True, eq=False)
class Inverted:
    """What an inversion has come to."""

    found: Outcome
    outcome: dict[str, object]
    """`spread`, the answer's own standard deviation of V in meV; `effective_sample_size`, NaN
    without importance sampling; `excess`, `verdict`, `attempts`, `rounds`, `seconds`."""

    @property
    def answer(self) -> Gaussian:
        """The normal distribution that describes it."""
        return self.found.answer


def inverted(observation: Observation, network: TrainedModel | None, seed: int) -> Inverted:
    """Invert a measurement, and take the time."""
    begun = time.perf_counter()
    found = invert(observation, network, seed)
    seconds = time.perf_counter() - begun
    drawn = found.importance_samples
    outcome: dict[str, object] = {
        "spread": observation.unknowns.site_std(found.answer.covariance),
        "effective_sample_size": np.nan if drawn is None else drawn.effective_sample_size,
        "excess": found.best.excess,
        "verdict": verdict(observation, found),
        "attempts": found.attempts,
        "rounds": found.rounds,
        "seconds": seconds,
    }
    return Inverted(found, outcome)


def log_evidence(observation: Observation, found: Outcome, rng: np.random.Generator) -> Decimal:
    """Return that of an answer, with two digits after the point."""
    X = found.draw(rng, SAMPLES)
    return Decimal(f"{evidence(observation, found, X)['log_evidence']:.2f}")


def wrong(table: pd.DataFrame) -> pd.Series:
    """Return which answers are wrong."""
    least, bars = WRONG
    return (table["site_error"] > least) & (table["site_error"] > bars * table["spread"])
