"""How fast the solvers are: seconds per energy on one core, measured in one run."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import numba as nb
import numpy as np
from threadpoolctl import threadpool_limits

from disorder_landscape.physics import fast_solver, kwant_solver
from disorder_landscape.physics.disorder import disorder_realization
from disorder_landscape.physics.parameters import BIAS, Nanowire
from disorder_landscape.physics.thermal import thermal_grid

ENERGIES = np.linspace(0.001, 0.08, 16)
MU = np.linspace(0.0, 0.6, 15)
B = np.linspace(0.0, 0.8, 15)


def measure(repeats: int) -> Iterator[str]:
    """Yield the lines of the table; each figure is the median of so many repetitions.

    Kwant has every advantage it offers: the system finalised once, lead modes computed once for all
    μ (their time is not counted), one thread, on which it is fastest for a chain.
    """
    rng = np.random.default_rng(0)
    wire = Nanowire(disorder_realization(rng, 5, 300)[1], alpha=rng.uniform(6.4, 9.6))
    threads = nb.get_num_threads()
    fast_solver.bare_conductance([wire], MU, B, ENERGIES)  # compiled, or read from the cache
    with threadpool_limits(1):
        kwant_time = np.median([_kwant_seconds(wire) for _ in range(repeats)])
        fast_one = _fast_seconds(wire, 1, repeats)
        fast_all = _fast_seconds(wire, threads, repeats)
    omega, _ = thermal_grid(np.array(BIAS), 0.05, wire.delta0)
    yield f"300 sites, 5 components, medians of {repeats}"
    yield f"Kwant, per energy, one core           {1e3 * kwant_time:10.3f} ms"
    yield f"fast, per energy, one core            {1e6 * fast_one:10.3f} us"
    yield f"ratio per core                        {kwant_time / fast_one:10.0f}"
    yield f"fast, per energy, {threads} threads           {1e6 * fast_all:10.3f} us"
    yield f"speed-up of {threads} threads                 {fast_one / fast_all:10.2f}"
    per_set = omega.size * fast_one
    yield f"fast, 5 biases at 50 mK, one core     {1e3 * per_set:10.3f} ms ({omega.size} energies)"


def _kwant_seconds(wire: Nanowire) -> float:
    matrices = kwant_solver.scattering_matrices(wire, MU, B[7:8], ENERGIES[7:8])
    next(matrices)  # builds the system and computes the modes
    return _seconds(lambda: [kwant_solver.conductances(s) for _, s in matrices]) / (MU.size - 1)


def _fast_seconds(wire: Nanowire, threads: int, repeats: int) -> float:
    before = nb.get_num_threads()
    nb.set_num_threads(threads)
    times = [
        _seconds(lambda: fast_solver.bare_conductance([wire], MU, B, ENERGIES))
        for _ in range(repeats)
    ]
    nb.set_num_threads(before)
    return float(np.median(times)) / (MU.size * B.size * ENERGIES.size)


def _seconds(action: Callable[[], object]) -> float:
    start = time.perf_counter()
    action()
    return time.perf_counter() - start
