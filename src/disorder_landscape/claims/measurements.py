"""Quick measurements of the claims: each a function that returns one number, named in claims.toml.

Those of a trained network are in `measurements_of_models`.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import cache

import numba as nb
import numpy as np
from threadpoolctl import threadpool_limits

from disorder_landscape import stopwatches
from disorder_landscape.arguments import ArgumentError
from disorder_landscape.bench import DATASETS, PAPER_ENERGIES
from disorder_landscape.claims import measurements_of_models
from disorder_landscape.claims.claim import Measured, paper_value
from disorder_landscape.physics import disorder, kwant_solver
from disorder_landscape.physics.parameters import (
    ALPHA_RANGE,
    SITES,
    TEMPERATURE,
    FloatArray,
    Nanowire,
)
from disorder_landscape.physics.topology import topological_visibility, transition_field
from disorder_landscape.physics.transport import exact_average

TURNS = 5
"""Turns of a stopwatch, of which the median counts; the first, which compiles, is one more."""
LONG = 4000
"""Sites of a wire whose transition is that of an infinite one."""
DRAWS = 4000
"""Realizations of the disorder, for its statistics."""


def components_required(fidelity: float, correlation_length: float, sites: float = SITES) -> float:
    """Return how many components give a fidelity F (S-II.3)."""
    return disorder.components_required(fidelity, correlation_length, int(sites))


def transition(mu: float) -> float:
    """Return V_Z/√(μ² + γ²) where T_IV of a long pristine wire changes its sign."""
    wire = Nanowire(np.zeros(LONG))
    expected = float(transition_field(wire, mu))
    B = expected * np.linspace(0.95, 1.05, 101)
    T_IV = topological_visibility(wire, mu, B, barrier=False).sel(lead="L")[0].to_numpy()
    last = int(np.flatnonzero(T_IV > 0)[-1])  # the last field at which it is trivial
    part = T_IV[last] / (T_IV[last] - T_IV[last + 1])
    return float((B[last] + part * (B[last + 1] - B[last])) / expected)


def mean_spread(components: float) -> float:
    """Return the standard deviation in meV of the mean potential of the realizations."""
    return float(np.std(_realizations(int(components))[1]))


def mean_told_by_components(components: float) -> float:
    """Return R² of the best linear guess of the mean potential from c₁ … c_n."""
    c, mean = _realizations(int(components))[:2]
    half = DRAWS // 2
    known = np.column_stack([np.ones(DRAWS), c])
    weights = np.linalg.lstsq(known[:half], mean[:half], rcond=None)[0]
    wrong = mean[half:] - known[half:] @ weights
    return float(1 - np.mean(wrong**2) / np.var(mean[half:]))


def potential_spread_from_scores(components: float, r2: str, delta_V: str, sigmas: float) -> float:
    """Return σ_V = ΔV/√(1 − R²) by the paper's numbers, over that of our realizations.

    Parameters
    ----------
    components : float
        Of the model.
    r2, delta_V : str
        Ids of the paper's claims.
    sigmas : float
        How many standard deviations its ± means.
    """
    stated = paper_value(delta_V) / sigmas / np.sqrt(1 - paper_value(r2))
    return float(stated / _realizations(int(components))[2])


def core_hours_of_dataset(sets: float, realizations: str, seconds: str) -> float:
    """Return the core-hours of a dataset by the paper's numbers, given by the ids of its claims."""
    return sets * paper_value(realizations) * paper_value(seconds) / 3600


def core_hours_of_components(
    components: float, sets: float, prefactor: str, exponent: str, seconds: str
) -> float:
    """Return the core-hours for R² = 0.77 by the paper's own fit of Fig. 2 and time per set."""
    realizations = float(paper_value(prefactor) * components ** paper_value(exponent))
    return realizations * sets * paper_value(seconds) / 3600


def kwant_set_seconds() -> float:
    """Return the core-seconds Kwant needs for the paper's 151 energies at one μ and B."""
    return PAPER_ENERGIES * float(np.median(_in_turn(_kwant_core_seconds(SITES))))


