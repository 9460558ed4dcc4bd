"""What the benchmark takes the time of, and the memory: each a function that measures once."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from itertools import islice
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset import shards
from disorder_landscape.model.parameters import BIAS, TEMPERATURE, FloatArray, Nanowire
from disorder_landscape.observables.conductance import conductance
from disorder_landscape.observables.density_of_states import local_density_of_states
from disorder_landscape.observables.gradient import conductance_gradient
from disorder_landscape.observables.modes import modes
from disorder_landscape.solver import compiled, kwant_reference
from disorder_landscape.solver.routes import thermal_average

ENERGIES = np.linspace(0.001, 0.08, 16)
"""In meV, for the times per energy."""
BIASES = np.array(BIAS)
"""In meV, for the times per set of one μ and B."""

DENSITY = np.linspace(-0.1, 0.1, 201)
"""Energies of a local density of states, in meV."""

Stopwatch = Callable[[], float]
"""Takes the time of one call and returns the seconds per energy, per bias or per set."""


def kwant(wire: Nanowire, mu: FloatArray, B: FloatArray) -> Stopwatch:
    """Time Kwant, per energy, with every advantage it offers.

    The system is finalised once, lead modes are computed once for all μ, and neither is counted;
    on one thread it is fastest for a chain.
    """

    def watch() -> float:
        matrices = kwant_reference.scattering_matrices(wire, mu, B[B.size // 2 :], ENERGIES[7:8])
        next(matrices)  # builds the system and computes the modes
        rest = islice(matrices, mu.size - 1)
        return _seconds(lambda: [kwant_reference.conductances(s) for _, s in rest]) / (mu.size - 1)

    return watch


def bare(wire: Nanowire, mu: FloatArray, B: FloatArray, omega: FloatArray = ENERGIES) -> Stopwatch:
    """Time the bare conductance, per energy."""
    count = mu.size * B.size * omega.size
    return lambda: _seconds(lambda: compiled.bare_conductance([wire], mu, B, omega)) / count


def gradient(wire: Nanowire, mu: FloatArray, B: FloatArray) -> Stopwatch:
    """Time the derivatives of the bare conductances, per (μ, B, bias)."""
    count = mu.size * B.size * BIASES.size
    return lambda: _seconds(lambda: conductance_gradient(wire, mu, B, BIASES, 0.0)) / count


def thermal_gradient(wire: Nanowire, mu: FloatArray, B: FloatArray) -> Stopwatch:
    """Time all derivatives at the paper's temperature, per (μ, B)."""
    point = mu, B, BIASES, TEMPERATURE
    return lambda: _seconds(lambda: conductance_gradient(wire, *point)) / (mu.size * B.size)


def energy_grid(wire: Nanowire, mu: FloatArray, B: FloatArray, spacing: float) -> Stopwatch:
    """Time the thermal average over a grid of energies, per (μ, B)."""

    def average() -> object:
        return conductance(wire, mu, B, BIASES, TEMPERATURE, energy_spacing=spacing)

    return lambda: _seconds(average) / (mu.size * B.size)


def sets(
    wires: list[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    threads: int = 1,
    temperature: float = TEMPERATURE,
    theta: float = 0.0,
) -> Stopwatch:
    """Time the exact thermal average, per (wire, μ, B), on so many threads."""

    def average() -> None:
        with compiled.threads_at_work(threads):
            thermal_average(wires, mu, B, BIASES, temperature, theta)

    return lambda: _seconds(average) / (len(wires) * mu.size * B.size)


def density(wire: Nanowire, mu: FloatArray, B: FloatArray) -> Stopwatch:
    """Time the local density of states of DENSITY energies at TEMPERATURE, per (μ, B)."""

    def look() -> object:
        return local_density_of_states(wire, mu, B, DENSITY, TEMPERATURE)

    return lambda: _seconds(look) / (mu.size * B.size)


def levels(wire: Nanowire, mu: FloatArray, B: FloatArray) -> Stopwatch:
    """Time the lowest two levels, per (μ, B)."""
    return lambda: _seconds(lambda: compiled.levels([wire], mu, B, 2)) / (mu.size * B.size)


def lowest_modes(wire: Nanowire, mu: FloatArray, B: FloatArray) -> Stopwatch:
    """Time the lowest two modes with their wave functions, per (μ, B)."""
    points = [(m, b) for m in mu.tolist() for b in B.tolist()]
    return lambda: _seconds(lambda: [modes(wire, *point, 2) for point in points]) / len(points)


def _seconds(action: Callable[[], object]) -> float:
    start = time.perf_counter()
    action()
    return time.perf_counter() - start


def peak_memory(config: DatasetConfig) -> float:
    """Return the most memory in MiB that a fresh process holds while it generates a dataset.

    Linux says so in VmHWM; what `getrusage` says counts the process from which it was started too.
    """
    with ProcessPoolExecutor(1, get_context("spawn"), _on_one_thread) as pool:
        return pool.submit(_generate_and_look, config).result()


def _on_one_thread() -> None:
    compiled.core.set_threads(1)


def _generate_and_look(config: DatasetConfig) -> float:
    with TemporaryDirectory() as folder:
        shards.generate(config, Path(folder))
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM:"))
