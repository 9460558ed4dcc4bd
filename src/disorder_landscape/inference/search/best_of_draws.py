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
"""So many draws are compared on these shares of the data. (Of two wires of ten components at 0.1
e²/h and one of 5+1, 46 of 48 such starts led to optima that count, which have 94 to 99.9 % of the
posterior, in 11, 9 and 3 s each. With 1,024 draws and half of the data at last these are 45, in 16,
13 and 7 s, and of one wire 80 %, since starts are less different. Without a choice these are 35,
with 70 to 92 %.)"""
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
