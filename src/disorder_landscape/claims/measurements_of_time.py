"""Quick measurements of what simulating and training cost.

In core-seconds where one solver is timed, which other loads of the machine hardly change; in turns
where two are compared.
"""

from __future__ import annotations

import time

import numpy as np
from threadpoolctl import threadpool_limits

from disorder_landscape.bench import stopwatches
from disorder_landscape.bench.measurements import DATASETS, PAPER_ENERGIES
from disorder_landscape.claims.measurements_of_models import sets_and_training_hours
from disorder_landscape.machine import cores
from disorder_landscape.model import disorder
from disorder_landscape.model.parameters import (
    ALPHA_RANGE,
    SITES,
    TEMPERATURE,
    FloatArray,
    Nanowire,
)
from disorder_landscape.solver import compiled, kwant_reference
from disorder_landscape.solver.routes import thermal_average

TURNS = 5
"""Turns of a stopwatch, of which the median counts; the first, which warms up, is one more."""


def kwant_set_seconds() -> float:
    """Return the core-seconds Kwant needs for the paper's 151 energies at one μ and B."""
    return PAPER_ENERGIES * float(np.median(_in_turn(_kwant_core_seconds(SITES))))


def speed_of_exact_set() -> float:
    """Return how many times faster our exact set is than Kwant's 151 energies, on one core."""
    kwant, ours = stopwatches.kwant(_wire(SITES), *_grid()), stopwatches.sets(_wires(), *_grid())
    turns = _in_turn(kwant, ours)
    return float(np.median([PAPER_ENERGIES * slow / fast for slow, fast in turns]))


def parallel_efficiency() -> float:
    """Return the core-seconds of sets by one thread over those by two.

    Core-seconds are the same on a busy machine, where a second thread would find no core.
    """
    turns = _in_turn(_core_seconds(1), _core_seconds(2))
    return float(np.median([alone / both for alone, both in turns]))


def kwant_exponent(shorter: float, longer: float) -> float:
    """Return p of Kwant's core-seconds per energy ∝ L^p, from wires of so many sites."""
    turns = _in_turn(*(_kwant_core_seconds(int(sites)) for sites in (shorter, longer)))
    slopes = [np.log(long / short) / np.log(longer / shorter) for short, long in turns]
    return float(np.median(slopes))


def generation_over_training(model: str) -> float:
    """Return core-hours of generating a model's dataset over those of training it.

    Those of generation by the core-seconds of an exact set; training has two cores.
    """
    sets, training = sets_and_training_hours(model)
    per_set = float(np.median(_in_turn(_core_seconds(1))))
    return sets * per_set / 3600 / (2 * training)


def _wire(sites: int) -> Nanowire:
    rng = np.random.default_rng(0)
    potential = disorder.disorder_realization(rng, 5, sites)[1]
    return Nanowire(potential, alpha=rng.uniform(*ALPHA_RANGE))


def _wires() -> list[Nanowire]:
    rng = np.random.default_rng(1)
    return [Nanowire(disorder.disorder_realization(rng, 5, SITES)[1]) for _ in range(8)]


def _grid() -> tuple[FloatArray, FloatArray]:
    config = DATASETS["5 components"]
    return config.mu, config.B


def _in_turn(*watches: stopwatches.Stopwatch) -> list[tuple[float, ...]]:
    """Return the times of each turn, in which all are measured one after the other."""
    with threadpool_limits(1), compiled.threads_at_work(1):
        return [tuple(watch() for watch in watches) for _ in range(TURNS + 1)][1:]


def _core_seconds(threads: int) -> stopwatches.Stopwatch:
    """Count core-seconds per exact set, of all threads together."""
    wires, (mu, B) = _wires(), _grid()

    def watch() -> float:
        with compiled.threads_at_work(min(threads, cores())):
            started = time.process_time()
            thermal_average(wires, mu, B, stopwatches.BIASES, TEMPERATURE)
            return (time.process_time() - started) / (len(wires) * mu.size * B.size)

    return watch


def _kwant_core_seconds(sites: int) -> stopwatches.Stopwatch:
    """Count Kwant's core-seconds per energy, without building the system and the lead modes."""
    wire, (mu, B) = _wire(sites), _grid()

    def watch() -> float:
        solved = kwant_reference.scattering_matrices(wire, mu, B[-1:], stopwatches.ENERGIES[7:8])
        next(solved)  # builds the system and computes the modes
        started = time.process_time()
        done = [kwant_reference.conductances(matrix) for _, matrix in solved]
        return (time.process_time() - started) / len(done)

    return watch
