"""The best of some draws from a distribution, by fewer and fewer of them on more and more data.

Successive halving (Jamieson and Talwalkar, AISTATS 2016). The data are drawn anew each time: what
some lines of them favour others may not.
"""

from __future__ import annotations

import numpy as np

from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation, objective
from disorder_landscape.model.parameters import FloatArray

STAGES = (64, 0.04), (8, 0.1)
"""So many draws are compared on these shares of the data. (With more, starts are less different: of
a wire of ten components at 0.1 e²/h, 16 starts led to five optima with 94 % of the posterior, and
the best of 1,024 draws, which takes 15 times as long, to three with 80 %. Without a choice 9 of 16
led to one of these, with it 15.)"""
FEWEST = 3
"""Lines of μ and of B that the data have at least."""


def best_of_draws(
    observation: Observation, about: Gaussian, rng: np.random.Generator
) -> FloatArray:
    """Return unknowns (unknown,) that explain the data well among draws about a distribution."""
    X = about.draw(rng, STAGES[0][0])
    heights = np.zeros(len(X))
    for count, share in STAGES:
        X = X[np.argsort(heights)[:count]]
        some = observation.on_some_lines(share, FEWEST, rng)
        heights = objective(some, X, some.simulate(X))
    return np.asarray(X[np.argmin(heights)])
