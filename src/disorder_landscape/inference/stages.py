"""The stages of an inversion, as progress callbacks hear of them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

ROUND, GAUSS_NEWTON, IMPORTANCE_SAMPLING = "round", "Gauss–Newton", "importance sampling"
SMALL_STEPS, MAPS = "small steps", "maps"
"""The stages."""


class Step(NamedTuple):
    """What an inversion is at, for a progress callback."""

    attempt: int
    stage: str
    """One of ROUND, SMALL_STEPS, GAUSS_NEWTON, IMPORTANCE_SAMPLING and MAPS."""
    number: int
    misfit: float
    """Root mean square in e²/h."""
    spread: float
    """The standard deviation of V in meV, root mean square over the sites."""


Progress = Callable[[Step], None]
"""A progress callback: called after each round, some small steps and each iteration of importance
sampling, before each Gauss–Newton step, and before the maps of a result."""
Report = Callable[[int, float, float], None]
"""The same within one stage: number, misfit and spread."""


def silent(step: Step) -> None:
    """Do nothing: the progress callback where there is none."""


def no_report(number: int, misfit: float, spread: float) -> None:
    """Do nothing: the same within one stage."""


def within(progress: Progress, attempt: int, stage: str) -> Report:
    """Return the callback for the steps of one stage."""
    return partial(_step, progress, attempt, stage)


def _step(
    progress: Progress, attempt: int, stage: str, number: int, misfit: float, spread: float
) -> None:
    progress(Step(attempt, stage, number, misfit, spread))
