"""The data that an inversion explains, their errors, their simulation, and the likelihood."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.inference.problem.measurement import Measurement, simulated
from disorder_landscape.inference.problem.noise import SOLVER_ERROR, errors_variance
from disorder_landscape.inference.problem.unknowns import Unknowns, share_settings
from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.solver import gradients
from disorder_landscape.solver.rough_gradient import roughly_by_potential

TRUSTED = 1e-2
"""Derivatives with a larger estimated error, as a share of the largest of their (μ, B), are not
used: one in a hundred at 50 and at 300 mK. (With all of them one answer of ten at 0.001 e²/h had
error bars that were half of what they should be along one direction. At B = 0, where poles are
equal, the estimate is mostly 1e-3 to 5e-3, and nine sets were within 2e-4.)"""
DRAWS_OF_LINES = 10
"""Of some of the data, where many are missing."""
POINTS_AT_ONCE = 4
"""Chemical potentials at which derivatives by all sites are in memory together."""


class Slopes(NamedTuple):
    """Data (datum,), and their derivatives (unknown, datum)."""

    data: FloatArray
    slope: FloatArray
    doubt: FloatArray
    """The estimated errors of the derivatives, in units of those up to which they are trusted,
    shape (mu, B). Infinite where the data are not exact."""


@dataclass(frozen=True, eq=False)
class Observation:
    """What was measured, as one vector of data, and how to simulate it.

    Parameters
    ----------
    measurement : Measurement
        NaN where nothing was measured.
    unknowns : Unknowns
    noise : array, shape (channel,)
        Standard deviations of the errors in e²/h.
    """

    measurement: Measurement
    unknowns: Unknowns
    noise: FloatArray

    @property
    def is_measured(self) -> NDArray[np.bool_]:
        """Which conductances were measured, shape (mu, B, bias, channel)."""
        return np.isfinite(self.measurement.G)

    @property
    def data(self) -> FloatArray:
        """In e²/h, shape (datum,)."""
        return np.asarray(self.measurement.G[self.is_measured])

    @property
    def channel(self) -> NDArray[np.int64]:
        """Which channel each datum is of, shape (datum,)."""
        channel = np.broadcast_to(np.arange(len(CONDUCTANCES)), self.measurement.G.shape)
        return np.asarray(channel[self.is_measured])

    @property
    def variance(self) -> FloatArray:
        """Of the data's errors in (e²/h)², shape (datum,), the solver's included."""
        return np.asarray(errors_variance(self.noise)[self.channel])

    def simulate(self, X: FloatArray) -> FloatArray:
        """Return simulated data of samples X (sample, unknown), shape (sample, datum)."""
        return np.asarray(self.conductances(X)[:, self.is_measured])

    def on_some_lines(self, share: float, fewest: int, rng: np.random.Generator) -> Observation:
        """Return an observation of random lines of μ and B, which hold this share of the data.

        Lines on which nothing was measured do not count. Grids of up to so many lines stay whole,
        and those with such gaps that no lines of several draws hold half of that share.
        """
        axes = [self._measured_along(axis) for axis in range(2)]
        counts = [max(min(fewest, n), round(n * np.sqrt(share))) for n in map(len, axes)]
        for _ in range(DRAWS_OF_LINES):
            mu, B = _drawn(axes, counts, rng)
            part = self.at(mu, B, np.arange(self.measurement.bias.size))
            if part.data.size >= share * self.data.size / 2:
                return part
        return self

    def on_few_points(self, *counts: int) -> Observation:
        """Return an observation of so many points of μ, B and bias at most, evenly spread.

        Points at which nothing was measured do not count.
        """
        axes = []
        for axis, count in enumerate(counts):
            measured = self._measured_along(axis)
            few = np.linspace(0, measured.size - 1, min(count, measured.size))
            axes.append(measured[few.round().astype(int)])
        return self.at(*axes)

    def on_random_points(
        self, highest: float, counts: Sequence[int], rng: np.random.Generator
    ) -> Observation:
        """Return an observation of random points of μ, B and bias, of the highest μ only.

        Parameters
        ----------
        highest : float
            Which share of the lines of μ counts. Points at which nothing was measured do not.
        counts : sequence of int
            How many points of each axis there are, but no more than half of them.
        rng : Generator
        """
        axes = [self._measured_along(axis) for axis in range(3)]
        upwards = axes[0][np.argsort(self.measurement.mu[axes[0]])]
        axes[0] = upwards[-int(np.ceil(highest * upwards.size)) :]
        most = [min(n, (axis.size + 1) // 2) for axis, n in zip(axes, counts, strict=True)]
        return self.at(*_drawn(axes, most, rng))

    def _measured_along(self, axis: int) -> NDArray[np.int64]:
        """Return at which points of μ, B or bias, the first three axes, anything was measured."""
        others = tuple({0, 1, 2, 3} - {axis})
        return np.flatnonzero(self.is_measured.any(axis=others))

    def at(
        self, mu: NDArray[np.int64], B: NDArray[np.int64], bias: NDArray[np.int64]
    ) -> Observation:
        """Return an observation of what was measured at the points of these indices."""
        m = self.measurement
        some = replace(m, G=m.G[np.ix_(mu, B, bias)], mu=m.mu[mu], B=m.B[B], bias=m.bias[bias])
        return replace(self, measurement=some)

    def conductances(self, X: FloatArray) -> FloatArray:
        """Return conductances of samples in e²/h, shape (sample, mu, B, bias, channel)."""
        devices = self.unknowns.devices(X, self.measurement)
        if share_settings(devices):
            wires = [device.wire for device in devices]
            return simulated(wires, devices[0].as_set_up(self.measurement))
        return np.stack([simulated(one.wire, one.as_set_up(self.measurement)) for one in devices])

    def closed_form_slopes(self, x: FloatArray, roughly: bool = False) -> Slopes | None:
        """Return the data and their derivatives at x (unknown,), in closed form.

        None where the closed form does not reach: in tilted fields, at T = 0 and above 1 K, and
        where the wire leaks without its parent. Roughly, derivatives are within a few percent where
        V alone is unknown, in half of the time.
        """
        device = self.unknowns.devices(x[None], self.measurement)[0]
        wire, at = device.wire, device.as_set_up(self.measurement)
        if at.theta != 0 or not gradients.has_closed_form(wire, at.bias, at.temperature):
            return None
        G, slopes, doubt, by = [], [], [], self.unknowns.derivatives
        for first in range(0, at.mu.size, POINTS_AT_ONCE):
            some = slice(first, first + POINTS_AT_ONCE)
            points = wire, at.mu[some], at.B, at.bias, at.temperature
            if roughly and by == ["V"]:
                found = roughly_by_potential(*points)
            else:
                found = gradients.at_a_temperature(*points, by, complete=False)
            part = replace(self.measurement, mu=self.measurement.mu[some])
            G.append(found.conductance)
            slopes.append(np.nan_to_num(self.unknowns.slopes(x, part, found.by)))
            exact = found.error <= SOLVER_ERROR
            doubt.append(np.where(exact, found.gradient_error / TRUSTED, np.inf))
        slope = np.concatenate(slopes)[self.is_measured].T
        return Slopes(np.concatenate(G)[self.is_measured], slope, np.concatenate(doubt))

    def of_set(self, mu: int, B: int) -> tuple[Observation, NDArray[np.int64]]:
        """Return the observation of one (μ, B), and the places of its data, shape (datum,)."""
        measured = self.is_measured
        place = np.cumsum(measured).reshape(measured.shape) - 1
        all_biases = np.arange(self.measurement.bias.size)
        of_one = place[mu, B][measured[mu, B]]
        return self.at(np.array([mu]), np.array([B]), all_biases), of_one

    def misfit(self, y: FloatArray) -> FloatArray:
        """Return root-mean-square misfits in e²/h, shape (channel,); NaN without data."""
        squares = (y - self.data) ** 2
        count = np.bincount(self.channel, minlength=len(CONDUCTANCES))
        total = np.bincount(self.channel, squares, minlength=len(CONDUCTANCES))
        mean = np.divide(total, count, out=np.full(count.size, np.nan), where=count > 0)
        return np.asarray(np.sqrt(mean))


def _drawn(
    axes: Sequence[NDArray[np.int64]], counts: Sequence[int], rng: np.random.Generator
) -> list[NDArray[np.int64]]:
    """Return so many of each axis' points, drawn without replacement, in their order."""
    return [
        np.sort(rng.choice(axis, n, replace=False)) for axis, n in zip(axes, counts, strict=True)
    ]


def overall_misfit(observation: Observation, y: FloatArray) -> float:
    """Return the root-mean-square misfit of simulated data (datum,), all channels, in e²/h."""
    return float(np.sqrt(((observation.data - y) ** 2).mean()))


def squared_misfits(observation: Observation, Y: FloatArray) -> FloatArray:
    """Return squared misfits of simulated data (…, datum) in units of the errors' variance."""
    return np.asarray((Y - observation.data) ** 2 / observation.variance)


def objective(observation: Observation, X: FloatArray, Y: FloatArray) -> FloatArray:
    """Return −2 log of the posterior density of samples X (…, unknown), up to a constant.

    Parameters
    ----------
    observation : Observation
    X, Y : array, shapes (…, unknown) and (…, datum)
        Samples, and their simulated data.
    """
    likelihood = squared_misfits(observation, Y).sum(axis=-1)
    return np.asarray(likelihood + observation.unknowns.white_noise.squared_distance(X))
