"""Kind "smoothers": our search beside a library's ES-MDA, from the same starts.

The library is iterative_ensemble_smoother; each of its steps has a part of the inflation of the one
before.
"""

from __future__ import annotations

import time
from functools import partial
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from disorder_landscape.config import Positive
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.first_guess import network_guess
from disorder_landscape.inference.search.gauss_newton import gauss_newton
from disorder_landscape.inference.search.regression_rounds import RoundSettings, regression_rounds
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.parts import needs
from disorder_landscape.studies.fresh_wires import FreshWiresPlan, Task, fresh_wire, network_of
from disorder_landscape.studies.rows import rounded
from disorder_landscape.studies.study import Place
from disorder_landscape.studies.truth import site_distance

TRUNCATION = 0.999
"""Part of the singular values' sum that the library keeps."""


class SmoothersPlan(FreshWiresPlan):
    """Inversions of fresh wires by two smoothers: errors and seconds."""

    kind: Literal["smoothers"]
    ensemble: Positive
    """Of the library's ensemble."""
    steps: Positive
    """Of the library."""
    ratio: Annotated[float, Field(ge=1)]
    """Of the inflations of two steps, one after the other."""

    common: ClassVar = ("ensemble", "steps", "ratio")

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Let both invert one measurement."""
        observation, truth = fresh_wire(task)
        rng = np.random.default_rng([task.index, 2**31])
        start = network_guess(network_of(task.model, task.noise), observation, rng)
        distance = partial(site_distance, observation.unknowns)
        row: dict[str, object] = {"model": task.model, "noise": task.noise, "index": task.index}
        row["start_error"] = distance(start.mean, truth)
        for name, method in (("library", self._library), ("ours", self._ours)):
            begun = time.perf_counter()
            mean, spread = method(observation, start, task.index)
            row |= {f"{name}_error": distance(mean, truth), f"{name}_spread": spread}
            row[f"{name}_seconds"] = time.perf_counter() - begun
        return [rounded(row)]

    def _library(
        self, observation: Observation, start: Gaussian, seed: int
    ) -> tuple[FloatArray, float]:
        """Return the mean of ES-MDA's last ensemble, and its standard deviation of V in meV."""
        with needs("dev"):
            from iterative_ensemble_smoother import ESMDA

        X = start.draw(np.random.default_rng(seed), self.ensemble)
        smoother = ESMDA(
            covariance=observation.variance,
            observations=observation.data,
            alpha=self.ratio ** np.arange(self.steps)[::-1],
            seed=seed,
        )
        for _ in range(smoother.num_assimilations()):
            smoother.prepare_assimilation(Y=observation.simulate(X).T, truncation=TRUNCATION)
            X = smoother.assimilate_batch(X=X.T).T
        return X.mean(axis=0), observation.unknowns.site_std(np.cov(X.T))

    def _ours(
        self, observation: Observation, start: Gaussian, seed: int
    ) -> tuple[FloatArray, float]:
        """Return the same of one attempt of ours."""
        *_, last = regression_rounds(observation, start, [seed, 0], RoundSettings())
        answer = gauss_newton(observation, last.distribution.mean)
        return answer.mean, observation.unknowns.site_std(answer.covariance)
