"""How fast the solvers are and how much memory they need, all measured in one run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from disorder_landscape.bench import stopwatches
from disorder_landscape.bench.stopwatches import BIASES, Stopwatch
from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset.store import PACKAGES
from disorder_landscape.machine import cores, cpu_name
from disorder_landscape.model.disorder import disorder_realization
from disorder_landscape.model.parameters import ALPHA_RANGE, TEMPERATURE, FloatArray, Nanowire
from disorder_landscape.solver import compiled
from disorder_landscape.solver.energy_grid import thermal_grid
from disorder_landscape.solver.routes import thermal_average

PAPER_ENERGIES = 151
"""Energies of one of the paper's sets, of one μ and B and all biases (S-I)."""
PAPER_SPACING = 0.08 / (PAPER_ENERGIES - 1)
"""Their spacing over ±0.04 meV, in meV."""
PAPER_SET_SECONDS = 12.0
"""What the paper states for a set on one core (S-II.6)."""
DATASETS = {
    "5 components": DatasetConfig(realizations=8_000),
    "10 components": DatasetConfig(realizations=50_000, components=10, mu_points=20, B_points=20),
}
"""The paper's two datasets: the 5+1 model's, and that of its 67,000 core-hours."""
WIRES = {"5 components": 8, "10 components": 4}
"""Random wires of each whose sets are averaged."""
THREADS = 2
LENGTHS = (100, 300, 1000, 3000)
"""Sites for the times against wire length."""
WIDE = np.linspace(0.0, 0.6, 64), np.linspace(0.1, 0.8, 4)
"""A grid of μ and B on which what all μ share costs little, for the gradient."""
MEMORY = tuple(DatasetConfig(realizations=n, sites=100) for n in (50, 200))
"""Datasets that are generated to see the memory it takes."""

BEYOND = (
    "set at 100 mK",
    "set at 300 mK",
    "set with dissipation 1 ueV",
    "set with the field at 30 degrees",
    "set with all derivatives",
    "local density of states, 201 energies",
    "lowest two levels",
    "lowest two modes",
)
"""What is given as a multiple of a set of the paper's."""

Progress = Callable[[int], object]
"""Called with 1 after each turn; the first, which warms up and is not counted, is one more."""


