"""Ridge regression of the unknowns on the data, and its error."""

from __future__ import annotations

import numpy as np
from sklearn.covariance import ledoit_wolf

from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.network_features import Features
from disorder_landscape.model.parameters import FloatArray

RIDGES = np.logspace(-1, 1.5, 6)
"""Strengths of the ridge to choose from; the data are in units of their noise and residual."""


def residual_variance(X: FloatArray, Y: FloatArray, weight: FloatArray) -> FloatArray:
    """Return the variance (datum,) of the residuals of a linear fit of Y (sample, datum) to X.

    Parameters
    ----------
    X, Y : array, shapes (sample, unknown) and (sample, datum)
    weight : array, shape (sample,)
    """
    total, root = weight.sum(), np.sqrt(weight)[:, None]
    X, Y = X - weight @ X / total, Y - weight @ Y / total
    slope = np.linalg.lstsq(root * X, root * Y, rcond=None)[0]
    residual = weight @ (Y - X @ slope) ** 2 / total
    effective = total**2 / (weight**2).sum()
    return np.asarray(residual * effective / max(1.0, effective - X.shape[1] - 1))


def ridge_regression(
    observation: Observation,
    z: FloatArray,
    Y: FloatArray,
    residual: FloatArray,
    weight: FloatArray,
    features: Features | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Regress the unknowns z of samples on their data Y, and predict those of the measurement.

    The data are in units of their noise and of the `residual` of a linear fit to them. The
    regression is done in the space of the samples, which are fewer than the data. The samples' data
    have no noise. What the noise of the measurement does to the prediction is added in closed form.

    Features from a network are regressed on as well. Together they weigh as much as all data do
    where a linear fit explains nothing. So they matter far from the answer, and hardly near it.

    Parameters
    ----------
    observation : Observation
    z, Y : array, shapes (sample, unknown) and (sample, datum)
    residual : array, shape (datum,)
        `residual_variance` of the data.
    weight : array, shape (sample,)
    features : Features, optional

    Returns
    -------
    predicted : array, shape (unknown,)
        The unknowns of the measurement.
    error : array, shape (unknown, unknown)
        Mean product of the errors for samples that are left out of the regression, with noise.
    """
    total, root = weight.sum(), np.sqrt(weight)[:, None]
    mean_of_Y, center = weight @ Y / total, weight @ z / total
    scale = np.sqrt(observation.variance + residual)
    A, target = root * (Y - mean_of_Y) / scale, root * (z - center)
    of_noise = (A * (observation.variance / scale**2)) @ A.T
    kernel, of_data = A @ A.T, A @ ((observation.data - mean_of_Y) / scale)
    if features is not None:
        mean = weight @ features.of_samples / total
        std = np.sqrt(weight @ (features.of_samples - mean) ** 2 / total)
        varies = std > 1e-6 * np.abs(mean)  # a constant feature is left with rounding errors
        unit = std[varies] * np.sqrt(mean.size / mean_of_Y.size)
        W = root * (features.of_samples - mean)[:, varies] / unit
        kernel = kernel + W @ W.T
        of_data = of_data + W @ ((features.of_data - mean)[varies] / unit)
    values, vectors = np.linalg.eigh(kernel)
    along = vectors.T @ target
    found: list[tuple[FloatArray, FloatArray, FloatArray]] = []
    for ridge in total * RIDGES:
        slope = vectors @ (along / (values + ridge)[:, None])
        own = ridge * (vectors**2 @ (1 / (values + ridge))) - weight / total
        left_out = ridge * slope / own[:, None]
        found.append((slope, left_out / np.sqrt(total), slope.T @ of_noise @ slope))
    slope, left_out, noise = min(found, key=lambda one: (one[1] ** 2).sum() + np.trace(one[2]))
    return np.asarray(center + of_data @ slope), error_covariance(left_out) + noise


def error_covariance(errors: FloatArray) -> FloatArray:
    """Return the sum (unknown, unknown) of the products of samples' errors (sample, unknown).

    Of few samples the eigenvalues are farther apart than those of the true covariance: the smallest
    is too small by chance, and with it the error of the direction that seems to be known best.
    Shrinkage after Ledoit and Wolf (J. Multivar. Anal. 88, 365 (2004)) corrects that.
    """
    return np.asarray(ledoit_wolf(np.sqrt(len(errors)) * errors, assume_centered=True)[0])
