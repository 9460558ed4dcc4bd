"""Wires that are other than the model has them, and what is measured of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from disorder_landscape.inference.problem.measurement import Measurement, simulated
from disorder_landscape.inference.problem.series_resistance import in_series
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.studies.fresh_wires import SEED

Kind = Literal[
    "nothing",
    "gap",
    "temperature",
    "barrier",
    "uncorrelated",
    "dissipation",
    "bias",
    "mass",
    "length",
    "leads",
    "resistance",
    "jump",
    "errors",
]
NOTHING: Kind = "nothing"
KINDS: dict[Kind, str] = {
    NOTHING: "the model is right",
    "gap": "Δ₀ 20 % smaller, or larger",
    "temperature": "100 mK instead of 50 mK",
    "barrier": "the left barrier twice as high, or the right one",
    "uncorrelated": "V of each site independent, as strong",
    "dissipation": "Γ = 1 µeV on each site",
    "bias": "biases 5 µV higher than stated",
    "mass": "m* 10 % smaller, or larger",
    "length": "the wire 5 % shorter, or longer",
    "leads": "µ of the leads 20 % smaller, or larger",
    "resistance": "1 kΩ in series with each lead",
    "jump": "µ 20 µeV higher from the middle field on",
    "errors": "errors half as large as stated, or twice",
}
"""What is other than the model has it; of two, the index takes turns."""
HOT, DISSIPATION, OFFSET = 0.1, 1e-3, 5e-3
"""In K, meV and meV."""
RESISTANCE, JUMP = 1e3, 0.02
"""In Ω and meV."""


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
            return replace(wire, dissipation=DISSIPATION, parent_dissipation=0.0), settings
        case "bias":
            return wire, replace(settings, bias=settings.bias + OFFSET)
        case "mass":
            return replace(wire, mass=wire.mass * (0.9 if first else 1.1)), settings
        case "length":
            return replace(wire, lattice=wire.lattice * (0.95 if first else 1.05)), settings
        case "leads":
            return replace(wire, lead_mu=wire.lead_mu * (0.8 if first else 1.2)), settings
        case _:
            return wire, settings


def true_conductances(kind: str, index: int, wire: Nanowire, settings: Measurement) -> FloatArray:
    """Return what there is to measure, shape (mu, B, bias, channel), in e²/h."""
    G = simulated(*changed(kind, index, wire, settings))
    if kind == "resistance":
        return in_series((RESISTANCE, RESISTANCE), G)
    if kind == "jump":
        later = slice(settings.B.size // 2, None)
        shifted = replace(settings, mu=settings.mu + JUMP, B=settings.B[later])
        G[:, later] = simulated(wire, shifted)
    return G


def true_noise(kind: str, index: int, noise: float) -> float:
    """Return the standard deviation of the errors in e²/h, which may be other than stated."""
    if kind == "errors":
        return noise * (0.5 if index % 2 == 0 else 2.0)
    return noise
