"""Ridge regression of the unknowns on the data, and how far it is off."""

from __future__ import annotations

import numpy as np
from sklearn.covariance import ledoit_wolf

from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.network_features import Said
from disorder_landscape.model.parameters import FloatArray

RIDGES = np.logspace(-1, 1.5, 6)
"""Strengths of the ridge to choose from, in units of the noise and of what lines leave."""


def variance_about_lines(X: FloatArray, Y: FloatArray, weight: FloatArray) -> FloatArray:
    """Return the variance (datum,) of Y (sample, datum) about linear functions of X.

    Parameters
    ----------
    X, Y : array, shapes (sample, unknown) and (sample, datum)
    weight : array, shape (sample,)
    """
    total, root = weight.sum(), np.sqrt(weight)[:, None]
    X, Y = X - weight @ X / total, Y - weight @ Y / total
    slope = np.linalg.lstsq(root * X, root * Y, rcond=None)[0]
    left = weight @ (Y - X @ slope) ** 2 / total
    effective = total**2 / (weight**2).sum()
    return np.asarray(left * effective / max(1.0, effective - X.shape[1] - 1))


def learn(
    observation: Observation,
    z: FloatArray,
    Y: FloatArray,
    left: FloatArray,
    weight: FloatArray,
    said: Said | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Learn what samples z (sample, unknown) are from what they show, Y (sample, datum).

    Ridge regression in the space of the samples, on data in units of their noise and of what lines
    leave of them, `left` (datum,). The samples show no noise of their own: what the measurement's
    does to the answer is known without drawing any. What a network says of them, and of the
    measurement, is regressed on as well, with as much weight as all data that lines leave as they
    are: far away it counts, near the answer hardly.

    Parameters
    ----------
    observation : Observation
    z, Y : array, shapes (sample, unknown) and (sample, datum)
    left : array, shape (datum,)
    weight : array, shape (sample,)
    said : Said, optional

    Returns
    -------
    at : array, shape (unknown,)
        What the measurement's are.
    error : array, shape (unknown, unknown)
        Mean product of the errors for samples that were left out, and shown with noise.
    """
    total, root = weight.sum(), np.sqrt(weight)[:, None]
    middle, center = weight @ Y / total, weight @ z / total
    scale = np.sqrt(observation.variance + left)
    A, target = root * (Y - middle) / scale, root * (z - center)
    of_noise = (A * (observation.variance / scale**2)) @ A.T
    kernel, shown = A @ A.T, A @ ((observation.data - middle) / scale)
    if said is not None:
        mean = weight @ said.of_samples / total
        deviation = np.sqrt(weight @ (said.of_samples - mean) ** 2 / total)
        varies = deviation > 1e-6 * np.abs(mean)  # of one that does not, rounding is left
        unit = deviation[varies] * np.sqrt(mean.size / middle.size)
        W = root * (said.of_samples - mean)[:, varies] / unit
        kernel, shown = kernel + W @ W.T, shown + W @ ((said.of_data - mean)[varies] / unit)
    values, vectors = np.linalg.eigh(kernel)
    along = vectors.T @ target
    found: list[tuple[FloatArray, FloatArray, FloatArray]] = []
    for ridge in total * RIDGES:
        slope = vectors @ (along / (values + ridge)[:, None])
        own = ridge * (vectors**2 @ (1 / (values + ridge))) - weight / total
        left_out = ridge * slope / own[:, None]
        found.append((slope, left_out / np.sqrt(total), slope.T @ of_noise @ slope))
    slope, left_out, noise = min(found, key=lambda one: (one[1] ** 2).sum() + np.trace(one[2]))
    return np.asarray(center + shown @ slope), sum_of_products(left_out) + noise


def sum_of_products(errors: FloatArray) -> FloatArray:
    """Return the sum (unknown, unknown) of the products of samples' errors (sample, unknown).

    Its eigenvalues are farther apart than those of what it stands for, the mean over all samples
    that could have been drawn: the direction that seems to be known best is so by chance. Drawn
    together as Ledoit and Wolf do (J. Multivar. Anal. 88, 365 (2004)), they lose no truth there.
    """
    return np.asarray(ledoit_wolf(np.sqrt(len(errors)) * errors, assume_centered=True)[0])
