"""Our rounds and polish beside a library's ES-MDA, from the same starts: errors and seconds.

The library is iterative_ensemble_smoother, with 160 members and eight steps, each with half of the
inflation of the one before. Writes smoothers.csv, a row per
wire; what is there is not repeated. Example: python claims/smoothers.py --wires 4
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
import pandas as pd
from iterative_ensemble_smoother import ESMDA
from tqdm import tqdm

from disorder_landscape.chain import MODELS, shipped_model
from disorder_landscape.inference.first_guess import network_guess
from disorder_landscape.inference.observation import Observation
from disorder_landscape.inference.polish import polish
from disorder_landscape.inference.rounds import RoundSettings, rounds
from disorder_landscape.inference.unknowns import Gaussian
from disorder_landscape.learning.model import TrainedModel, load_model
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.studies.inversions import Task, fresh_wire
from disorder_landscape.studies.rows import missing, read_rows, write_rows

MEMBERS, STEPS, RATIO = 160, 8, 2.0
TRUNCATION = 0.999
"""Part of the singular values' sum that the library keeps."""
NOISE = 0.01
KEYS = ["model", "index"]
COMMAND = "python claims/smoothers.py"


def library(observation: Observation, start: Gaussian, seed: int) -> tuple[FloatArray, float]:
    """Return the mean of ES-MDA's members in the end, and their deviation of V."""
    X = start.draw(np.random.default_rng(seed), MEMBERS)
    smoother = ESMDA(
        covariance=observation.variance,
        observations=observation.data,
        alpha=RATIO ** np.arange(STEPS)[::-1],
        seed=seed,
    )
    for _ in range(smoother.num_assimilations()):
        smoother.prepare_assimilation(Y=observation.simulate(X).T, truncation=TRUNCATION)
        X = smoother.assimilate_batch(X=X.T).T
    return X.mean(axis=0), observation.unknowns.site_deviation(np.cov(X.T))


def ours(observation: Observation, start: Gaussian, seed: int) -> tuple[FloatArray, float]:
    """Return the same of one attempt of ours."""
    *_, last = rounds(observation, start, [seed, 0], RoundSettings())
    answer = polish(observation, last.distribution)
    return answer.mean, observation.unknowns.site_deviation(answer.covariance)


def row(model: TrainedModel, task: Task) -> dict[str, object]:
    """Let both invert one measurement."""
    observation, truth = fresh_wire(task)
    start = network_guess(model, observation, np.random.default_rng([task.index, 2**31]))
    distance = observation.unknowns.site_distance
    found: dict[str, object] = {"model": task.model, "index": task.index}
    found["start_error"] = distance(start.mean, truth)
    for name, method in (("library", library), ("ours", ours)):
        begun = time.perf_counter()
        mean, spread = method(observation, start, task.index)
        found |= {f"{name}_error": distance(mean, truth), f"{name}_spread": spread}
        found[f"{name}_seconds"] = round(time.perf_counter() - begun, 1)
    return found


def main() -> None:
    """Carry out what is missing."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    folder = Path(__file__).resolve().parent
    parser.add_argument("-o", "--output", type=Path, default=folder / "smoothers.csv")
    parser.add_argument("--wires", type=int, default=8)
    arguments = parser.parse_args()

    table = read_rows(arguments.output, KEYS)
    models = {name: load_model(shipped_model(name)) for name in MODELS}
    tasks = [Task(name, NOISE, index) for index in range(arguments.wires) for name in MODELS]
    for task in tqdm(missing(tasks, table, KEYS), unit=" wires"):
        table = pd.concat([table, pd.DataFrame([row(models[task.model], task)])], ignore_index=True)
        write_rows(table, arguments.output, KEYS, COMMAND)


if __name__ == "__main__":
    main()
