"""Whether the posterior of an inversion predicts further data."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from disorder_landscape.inference.inferred import Sample
from disorder_landscape.inference.problem.measurement import Measurement, simulated
from disorder_landscape.inference.problem.noise import errors_variance
from disorder_landscape.model.parameters import FloatArray


def predictive_p(
    Y: FloatArray, data: FloatArray, variance: FloatArray, rng: np.random.Generator
) -> float:
    """Return the posterior predictive p-value of further data.

    It is that of χ² (Gelman, Meng and Stern, Stat. Sinica 6, 733 (1996)): the probability that the
    posterior makes data which are as far from its mean prediction as these, or farther. The
    samples' simulated data at the new settings are given errors, and the measured data are counted
    among them. Data in which the samples differ weigh less.

    Parameters
    ----------
    Y : array, shape (sample, datum)
        Simulated data of posterior samples.
    data, variance : array, shape (datum,)
        Data that the inversion does not use, K'_full of S-II.1, and the variance of their errors.
    rng : Generator
    """
    replicates = Y + np.sqrt(variance) * rng.normal(size=Y.shape)
    mean, both = Y.mean(axis=0), Y.var(axis=0, ddof=1) + variance
    chi_square = ((np.vstack([data, replicates]) - mean) ** 2 / both).sum(axis=1)
    return float((chi_square >= chi_square[0]).mean())


def p_of_samples(
    samples: Sequence[Sample],
    measured: Sequence[Measurement],
    noise: FloatArray,
    rng: np.random.Generator,
    progress: Callable[[int], None],
) -> float:
    """Return `predictive_p` of an inversion's samples, each with its own mean of V; NaN of none."""
    if not samples:
        return np.nan
    Y = []
    for k, m in enumerate(measured):
        each = []
        for sample in samples:
            at = sample.measured[k]
            each.append(simulated(replace(sample.wire, barrier=at.barrier), at).ravel())
            progress(m.mu.size * m.B.size)
        Y.append(each)
    data = np.concatenate([m.G.ravel() for m in measured])
    there = np.isfinite(data)
    variance = [
        np.broadcast_to(errors_variance(errors), m.G.shape).ravel()
        for errors, m in zip(noise, measured, strict=True)
    ]
    found = np.concatenate(Y, axis=1)[:, there]
    return predictive_p(found, data[there], np.concatenate(variance)[there], rng)
