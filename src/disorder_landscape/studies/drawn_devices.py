"""Devices that are drawn from a prior, and their measurements, for studies of inversions.

Conductances are averaged by quadrature, which is another route than the inversion's own, and have
errors. Devices and errors are functions of prior, grid, noise and seed alone.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from disorder_landscape.config import Positive
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.problem.noise import noise_of_channels
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.unknowns import Device, Unknowns
from disorder_landscape.model.disorder import mean_reduction, smooth_noise
from disorder_landscape.model.parameters import B_MAX, BIAS, TEMPERATURE, FloatArray, Nanowire
from disorder_landscape.studies.fresh_wires import SEED, exact_conductances
from disorder_landscape.studies.study import Part
from disorder_landscape.studies.truth import of_device


class Grid(Part):
    """Where devices are measured."""

    mu: tuple[float, float, Positive]
    """Least and largest value of the measured axis, and number of points."""
    B_points: Positive
    """Between zero and the paper's largest field."""
    biases: Positive
    """Between the paper's largest ones."""

    @property
    def points(self) -> dict[str, Any]:
        """These fields, as JSON may hold them."""
        return self.model_dump(mode="json", include=set(Grid.model_fields))

    @property
    def grid(self) -> Measurement:
        """What is measured, all conductances zero."""
        low, high, points = self.mu
        mu, B = np.linspace(low, high, points), np.linspace(0, B_MAX, self.B_points)
        bias = np.linspace(BIAS[0], BIAS[-1], self.biases)
        G = np.zeros((mu.size, B.size, bias.size, 4))
        return Measurement(G, mu, B, bias, 0.0, Nanowire.barrier, TEMPERATURE)


def seed_of(name: str, index: int) -> list[int]:
    """Return the seed of a device of a group of this name."""
    return [SEED, zlib.crc32(name.encode()), index]


def drawn_device(
    unknowns: Unknowns, grid: Measurement, seed: Sequence[int]
) -> tuple[Device, FloatArray]:
    """Return a device of the prior, as it is measured, and its unknowns (unknown,).

    The disorder of a whole landscape is drawn from the noise itself; the unknowns then are those
    of the potential that is nearest to it.
    """
    rng, given = np.random.default_rng(seed), unknowns.prior
    x = rng.normal(size=len(unknowns.names))
    device = unknowns.devices(x[None], grid)[0]
    if not unknowns.is_whole_landscape:
        return device, x
    disorder = (given.correlation_length, "sum", given.amplitude)
    V = smooth_noise(rng, given.sites, *disorder)
    V = V - V.mean() * (1 - mean_reduction(given.sites, *disorder, given.mean_std))
    parameters = {name: float(unknowns.parameter(name, x)) for name in unknowns.parameters}
    wire = replace(device.wire, potential=V)
    return Device(wire, device.setup), of_device(unknowns, np.empty(0), V, parameters)


def measured_device(
    device: Device, unknowns: Unknowns, grid: Measurement, noise: float, seed: Sequence[int]
) -> Observation:
    """Return the measurement of a device, with errors."""
    setup = device.setup
    G = exact_conductances(device.wire, setup.mu, grid.B, setup.bias, setup.temperature)
    errors = noise * np.random.default_rng([*seed, 1]).normal(size=G.shape)
    return Observation(replace(grid, G=G + errors), unknowns, noise_of_channels(noise))