def speed_of_exact_set() -> float:
    """Return how many times faster our exact set is than Kwant's 151 energies, on one core."""
    kwant, ours = stopwatches.kwant(_wire(SITES), *_grid()), stopwatches.sets(_wires(), *_grid())
    turns = _in_turn(kwant, ours)
    return float(np.median([PAPER_ENERGIES * slow / fast for slow, fast in turns]))


def speed_per_energy() -> float:
    """Return how many times faster one energy is than with Kwant, on one core."""
    wire = _wire(SITES)
    turns = _in_turn(stopwatches.kwant(wire, *_grid()), stopwatches.bare(wire, *_grid()))
    return float(np.median([slow / fast for slow, fast in turns]))


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
    sets, training = measurements_of_models.sets_and_training_hours(model)
    per_set = float(np.median(_in_turn(_core_seconds(1))))
    return sets * per_set / 3600 / (2 * training)


MEASUREMENTS: dict[str, Callable[..., float]] = {
    function.__name__: function
    for function in (
        components_required,
        transition,
        mean_spread,
        mean_told_by_components,
        potential_spread_from_scores,
        core_hours_of_dataset,
        core_hours_of_components,
        kwant_set_seconds,
        speed_of_exact_set,
        speed_per_energy,
        parallel_efficiency,
        kwant_exponent,
        generation_over_training,
        measurements_of_models.model_score,
        measurements_of_models.loss_by_noise,
        measurements_of_models.conductance_match,
        measurements_of_models.visibility_match,
    )
}
"""What a claim can name, by name."""


def measure(source: Measured) -> float:
    """Return the value of a quick measurement.

    Raises
    ------
    ArgumentError
        If there is no such function, or it takes other arguments.
    """
    must = f"name one of {', '.join(MEASUREMENTS)}"
    if source.measure not in MEASUREMENTS:
        raise ArgumentError("measure", must, f"it is '{source.measure}'")
    return float(MEASUREMENTS[source.measure](**source.arguments))


@cache
def _realizations(components: int) -> tuple[FloatArray, FloatArray, float]:
    """Return components (realization, component), means (realization) and σ_V, all in meV.

    σ_V is the standard deviation of the potential without its mean.
    """
    rng = np.random.default_rng(0)
    drawn = [disorder.disorder_realization(rng, components, SITES) for _ in range(DRAWS)]
    c, V = (np.array(part) for part in zip(*drawn, strict=True))
    mean = V.mean(axis=1)
    return c, mean, float(np.std(V - mean[:, None]))


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
    with threadpool_limits(1), stopwatches.numba_threads(1):
        return [tuple(watch() for watch in watches) for _ in range(TURNS + 1)][1:]


def _core_seconds(threads: int) -> stopwatches.Stopwatch:
    """Count core-seconds per exact set, of all threads together."""
    wires, (mu, B) = _wires(), _grid()

    def watch() -> float:
        with stopwatches.numba_threads(min(threads, nb.config.NUMBA_NUM_THREADS)):
            started = time.process_time()
            exact_average(wires, mu, B, stopwatches.BIASES, TEMPERATURE)
            return (time.process_time() - started) / (len(wires) * mu.size * B.size)

    return watch


def _kwant_core_seconds(sites: int) -> stopwatches.Stopwatch:
    """Count Kwant's core-seconds per energy, without building the system and the lead modes."""
    wire, (mu, B) = _wire(sites), _grid()

    def watch() -> float:
        solved = kwant_solver.scattering_matrices(wire, mu, B[-1:], stopwatches.ENERGIES[7:8])
        next(solved)  # builds the system and computes the modes
        started = time.process_time()
        done = [kwant_solver.conductances(matrix) for _, matrix in solved]
        return (time.process_time() - started) / len(done)

    return watch


def cores() -> int:
    """Return how many cores this machine has."""
    return int(nb.config.NUMBA_DEFAULT_NUM_THREADS)
