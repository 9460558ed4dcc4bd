"""Inversions of wires with something that the model lacks, and what notices wrong answers.

Each row inverts a fresh wire of `studies.inversions`, of which one thing is other than the model
has it, and asks two checks: the verdict, and measurements at other barriers (K'_full of S-II.1),
which the inversion does not use. Rows of the kind "nothing" count false alarms.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from disorder_landscape.dataset.realizations import realization
from disorder_landscape.inference.problem.measurement import (
    Measurement,
    empty_measurement,
    simulated,
)
from disorder_landscape.inference.problem.observation import Observation, noise_of_channels
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.verification.predictive import predictive_p
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.studies.inversions import SEED, inverted, measured, network_of, rounded

NOTHING = "nothing"
KINDS = {
    NOTHING: "the model is right",
    "gap": "Δ₀ 20 % smaller, or larger",
    "temperature": "100 mK instead of 50 mK",
    "barrier": "the left barrier twice as high, or the right one",
    "uncorrelated": "V of each site independent, as strong",
    "dissipation": "Γ = 1 µeV on each site",
    "bias": "biases 5 µV higher than stated",
}
"""What is other than the model has it; of two, the index takes turns."""
HOT, DISSIPATION, OFFSET = 0.1, 1e-3, 5e-3
"""In K, meV and meV."""
OTHER_BARRIERS = (25.0, 10.0)
"""Of the measurements that check the answer, left and right in meV."""
EVERY = 2
"""Of the points of μ and B, how many they are apart."""
SAMPLES = 100
"""Of the answer, which predict those measurements."""
KEYS = ["model", "noise", "kind", "index"]


@dataclass(frozen=True)
class Task:
    """One inversion: a shipped model's name, the noise in e²/h, what is other, and which wire."""

    model: str
    noise: float
    kind: str
    index: int


def changed(
    kind: str, index: int, wire: Nanowire, settings: Measurement
) -> tuple[Nanowire, Measurement]:
    """Return the wire as it is, and the settings at which it is measured in truth."""
    first = index % 2 == 0
    match kind:
        case "gap":
            return replace(wire, delta0=wire.delta0 * (0.8 if first else 1.2)), settings
        case "temperature":
            return wire, replace(settings, temperature=HOT)
        case "barrier":
            left, right = wire.barrier
            barrier = (2 * left, right) if first else (left, 2 * right)
            return replace(wire, barrier=barrier), settings
        case "uncorrelated":
            rng = np.random.default_rng([SEED, index, 2])
            V = rng.normal(wire.potential.mean(), wire.potential.std(), wire.sites)
            return replace(wire, potential=V), settings
        case "dissipation":
            return replace(wire, dissipation=DISSIPATION), settings
        case "bias":
            return wire, replace(settings, bias=settings.bias + OFFSET)
        case _:
            return wire, settings


def true_conductances(task: Task, wire: Nanowire, settings: Measurement) -> FloatArray:
    """Return what there is to measure, shape (mu, B, bias, channel), in e²/h."""
    return simulated(*changed(task.kind, task.index, wire, settings))


def unmodelled_row(task: Task) -> dict[str, object]:
    """Invert the measurement, check the answer, and compare it with the truth.

    Returns
    -------
    dict
        As `inversion_row`; besides, `departure`, the root-mean-square change of the conductances in
        units of the noise; `p_predictive`, the p-value of `predictive_p` at OTHER_BARRIERS.
    """
    network = network_of(task.model, task.noise)
    config = network.config.dataset.model_copy(update={"seed": SEED})
    unknowns, noise = Unknowns(config), noise_of_channels(task.noise)
    one = realization(config, task.index)
    settings = empty_measurement(config)
    G = true_conductances(task, one.wire, settings)
    observation = Observation(measured(settings, G, task.noise, task.index), unknowns, noise)
    found = inverted(observation, network, task.index)
    mean = found.answer.mean
    true, _ = changed(task.kind, task.index, one.wire, settings)
    change = G - simulated(one.wire, settings)
    other_settings = replace(
        settings, mu=config.mu[::EVERY], B=config.B[::EVERY], barrier=OTHER_BARRIERS
    )
    other_wire = replace(one.wire, barrier=OTHER_BARRIERS)
    other_G = true_conductances(task, other_wire, other_settings)
    further = Observation(
        measured(other_settings, other_G, task.noise, task.index, 3), unknowns, noise
    )
    rng = np.random.default_rng([SEED, task.index, 4])
    predicted = further.simulate(found.chosen.draw(rng, SAMPLES))
    return rounded(
        {
            "model": task.model,
            "noise": task.noise,
            "kind": task.kind,
            "index": task.index,
            "departure": float(np.sqrt((change**2).mean()) / task.noise),
            "site_error": float(np.sqrt(((unknowns.potential(mean) - true.potential) ** 2).mean())),
            "alpha_error": abs(unknowns.alpha(mean) - one.alpha),
            "p_predictive": predictive_p(predicted, further.data, further.variance, rng),
            **found.outcome,
        }
    )
