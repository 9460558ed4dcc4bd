"""Fig. 2: how many realizations a network needs, from measured learning curves."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.studies.trainings_table import Result

R2_AIMED_AT = 0.77
"""Of Fig. 2."""


@dataclass(frozen=True, eq=False)
class LearningCurve:
    """R² over training realizations, of one number of components.

    Parameters
    ----------
    components : int
    seeds : tuple of int
    realizations : array, shape (size,)
        Increasing.
    R2 : array, shape (seed, size)
    """

    components: int
    seeds: tuple[int, ...]
    realizations: FloatArray
    R2: FloatArray

    def crossings(self, aim: float = R2_AIMED_AT) -> FloatArray:
        """Return the realizations at which each seed's curve first reaches an R², shape (seed,).

        Linear in the logarithm of the realizations between the two sizes around it; NaN where the
        curve starts above or ends below.
        """
        return np.array([_crossing(np.log(self.realizations), R2, aim) for R2 in self.R2])


@dataclass(frozen=True)
class PowerLaw:
    """f(x) = prefactor · x^exponent, fitted on logarithmic axes, and R² of this fit."""

    prefactor: float
    exponent: float
    R2: float

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return f(x)."""
        return np.asarray(self.prefactor * x**self.exponent)


def learning_curves(results: Iterable[Result]) -> list[LearningCurve]:
    """Return the learning curves of a study's results, by increasing number of components.

    Sizes that not every seed has been trained at are left out.
    """
    by_components: dict[int, dict[int, dict[int, float]]] = {}
    for one in results:
        seeds = by_components.setdefault(one.components, {})
        seeds.setdefault(one.seed, {})[one.realizations] = one.R2
    curves = []
    for components, seeds in sorted(by_components.items()):
        sizes = sorted(set.intersection(*(set(sizes) for sizes in seeds.values())))
        R2 = np.array([[of_seed[size] for size in sizes] for of_seed in seeds.values()])
        curves.append(LearningCurve(components, tuple(seeds), np.array(sizes, dtype=float), R2))
    return curves


def realizations_needed(curves: Iterable[LearningCurve]) -> tuple[FloatArray, FloatArray]:
    """Return component counts and the realizations at their crossings, shape (count,) each.

    Geometric means over seeds. Counts of which a seed's curve does not cross are left out.
    """
    logs = {float(curve.components): np.log(curve.crossings()) for curve in curves}
    needed = {n: np.exp(of.mean()) for n, of in logs.items() if np.isfinite(of).all()}
    return np.array(list(needed)), np.array(list(needed.values()))


def resampled_needed(curves: Iterable[LearningCurve], draws: int, seed: int = 0) -> FloatArray:
    """Return `realizations_needed` for seeds drawn with replacement, shape (draw, count).

    A bootstrap within each component count (Davison and Hinkley, Bootstrap Methods, 1997).
    """
    rng = np.random.default_rng(seed)
    logs = [np.log(curve.crossings()) for curve in curves]
    means = [
        of[rng.integers(of.size, size=(draws, of.size))].mean(axis=1)
        for of in logs
        if np.isfinite(of).all()
    ]
    return np.asarray(np.exp(np.column_stack(means)))


def fit_power_law(x: FloatArray, y: FloatArray) -> PowerLaw:
    """Fit a straight line on logarithmic axes, as Fig. 2 does."""
    prefactor, exponent, R2 = power_laws(x, y)
    return PowerLaw(float(prefactor), float(exponent), float(R2))


def power_laws(x: FloatArray, Y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return prefactor, exponent and R² of the same fit, shape (…) for Y of shape (…, count)."""
    log_x, log_Y = np.log(x), np.log(Y)
    u, v = log_x - log_x.mean(), log_Y - log_Y.mean(axis=-1, keepdims=True)
    exponent = v @ u / (u @ u)
    prefactor = np.exp(log_Y.mean(axis=-1) - exponent * log_x.mean())
    return prefactor, exponent, exponent**2 * (u @ u) / (v**2).sum(axis=-1)


def _crossing(log_size: FloatArray, R2: FloatArray, aim: float) -> float:
    above = np.greater_equal(R2, aim)
    if above[0] or not above.any():
        return float("nan")
    i = int(np.argmax(above))
    share = (aim - R2[i - 1]) / (R2[i] - R2[i - 1])
    return float(np.exp(log_size[i - 1] + share * (log_size[i] - log_size[i - 1])))