def measure(repeats: int, progress: Progress = lambda done: None) -> dict[str, Any]:
    """Measure everything, each time so often; return what `bench.json` holds.

    What is compared is measured in turn, so that a change of the core's clock meets all alike, and
    ratios are medians of ratios within a turn. All times are of one thread unless said otherwise.
    """
    rng = np.random.default_rng(0)
    wires = {
        name: [_random_wire(rng, of.components, of.sites) for _ in range(WIRES[name])]
        for name, of in DATASETS.items()
    }
    long = {  # as much work at every length
        sites: [_random_wire(rng, 5, sites) for _ in range(max(LENGTHS) // sites)]
        for sites in LENGTHS
    }
    grids = {name: (config.mu, config.B) for name, config in DATASETS.items()}
    five, grid = wires["5 components"], grids["5 components"]
    few = grid[0][2::5], grid[1][2::5]
    sparse = grid[0][2::6], grid[1][2::6]
    threads = min(THREADS, cores())
    watches = {
        "Kwant, per energy": stopwatches.kwant(five[0], *grid),
        "per energy": stopwatches.bare(five[0], *grid),
        "gradient, per bias, dataset grid": stopwatches.gradient(five[0], *grid),
        "gradient, per bias": stopwatches.gradient(five[0], *WIDE),
        "per energy, gradient grid": stopwatches.bare(five[0], *WIDE, abs(BIASES)),
        "per set, 5 components": stopwatches.sets(five, *grid),
        "per set, threads": stopwatches.sets(five, *grid, threads),
        "per set, 10 components": stopwatches.sets(wires["10 components"], *grids["10 components"]),
        "per set, energy grid": stopwatches.energy_grid(five[0], *grid, PAPER_SPACING),
        **_beyond(five[0], *sparse),
        **{f"per energy, {n} sites": stopwatches.bare(some[0], *grid) for n, some in long.items()},
        **{f"per set, {n} sites": stopwatches.sets(some, *few) for n, some in long.items()},
    }
    with threadpool_limits(1), compiled.threads_at_work(1):
        averaged = {
            name: thermal_average(wires[name], *grids[name], BIASES, TEMPERATURE)[1:]
            for name in DATASETS
        }
        needed = {
            n: thermal_average(some, *few, BIASES, TEMPERATURE)[2] for n, some in long.items()
        }
        seconds = _in_turn(watches, repeats, progress)
    omega, _ = thermal_grid(BIASES, TEMPERATURE, five[0].delta0, PAPER_SPACING)
    times = {name: float(np.median(of)) for name, of in seconds.items()}
    kwant_set = PAPER_ENERGIES * np.array(seconds["Kwant, per energy"])
    return {
        "machine": {"cpu": cpu_name(), "cores": cores()},
        "versions": {name: version(name) for name in (*PACKAGES, "kwant")},
        "repeats": repeats,
        "seconds": seconds,
        "medians": times,
        "Kwant / fast": {
            "per energy": _ratio(seconds["Kwant, per energy"], seconds["per energy"]),
            **{f"per set, {n}": _ratio(kwant_set, seconds[f"per set, {n}"]) for n in DATASETS},
        },
        "sets": {
            name: {"energies": float(energies.mean()), "largest error": float(error.max())}
            for name, (error, energies) in averaged.items()
        },
        "grid energies": omega.size,
        "core-hours": {
            name: {
                "fast": _core_hours(config, times[f"per set, {name}"]),
                "Kwant": _core_hours(config, PAPER_ENERGIES * times["Kwant, per energy"]),
                "paper": _core_hours(config, PAPER_SET_SECONDS),
            }
            for name, config in DATASETS.items()
        },
        "threads": threads,
        "speed-up": _ratio(seconds["per set, 5 components"], seconds["per set, threads"]),
        "beyond / per set": {
            name: _ratio(seconds[name], seconds["per set, sparse grid"]) for name in BEYOND
        },
        "gradient / conductance": _ratio(
            seconds["gradient, per bias"], seconds["per energy, gradient grid"]
        ),
        "sites": list(LENGTHS),
        "energies per set": [float(energies.mean()) for energies in needed.values()],
        "exponent": {
            name: _exponents([times[f"{name}, {n} sites"] for n in LENGTHS])
            for name in ("per energy", "per set")
        },
        "peak MiB": {
            str(config.realizations): stopwatches.peak_memory(config) for config in MEMORY
        },
    }


def _beyond(wire: Nanowire, mu: FloatArray, B: FloatArray) -> dict[str, Stopwatch]:
    """Return what a set at the paper's temperature is compared with, on the same grid."""
    leaking = replace(wire, dissipation=1e-3)
    watches = (
        stopwatches.sets([wire], mu, B, temperature=0.1),
        stopwatches.sets([wire], mu, B, temperature=0.3),
        stopwatches.sets([leaking], mu, B),
        stopwatches.sets([wire], mu, B, theta=np.pi / 6),
        stopwatches.thermal_gradient(wire, mu, B),
        stopwatches.density(wire, mu, B),
        stopwatches.levels(wire, mu, B),
        stopwatches.lowest_modes(wire, mu, B),
    )
    return {
        "per set, sparse grid": stopwatches.sets([wire], mu, B),
        **dict(zip(BEYOND, watches, strict=True)),
    }


def _in_turn(
    watches: Mapping[str, Stopwatch], repeats: int, progress: Progress
) -> dict[str, list[float]]:
    seconds: dict[str, list[float]] = {name: [] for name in watches}
    for turn in range(repeats + 1):
        for name, watch in watches.items():
            taken = watch()
            if turn > 0:  # the first warms up
                seconds[name].append(taken)
        progress(1)
    return seconds


def _random_wire(rng: np.random.Generator, components: int, sites: int) -> Nanowire:
    potential = disorder_realization(rng, components, sites)[1]
    return Nanowire(potential, alpha=rng.uniform(*ALPHA_RANGE))


def _ratio(slow: ArrayLike, fast: ArrayLike) -> float:
    return float(np.median(np.divide(slow, fast)))


def _core_hours(config: DatasetConfig, seconds: float) -> float:
    return config.realizations * config.mu_points * config.B_points * seconds / 3600


def _exponents(times: list[float]) -> dict[str, float]:
    """Return the slopes of lines through the logarithms of times and LENGTHS: all, the last two.

    What does not grow with the length, the ends and the leads, counts in short wires only.
    """
    x, y = np.log(LENGTHS), np.log(times)
    return {
        "all": float(np.polyfit(x, y, 1)[0]),
        "longest": float(np.polyfit(x[-2:], y[-2:], 1)[0]),
    }
