"""Odd wires, over the whole range of every parameter, and where they are measured."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from disorder_landscape.model.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.model.ranges import PARAMETER_RANGES
from disorder_landscape.solver.compiled import core
from disorder_landscape.solver.routes import BELOW_GAP


class Case(NamedTuple):
    """A wire and where it is measured."""

    wire: Nanowire
    mu: FloatArray
    B: FloatArray
    theta: float


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a number whose logarithm is uniform."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _potential(rng: np.random.Generator, largest: float) -> FloatArray:
    """Draw a potential: none, noise, a step, or a few bumps."""
    many = rng.integers(100, 301) if rng.random() < 0.1 else rng.integers(2, 100)
    V = np.zeros(int(many))
    height = log_uniform(rng, 1e-3, largest) * rng.choice([-1, 1])
    kind = rng.integers(4)
    if kind == 1:
        V = np.clip(rng.normal(0.0, abs(height) / 3, V.size), -1e3, 1e3)
    elif kind == 2:
        V[rng.integers(V.size) :] = height
    elif kind == 3:
        V[rng.integers(0, V.size, 3)] = height
    return V


def any_case(seed: int, index: int) -> Case:
    """Draw a wire over the whole range of every parameter; half of all values are the paper's."""
    rng = np.random.default_rng([seed, 0, index])
    chosen: dict[str, Any] = {}
    for name, (low, high, _) in PARAMETER_RANGES.items():
        if name in ("critical_field", "parent_dissipation"):  # the one makes another gap only
            continue
        kind = rng.integers(6)
        if name == "dissipation" and kind < 5:
            continue
        if kind == 0:
            chosen[name] = log_uniform(rng, max(low, 1e-6 * high), high)
            if low < 0 and rng.random() < 0.3:
                chosen[name] *= -1
        elif kind == 1:
            chosen[name] = float(rng.uniform(low, high))
        elif kind == 2 and name not in ("mass", "lattice", "delta0"):
            chosen[name] = max(low, 0.0)
    barrier = tuple(rng.choice([0.0, 15.0, rng.uniform(-1e3, 1e3)], 2))
    wire = Nanowire(_potential(rng, 1e3), barrier=barrier, **chosen)
    mu = rng.choice([0.0, rng.uniform(0, 0.6), rng.uniform(-5, 50), rng.uniform(-1e3, 1e3)])
    B = rng.choice([0.0, rng.uniform(0, 0.8), log_uniform(rng, 1e-17, 100), -rng.uniform(0, 1)])
    theta = rng.choice([0.0, 0.0, np.pi / 2, rng.uniform(-6, 6)])
    return Case(wire, np.array([mu]), np.array([B]), float(theta))


def any_energy(seed: int, index: int) -> FloatArray:
    """Draw the energy in meV of a wire of `any_case`: above the gap, at zero, nearly so, or any."""
    rng, gap = np.random.default_rng([seed, 1, index]), any_case(seed, index).wire.delta0
    if rng.random() < 0.2:
        return np.array([(1 + log_uniform(rng, 1e-3, 2)) * gap])
    return np.array([rng.choice([0.0, 1e-9, rng.uniform(0, 1)]) * gap])


def warm_case(seed: int, index: int) -> tuple[Case, FloatArray, float]:
    """Draw a wire of parameters within some orders of the paper's, biases and a temperature."""
    rng = np.random.default_rng([seed, 2, index])
    sites = int(rng.choice([int(rng.integers(2, 100)), 300, int(rng.integers(100, 700))]))
    V = _potential(rng, 3.0)
    wire = Nanowire(
        np.resize(V, sites),
        alpha=rng.choice([8.0, 2.0, rng.uniform(0, 40)]),
        g=rng.choice([25.0, rng.uniform(0, 60)]),
        gamma=rng.choice([0.15, 0.5, rng.uniform(0, 1)]),
        delta0=rng.choice([0.12, rng.uniform(0.1, 0.5)]),
        mass=rng.choice([0.03, log_uniform(rng, 0.01, 0.3)]),
        barrier=tuple(rng.choice([0.0, 15.0, rng.uniform(0, 300)], 2)),
        lead_mu=rng.choice([25.0, rng.uniform(0.5, 60)]),
        lead_alpha=rng.choice(np.array([None, 0.0, rng.uniform(0, 30)])),
    )
    temperature = float(rng.choice([0.02, 0.05, 0.06]))
    most = BELOW_GAP * wire.delta0 - core.REACH * BOLTZMANN * temperature
    bias = np.sort(rng.uniform(-most, most, 3))
    theta = float(rng.choice([0.0, 0.0, 0.0, 0.0, rng.uniform(-3, 3)]))
    mu, B = np.array([rng.uniform(0, 0.6)]), np.array([rng.uniform(0, 1) * (rng.random() < 0.95)])
    return Case(wire, mu, B, theta), bias, temperature
