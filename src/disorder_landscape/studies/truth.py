"""The truth, which studies know: as unknowns, and beside what an inversion has found."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.stats import chi2, norm

from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset.realizations import Realization
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.problem.measurement import empty_measurement
from disorder_landscape.inference.problem.observation import Observation, objective
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.model.parameters import FloatArray


def unknowns_of(config: DatasetConfig) -> Unknowns:
    """Return the unknowns of a dataset's wires, measured on its grid and at its settings."""
    return Unknowns(Prior.of_dataset(config).for_measurement(empty_measurement(config)))


def of_realization(unknowns: Unknowns, one: Realization) -> FloatArray:
    """Return the unknowns of a realization, shape (unknown,)."""
    return of_device(unknowns, one.components, one.potential, {"alpha": one.alpha})


def of_device(
    unknowns: Unknowns,
    components: FloatArray,
    potential: FloatArray,
    parameters: Mapping[str, float],
) -> FloatArray:
    """Return the unknowns of a device that is known, shape (unknown,).

    Of a whole landscape those of the potential that is nearest to its own.
    """
    unknown = {name: x for name, x in parameters.items() if name in unknowns.parameters}
    if not unknowns.is_whole_landscape:
        named = {f"c_{n}": c for n, c in enumerate(components, start=1)}
        return unknowns.vector({**named, "mean": float(potential.mean()), **unknown})
    x = np.zeros(len(unknowns.names))
    x[: unknowns.of_disorder] = np.linalg.lstsq(unknowns.to_potential, potential, rcond=None)[0]
    for name, value in unknown.items():
        x[unknowns.names.index(name)] = unknowns.parameters[name].standard(value)
    return x


def labels(unknowns: Unknowns, x: FloatArray) -> FloatArray:
    """Return the unknowns by their names, in their units, shape (…, unknown); of components."""
    mean = unknowns.potential(x).mean(axis=-1)
    others = [unknowns.parameter(name, x) for name in unknowns.parameters]
    of_device = np.stack([mean, *others], axis=-1)
    return np.concatenate([unknowns.components(x), of_device], axis=-1)


def site_distance(unknowns: Unknowns, x: FloatArray, other: FloatArray) -> float:
    """Return the root-mean-square difference of two potentials in meV."""
    return unknowns.site_std(np.outer(x - other, x - other))


def shape_std(unknowns: Unknowns, covariance: FloatArray) -> float:
    """Return the standard deviation of V less its mean in meV, root mean square over the sites."""
    n, L = unknowns.of_disorder, unknowns.to_potential
    L = L - L.mean(axis=0)
    mean_square = np.einsum("si,ij,sj->", L, covariance[:n, :n], L) / len(L)
    return float(np.sqrt(max(0.0, mean_square)))


def more_probable(observation: Observation, found: Outcome, truth: FloatArray) -> float:
    """Return how much of the posterior is more probable than the truth (unknown,).

    Over wires it is uniform if the posteriors are right, all unknowns at once. `coverage` does not
    see correlations, nor a single wrong axis.
    """
    height = objective(observation, truth, observation.simulate(truth[None])[0])
    return more_probable_than(float(height), found)


def more_probable_than(height: float, found: Outcome) -> float:
    """Return how much of the posterior is more probable than this −2 log of its density.

    With samples this is right whatever the posterior's shape, and without where it is normal about
    the best optimum. NaN if the samples are those of a wider distribution.
    """
    drawn = found.importance_samples
    if drawn is None:
        return float(chi2.cdf(height - found.best.objective, found.best.answer.mean.size))
    if drawn.height is None or drawn.power < 1:
        return float(np.nan)
    return float(drawn.weight[drawn.height < height].sum())


def z_scores(found: Outcome, truth: FloatArray) -> FloatArray:
    """Return the standard normal deviates of the truth's quantiles, shape (unknown,).

    They are normally distributed over measurements if the posteriors are right, whatever their
    shape. Of a normal distribution they are the distances from the mean in standard deviations.
    """
    drawn, answer = found.importance_samples, found.answer
    if drawn is None:
        return np.asarray((truth - answer.mean) / np.sqrt(np.diag(answer.covariance)))
    least = 0.5 / drawn.effective_sample_size
    return np.asarray(norm.ppf((drawn.weight @ (drawn.samples < truth)).clip(least, 1 - least)))
