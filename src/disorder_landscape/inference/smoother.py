"""An iterated ensemble smoother that knows how far its own linear model is off.

The conductances are peaks of a few kT in the space of the unknowns: rough on the scale of a guess's
error. Each step draws members from the present distribution, simulates them and fits a line through
what they show, datum by datum (statistical linear regression). What the line leaves unexplained is
added to the variance of that datum's error, so that data which are too rough at the present spread
count little, and all count fully once the spread is small: the annealing and the weights of the
channels follow from the members themselves. The step's result is the posterior of the linear model
under the disorder model's own prior, so that no datum is counted twice however many steps there
are. This is the iterated posterior linearisation of García-Fernández et al., IEEE Trans. Signal
Process. 63, 5561 (2015), with a diagonal of the residuals' covariance.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Self

import numpy as np

from disorder_landscape.inference.observation import Observation
from disorder_landscape.inference.unknowns import Gaussian
from disorder_landscape.physics.parameters import FloatArray

Recall = Callable[[str, Callable[[], dict[str, Any]]], dict[str, Any]]
"""`Checkpoint.recall`: returns the result of a name, calculated now or before."""


@dataclass(frozen=True)
class SmootherSettings:
    """How the smoother goes about it."""

    members_per_unknown: float = 4.0
    """Wires that are simulated in each step, for each unknown."""
    share: float = 0.25
    """Of the data, drawn anew for each step, as long as the line leaves more unexplained than the
    noise; all of them then."""
    least_shrinking: float = 0.35
    """A step makes no direction's deviation smaller than this part of what it was: residuals of
    neighbouring data are correlated, which the diagonal ignores."""
    longest_step: float = 2.0
    """In deviations, root mean square over the unknowns. A step longer than one deviation widens
    the next members by its length: they have missed the answer."""
    steps: int = 15
    linear: float = 0.3
    """Done when what the line leaves unexplained is below this part of the noise, …"""
    still: float = 0.5
    """… the mean moves by less than this many deviations, …"""
    settled: float = 0.7
    """… and V's deviation has become no smaller than this part of what it was."""


@dataclass(frozen=True, eq=False)
class Step:
    """What one step has found."""

    distribution: Gaussian
    misfit: float
    """Root-mean-square difference of the data and the members' mean, in e²/h."""
    unexplained: float
    """Root-mean-square difference of the members and the line, in units of the noise."""
    length: float
    """How far the mean has moved, in deviations."""
    spread: float
    """The deviation of V in meV, root mean square over the sites, …"""
    shrinking: float
    """… and in units of what it was before."""

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold, to the last bit."""
        return {**vars(self), "distribution": self.distribution.to_dict()}

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Return the step that `to_dict` described."""
        return cls(**{**content, "distribution": Gaussian.from_dict(content["distribution"])})

    def is_last(self, settings: SmootherSettings) -> bool:
        """Whether a further step would change nothing."""
        return (
            self.unexplained < settings.linear
            and self.length < settings.still
            and self.shrinking > settings.settled
        )


def smooth(
    observation: Observation,
    start: Gaussian,
    seed: list[int],
    settings: SmootherSettings,
    recall: Recall = lambda name, calculate: calculate(),
) -> Iterator[Step]:
    """Yield step after step, until nothing changes or there are `settings.steps` of them.

    Each is a function of the one before and of (seed, number of the step).
    """
    distribution, rough = start, True
    for number in range(settings.steps):
        make = partial(_step, observation, distribution, [*seed, number], settings, rough)
        step = Step.from_dict(recall(f"{'.'.join(map(str, seed))}.{number}", make))
        yield step
        if step.is_last(settings):
            return
        distribution, rough = step.distribution, step.unexplained > 1


def _step(
    observation: Observation,
    distribution: Gaussian,
    seed: list[int],
    settings: SmootherSettings,
    rough: bool,
) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    data = observation.on_some_lines(settings.share, rng) if rough else observation
    return smoother_step(data, distribution, rng, settings).to_dict()


def smoother_step(
    observation: Observation,
    distribution: Gaussian,
    rng: np.random.Generator,
    settings: SmootherSettings,
) -> Step:
    """Draw members, simulate them, and return the posterior of the linear model through them."""
    prior, variance = observation.unknowns.prior, observation.variance
    deviation = observation.unknowns.site_deviation
    X = distribution.draw(rng, 2 * round(settings.members_per_unknown * prior.mean.size / 2))
    Y = observation.simulate(X)
    at, y, slope, residual = regression(X, Y)
    R = variance + residual
    weighted = slope / R
    information = weighted @ slope.T
    precision = np.linalg.inv(prior.covariance)
    covariance = np.asarray(np.linalg.inv(precision + information), dtype=np.float64)
    mean = covariance @ (
        precision @ prior.mean + weighted @ (observation.data - y) + information @ at
    )
    off = observation.data - y - (mean - at) @ slope
    too_far = max(1.0, float((off**2 / R).mean()))
    root = np.asarray(np.linalg.cholesky(distribution.covariance), dtype=np.float64)
    step = np.linalg.solve(root, mean - distribution.mean)
    length = float(np.sqrt((step**2).mean()))
    mean = distribution.mean + root @ step * min(1.0, settings.longest_step / max(length, 1e-9))
    least = min(length, settings.longest_step) if length > 1 else settings.least_shrinking
    shrunk = _limited(covariance * too_far, root, least)
    return Step(
        distribution=Gaussian(mean, shrunk),
        misfit=float(np.sqrt(((observation.data - y) ** 2).mean())),
        unexplained=float(np.sqrt((residual / variance).mean())),
        length=length,
        spread=deviation(shrunk),
        shrinking=deviation(shrunk) / deviation(distribution.covariance),
    )


def regression(
    X: FloatArray, Y: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Fit lines through what members (member, unknown) show (member, datum).

    Returns
    -------
    at, value : array, shapes (unknown,) and (datum,)
        The means, which lie on the lines.
    slope : array, shape (unknown, datum)
    residual : array, shape (datum,)
        Variance of what is left.
    """
    at, value = X.mean(axis=0), Y.mean(axis=0)
    slope = np.linalg.lstsq(X - at, Y - value, rcond=None)[0]
    left = Y - value - (X - at) @ slope
    degrees_of_freedom = max(1, len(X) - X.shape[1] - 1)
    return at, value, slope, np.asarray((left**2).sum(axis=0) / degrees_of_freedom)


def _limited(covariance: FloatArray, root: FloatArray, least: float) -> FloatArray:
    """Keep deviations between `least` and 1, or `least`, of those of the covariance root·rootᵀ."""
    relative = np.linalg.solve(root, np.linalg.solve(root, covariance).T)
    ratio, directions = np.linalg.eigh((relative + relative.T) / 2)
    turned = root @ directions
    return np.asarray((turned * np.clip(ratio, least**2, max(1.0, least**2))) @ turned.T)
