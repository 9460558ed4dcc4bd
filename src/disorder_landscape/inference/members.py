"""Members of several proposals, weighted as if all were drawn from the last one.

Where proposals change little from round to round, wires that earlier rounds have simulated teach
the next one as well. Each counts with the ratio of the last proposal's density to that of the
mixture of all (the deterministic mixture, or balance heuristic: Veach and Guibas, SIGGRAPH 1995;
of adaptive importance sampling: Cornuet et al., Scand. J. Stat. 39, 798 (2012)), so that a member
counts more than one of the last proposal's own only where these are few.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from disorder_landscape.inference.observation import Observation
from disorder_landscape.inference.unknowns import Gaussian
from disorder_landscape.physics.parameters import FloatArray

LEAST_WEIGHT = 1e-3
"""Members of less weight are not looked at, …"""
MOST = 2000
"""… and the oldest are forgotten where there are more than so many."""


class Weighted(NamedTuple):
    """Members (member, unknown), what they show (member, datum), and weights (member,)."""

    X: FloatArray
    Y: FloatArray
    weight: FloatArray


@dataclass(eq=False)
class _Drawn:
    """Members of one proposal; `Y` once they have been simulated."""

    proposal: Gaussian
    X: FloatArray
    Y: FloatArray | None = None


@dataclass(eq=False)
class Members:
    """What has been drawn from proposal after proposal.

    Parameters
    ----------
    observation : Observation
        Which data are simulated.
    """

    observation: Observation
    _drawn: list[_Drawn] = field(default_factory=list)

    def draw(self, proposal: Gaussian, count: int, rng: np.random.Generator) -> None:
        """Draw so many members of the next proposal; they are simulated when they are needed."""
        root = np.linalg.cholesky(proposal.covariance)
        X = proposal.mean + rng.normal(size=(count, proposal.mean.size)) @ root.T
        self._drawn.append(_Drawn(proposal, X))
        while sum(len(drawn.X) for drawn in self._drawn) > max(MOST, count):
            self._drawn.pop(0)

    def weighted(self) -> Weighted:
        """Return the members that count for the last proposal."""
        count = np.array([len(drawn.X) for drawn in self._drawn])
        X = np.concatenate([drawn.X for drawn in self._drawn])
        log = np.array([log_density(drawn.proposal, X) for drawn in self._drawn])
        mixture = np.logaddexp.reduce(log + np.log(count / count.sum())[:, None], axis=0)
        weight = np.exp(log[-1] - mixture)
        counts = weight > LEAST_WEIGHT
        Y = [
            self._simulated(drawn)[some]
            for drawn, some in zip(
                self._drawn, np.split(counts, np.cumsum(count)[:-1]), strict=True
            )
            if some.any()
        ]
        return Weighted(X[counts], np.concatenate(Y), weight[counts])

    def _simulated(self, drawn: _Drawn) -> FloatArray:
        if drawn.Y is None:
            drawn.Y = self.observation.simulate(drawn.X)
        return drawn.Y


def log_density(gaussian: Gaussian, X: FloatArray) -> FloatArray:
    """Return the logarithm of a normal density at X (member, unknown), shape (member,).

    Up to the power of 2π.
    """
    determinant = np.linalg.slogdet(gaussian.covariance)[1]
    return np.asarray(-0.5 * (gaussian.squared_distance(X) + determinant))
