"""Whether the posterior of an inversion predicts further data."""

from __future__ import annotations

import numpy as np

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
