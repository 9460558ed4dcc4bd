"""Inversions of fresh wires whose disorder is known: how far off the answers are, and their spread.

One row per wire and noise, with what the accuracy, the calibration and the verdicts are judged by.
Rows are functions of (model, noise, index) alone, so that any order or interruption gives the same
table.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pandas as pd

from disorder_landscape.chain import MODELS, shipped_model
from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.inference.attempt import Attempt, best
from disorder_landscape.inference.invert import invert
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.measurement import Measurement, empty_measurement
from disorder_landscape.inference.problem.observation import Observation, noise_of_channels
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.search.first_guess import network_labels
from disorder_landscape.inference.verdict import verdict
from disorder_landscape.learning.model import TrainedModel, load_model
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.studies.rows import complete, study_parser

SEED = 2026
"""Of the fresh wires; the datasets' is 0."""
WRONG = 0.005, 4.0
"""An answer is wrong whose V is off by more than this in meV and by more than so many of its own
deviations, root mean square over the sites."""
KEYS = ["model", "noise", "index"]


@dataclass(frozen=True)
class Task:
    """One inversion: a shipped model's name, the noise in e²/h, the index of a fresh wire."""

    model: str
    noise: float
    index: int


def carry_out(
    row_of: Callable[[Task], dict[str, object]],
    doc: str | None,
    output: Path,
    noise: Sequence[float],
    wires: int,
    command: str,
) -> None:
    """Read the command line of a study of fresh wires, and carry out what its table lacks.

    Parameters
    ----------
    row_of : callable
        The row of a task.
    doc : str, optional
        The script's own, for --help.
    output : Path
    noise : sequence of float
        In e²/h.
    wires : int
        Of each model at each noise; like the two before, what is not named otherwise.
    command : str
        What makes the table.
    """
    parser = study_parser(doc, output, noise)
    parser.add_argument("--models", nargs="+", choices=MODELS, default=list(MODELS))
    parser.add_argument("--wires", type=int, default=wires)
    arguments = parser.parse_args()
    tasks = [
        Task(model, one, index)
        for index in range(arguments.wires)
        for one in arguments.noise
        for model in arguments.models
    ]
    complete(row_of, tasks, arguments.output, KEYS, command, arguments.workers)


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
    unknowns = Unknowns(config)
    truth = unknowns.of_realization(realization(config, index))
    settings = empty_measurement(config)
    errors = noise_of_channels(noise)
    G = Observation(settings, unknowns, errors).conductances(truth[None])[0]
    return Observation(measured(settings, G, noise, index), unknowns, errors), truth


def measured(
    settings: Measurement, G: FloatArray, noise: float, index: int, part: int = 1
) -> Measurement:
    """Return conductances of a fresh wire with errors; parts of a measurement have their own."""
    rng = np.random.default_rng([SEED, index, part])
    return replace(settings, G=G + noise * rng.normal(size=G.shape))


@dataclass(frozen=True, eq=False)
class Inverted:
    """What an inversion has come to."""

    chosen: Attempt
    outcome: dict[str, object]
    """`spread`, the answer's own standard deviation of V in meV; `effective_sample_size`, NaN
    without importance sampling; `excess`, `verdict`, `attempts`, `rounds`, `seconds`."""

    @property
    def answer(self) -> Gaussian:
        """The normal distribution that describes it."""
        return self.chosen.answer


def inverted(observation: Observation, network: TrainedModel | None, seed: int) -> Inverted:
    """Invert a measurement, and take the time."""
    begun = time.perf_counter()
    attempts = invert(observation, network, seed)
    seconds = time.perf_counter() - begun
    chosen = best(attempts)
    drawn = chosen.importance_samples
    outcome: dict[str, object] = {
        "spread": observation.unknowns.site_std(chosen.answer.covariance),
        "effective_sample_size": np.nan if drawn is None else drawn.effective_sample_size,
        "excess": chosen.excess,
        "verdict": verdict(observation, attempts),
        "attempts": len(attempts),
        "rounds": sum(attempt.rounds for attempt in attempts),
        "seconds": seconds,
    }
    return Inverted(chosen, outcome)


def inversion_row(task: Task) -> dict[str, object]:
    """Invert the measurement of a fresh wire and compare the answer with the truth.

    Returns
    -------
    dict
        V errors in meV, root mean square over the sites; the errors of α in meV nm; `scaled_error`,
        the mean square error of the paper's labels in units of their variance, which is 1 − R²;
        `z_scores`, the true unknowns' distances from the answer in its standard deviations;
        `mahalanobis`, all of them together squared; and the outcome of `Inverted`.
    """
    observation, truth = fresh_wire(task)
    unknowns, network = observation.unknowns, network_of(task.model, task.noise)
    found = inverted(observation, network, task.index)
    mean = found.answer.mean
    guess = network_labels(network, unknowns, observation.measurement.G[None])[0]
    papers = np.array([name != "mean" for name in unknowns.names])
    variance = np.diag(unknowns.prior.covariance)
    row: dict[str, object] = {
        "model": task.model,
        "noise": task.noise,
        "index": task.index,
        "network_error": unknowns.site_distance(guess, truth),
        "site_error": unknowns.site_distance(mean, truth),
        "network_scaled_error": ((guess - truth) ** 2 / variance)[papers].mean(),
        "scaled_error": ((mean - truth) ** 2 / variance)[papers].mean(),
        "network_alpha_error": abs(unknowns.alpha(guess) - unknowns.alpha(truth)),
        "alpha_error": abs(unknowns.alpha(mean) - unknowns.alpha(truth)),
        "mahalanobis": found.answer.squared_distance(truth),
        **found.outcome,
    }
    z = (truth - mean) / np.sqrt(np.diag(found.answer.covariance))
    return {**rounded(row), "z_scores": " ".join(f"{one:.3f}" for one in z)}


def rounded(row: dict[str, object]) -> dict[str, object]:
    """Return a row with five digits of each number that is not whole."""
    return {
        key: float(f"{value:.5g}") if isinstance(value, float | np.ndarray) else value
        for key, value in row.items()
    }


def wrong(table: pd.DataFrame) -> pd.Series:
    """Return which answers are wrong."""
    least, bars = WRONG
    return (table["site_error"] > least) & (table["site_error"] > bars * table["spread"])
