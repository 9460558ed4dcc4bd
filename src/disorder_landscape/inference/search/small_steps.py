"""Small damped steps, each with other data: towards a V that explains all of them.

Each step is a small part of a Gauss–Newton step with few data, drawn anew (as stochastic gradients
are: Robbins and Monro, Ann. Math. Stat. 22, 400 (1951)). The noise counts as being as large as the
misfit, so that what few data say far from the true V does not outweigh the prior. V becomes right
at the ends of the wire first, and then inwards.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.gauss_newton import IN_SMALL_STEPS, linearise
from disorder_landscape.model.parameters import FloatArray

POINTS = 3, 3, 5
"""Of μ, B and bias, drawn anew for each step. (Of the same two draws of the prior, with μ up to
1.2 meV, steps with 3×3×5, 4×4×5 and 5×5×7 points lead to 33 and 50, 52 and 72, and 69 and 74 times
the noise's χ² in 20 s.)"""
STEP = 0.06
"""Part of a Gauss–Newton step. (Some steps of two tenths end far outside the prior.)"""
LATELY = 20
"""The information of so many steps, about, is averaged."""
BEFORE = 10
"""So many draws tell of the information before the first step."""
WEIGHT = 1.03, 20.0
"""Factor by which the prior's weight grows, or goes down to one, with each step, where draws of it
are shorter than x, or not; and the largest weight. (Of five: |V| grows to 2 meV. Above 100 nothing
moves.)"""


@dataclass(eq=False)
class SmallSteps:
    """Where small steps are.

    Parameters
    ----------
    observation : Observation
    prior : Gaussian
        Of the unknowns: that of the observation, or one that holds some of them.
    x : array, shape (unknown,)
    """

    observation: Observation
    prior: Gaussian
    x: FloatArray
    weight: float = 1.0
    draws: int = 0
    information: FloatArray = field(default_factory=lambda: np.zeros(()))

    def take(self, count: int, rng: np.random.Generator) -> None:
        """Take so many steps."""
        precision = np.linalg.inv(self.prior.covariance)
        while self.draws < BEFORE:
            self._information_and_slope(rng)
        for _ in range(count):
            data_say = self._information_and_slope(rng)
            off = self.x - self.prior.mean
            factor, largest = WEIGHT
            if off @ precision @ off > off.size:
                self.weight = min(largest, self.weight * factor)
            else:
                self.weight = max(1.0, self.weight / factor)
            prior_says = self.weight * precision
            information = self.information + prior_says
            step = STEP * np.linalg.solve(information, data_say - prior_says @ off)
            longest = np.sqrt(off.size)  # as draws of the prior are
            self.x = self.x + step * (longest / max(np.linalg.norm(step), longest))

    def _information_and_slope(self, rng: np.random.Generator) -> FloatArray:
        """Note the information of a draw of data, and return half the slope of −χ² (unknown,).

        Both as if all data were drawn.
        """
        part = self.observation.on_random_points(1.0, POINTS, rng)
        y, slope = linearise(part, self.x, IN_SMALL_STEPS)
        misfit, many = part.data - y, self.observation.data.size / part.data.size
        tempered = many / max(1.0, float((misfit**2 / part.variance).mean()))
        weighted = tempered * slope / part.variance
        self.draws += 1
        share = 1 / min(self.draws, LATELY)
        self.information = (1 - share) * self.information + share * (weighted @ slope.T)
        return np.asarray(weighted @ misfit)
