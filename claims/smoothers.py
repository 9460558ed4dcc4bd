"""Our search beside a library's ES-MDA, from the same starts: errors and seconds.

The library is iterative_ensemble_smoother, with an ensemble of 160 and eight steps, each with half
of the inflation of the one before. Writes smoothers.csv, a row per wire. What is there is not
repeated: an interrupted run goes on. Example: python claims/smoothers.py --wires 2
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from iterative_ensemble_smoother import ESMDA

from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.first_guess import network_guess
from disorder_landscape.inference.search.gauss_newton import gauss_newton
from disorder_landscape.inference.search.regression_rounds import RoundSettings, regression_rounds
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.studies.inversions import (
    Task,
    carry_out,
    fresh_wire,
    network_of,
    rounded,
)

ENSEMBLE, STEPS, RATIO = 160, 8, 2.0
TRUNCATION = 0.999
"""Part of the singular values' sum that the library keeps."""
COMMAND = "python claims/smoothers.py"


def library(observation: Observation, start: Gaussian, seed: int) -> tuple[FloatArray, float]:
    """Return the mean of ES-MDA's last ensemble, and its standard deviation of V."""
    X = start.draw(np.random.default_rng(seed), ENSEMBLE)
    smoother = ESMDA(
        covariance=observation.variance,
        observations=observation.data,
        alpha=RATIO ** np.arange(STEPS)[::-1],
        seed=seed,
    )
    for _ in range(smoother.num_assimilations()):
        smoother.prepare_assimilation(Y=observation.simulate(X).T, truncation=TRUNCATION)
        X = smoother.assimilate_batch(X=X.T).T
    return X.mean(axis=0), observation.unknowns.site_std(np.cov(X.T))


def ours(observation: Observation, start: Gaussian, seed: int) -> tuple[FloatArray, float]:
    """Return the same of one attempt of ours."""
    *_, last = regression_rounds(observation, start, [seed, 0], RoundSettings())
    answer = gauss_newton(observation, last.distribution)
    return answer.mean, observation.unknowns.site_std(answer.covariance)


def row(task: Task) -> dict[str, object]:
    """Let both invert one measurement."""
    observation, truth = fresh_wire(task)
    network, rng = network_of(task.model, task.noise), np.random.default_rng([task.index, 2**31])
    start = network_guess(network, observation, rng)
    distance = observation.unknowns.site_distance
    found: dict[str, object] = {"model": task.model, "noise": task.noise, "index": task.index}
    found["start_error"] = distance(start.mean, truth)
    for name, method in (("library", library), ("ours", ours)):
        begun = time.perf_counter()
        mean, spread = method(observation, start, task.index)
        found |= {f"{name}_error": distance(mean, truth), f"{name}_spread": spread}
        found[f"{name}_seconds"] = time.perf_counter() - begun
    return rounded(found)


def main() -> None:
    """Carry out what is missing."""
    output = Path(__file__).resolve().parent / "smoothers.csv"
    carry_out(row, __doc__, output, [0.01], 4, COMMAND)


if __name__ == "__main__":
    main()
