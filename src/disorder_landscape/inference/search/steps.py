"""Gauss–Newton steps that tell of themselves, and whose ends an interrupted run remembers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from disorder_landscape.inference.checkpoint import Cache, cached_gaussian, uncached
from disorder_landscape.inference.optimum import Optimum
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.gauss_newton import Goal, gauss_newton
from disorder_landscape.inference.stages import GAUSS_NEWTON, Progress, silent, within
from disorder_landscape.model.parameters import FloatArray


@dataclass(frozen=True)
class Steps:
    """How steps are remembered, and whom they tell.

    Parameters
    ----------
    cache : callable
        `Checkpoint.cached`.
    progress : callable
    """

    cache: Cache = uncached
    progress: Progress = silent

    def end(
        self,
        observation: Observation,
        x: FloatArray,
        attempt: int,
        name: str | None = None,
        known: Sequence[Optimum] = (),
        goal: Goal = "optimum",
    ) -> Gaussian:
        """Return where steps from x (unknown,) end, of an attempt, and of a name to remember."""
        report = within(self.progress, attempt, GAUSS_NEWTON)
        make = partial(gauss_newton, observation, x, report, known, goal)
        return make() if name is None else cached_gaussian(self.cache, f"gauss_newton.{name}", make)
