"""Maps of wires that an inversion has found: T_IV, and shares of them with a gap or topological."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.unknowns import Device, share_settings
from disorder_landscape.model.parameters import FloatArray, gap_in_field
from disorder_landscape.observables.visibility import topological_visibility
from disorder_landscape.solver import routes

MAP_POINTS = 61, 81
"""Of the maps of T_IV and P(topological), along μ and B."""
GAPS = 49
"""Energies from zero to the gap of the parent for which P_gap is given."""


def _closed_devices(observation: Observation, X: FloatArray, mu: FloatArray) -> list[Device]:
    """Return the devices of samples at other values of the measured axis, without dissipation.

    Only such wires have T_IV and levels.
    """
    devices = observation.unknowns.devices(X, replace(observation.measurement, mu=mu))
    return [
        one._replace(wire=replace(one.wire, dissipation=0.0, parent_dissipation=0.0))
        for one in devices
    ]


def visibility(
    observation: Observation, X: FloatArray, maps: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Return T_IV of samples on a grid of the measured axis and B, shape (sample, lead, mu, B)."""
    devices, theta = _closed_devices(observation, X, maps[0]), observation.measurement.theta
    if share_settings(devices):
        wires, mu = [device.wire for device in devices], devices[0].setup.mu
        return topological_visibility(wires, mu, maps[1], theta=theta).to_numpy()
    each = [
        topological_visibility(one.wire, one.setup.mu, maps[1], theta=theta).to_numpy()
        for one in devices
    ]
    return np.stack(each)


def gap_energies(observation: Observation) -> FloatArray:
    """Return energies from zero to the largest gap that the parent may have, in meV."""
    return np.linspace(0.0, observation.unknowns.prior.extremes("delta0")[1], GAPS)


def gap_probability(observation: Observation, X: FloatArray, gaps: FloatArray) -> FloatArray:
    """Return the share of samples whose lowest excitation is above each energy (gap, mu, B)."""
    m = observation.measurement
    above = np.zeros((gaps.size, m.mu.size, m.B.size))
    of_samples = visibility(observation, X, (m.mu, m.B))[:, 0]
    for device, T_IV in zip(_closed_devices(observation, X, m.mu), of_samples, strict=True):
        levels = routes.levels([device.wire], device.setup.mu, m.B, 2, m.theta)[0]
        gap, critical_field = device.wire.delta0, device.wire.critical_field
        parent = np.array([[gap_in_field(gap, critical_field, one)] for one in m.B])
        levels = np.where(np.isnan(levels), parent, levels)
        excitation = np.where(T_IV < 0, levels[..., 1], levels[..., 0])
        above += excitation > gaps[:, None, None]
    return above / len(X)


def fine_grids(mu: FloatArray, B: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return fine grids of the measured axis and of B over the range of the measurement."""
    fine_mu, fine_B = (
        np.linspace(axis[0], axis[-1], points) if axis.size > 1 else axis
        for axis, points in zip((mu, B), MAP_POINTS, strict=True)
    )
    return fine_mu, fine_B
