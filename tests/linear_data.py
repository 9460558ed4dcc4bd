"""Data that are linear in the unknowns, or bent, and their posterior, which is known."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from disorder_landscape.config import DatasetConfig
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.search.steps import Steps
from disorder_landscape.studies.truth import unknowns_of

CONFIG = DatasetConfig(realizations=1, components=3, sites=50)
UNKNOWNS = unknowns_of(CONFIG)
SIZE, DATA = len(UNKNOWNS.names), 40


@dataclass
class Linear:
    """What the search and importance sampling need of an `Observation`."""

    data: np.ndarray
    slope: np.ndarray
    bend: float = 0.0
    unknowns: Unknowns = UNKNOWNS
    variance: np.ndarray = field(default_factory=lambda: np.full(DATA, 0.01**2))
    channel: np.ndarray = field(default_factory=lambda: np.zeros(DATA, dtype=int))

    def simulate(self, X):
        Y = X @ self.slope
        return Y + self.bend * np.sin(5 * Y)

    def closed_form_slopes(self, x, roughly=False):
        return None

    def on_some_lines(self, share, fewest, rng):
        return self


def posterior(observation):
    """Bayes' theorem for linear data."""
    prior = observation.unknowns.white_noise
    precision = np.linalg.inv(prior.covariance)
    weighted = observation.slope / observation.variance
    covariance = np.linalg.inv(weighted @ observation.slope.T + precision)
    return Gaussian(covariance @ (weighted @ observation.data + precision @ prior.mean), covariance)


@dataclass(frozen=True)
class Ending(Steps):
    """Steps that end where a function of all that they are given says."""

    where: Callable[..., Gaussian] | None = None

    def end(self, observation, x, attempt, name=None, known=(), goal="optimum"):
        return self.where(observation, x, attempt, name, known, goal)
