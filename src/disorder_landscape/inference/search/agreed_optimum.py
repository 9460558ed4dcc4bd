"""Gauss–Newton steps from several starts, on some of the data, until the best end is found again.

Steps may end in an optimum beside the best one, which fits the data all but as well: of thirteen
wires one did, 4 µeV off. Another start tells.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from disorder_landscape.inference.attempt import Attempt, attempt_at, best
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.verdict import is_surely_right, same_answer
from disorder_landscape.model.parameters import FloatArray

STARTS = 4
"""At most, of which two must agree."""
SHARE = 0.25
"""Of the data that these steps use, where the noise hides little: they take a quarter of the
time."""


def agreed_optimum(
    observation: Observation,
    found: Gaussian,
    rng: np.random.Generator,
    steps: Callable[[Observation, FloatArray, str], Gaussian],
    name: str,
) -> FloatArray | None:
    """Return the best optimum, if two starts lead there and it fits; shape (unknown,).

    Parameters
    ----------
    observation : Observation
    found : Gaussian
        Its mean is the first start; the others are drawn from it.
    rng : Generator
    steps : callable
        `gauss_newton` of an observation, from a start, by a name.
    name : str
        Their names begin so.
    """
    some = observation.on_some_lines(SHARE, rng) if is_surely_right(observation) else observation
    ends: list[Attempt] = []
    for start in range(STARTS):
        x = found.mean if start == 0 else found.draw(rng, 2)[0]
        ends.append(attempt_at(some, found, steps(some, x, f"{name}.{start}"), 0))
        chosen = best(ends)
        if not chosen.fits:
            return None
        if any(same_answer(some, chosen, end) for end in ends if end is not chosen):
            return chosen.answer.mean
    return None
