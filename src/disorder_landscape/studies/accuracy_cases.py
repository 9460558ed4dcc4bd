"""Random wires and where they are measured, and the errors of their thermal averages."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal, NamedTuple

import numpy as np

from disorder_landscape.model.disorder import disorder_realization
from disorder_landscape.model.parameters import (
    B_MAX,
    BOLTZMANN,
    MU_MAX,
    SITES,
    FloatArray,
    Nanowire,
)
from disorder_landscape.solver.quadrature import REACH, thermal_quadrature
from disorder_landscape.solver.routes import stays_below_gap, thermal_average

KINDS = ("pristine", "5 weak", "5 strong", "10 weak", "10 strong", "30 weak", "30 strong", "noise")
"""Kinds of wires: components, weak or strong amplitude ("sum", "double"); uncorrelated noise."""
TEMPERATURES = (0.02, 0.05, 0.06)
"""In K."""
Region = Literal["cold", "hot", "dissipation"]
"""Windows below the gap; windows that reach it; broadened levels, cold and hot."""
HOT = (0.08, 1.0)
"""Temperatures in K of hot wires; their logarithm is uniform."""
DISSIPATION = (1e-7, 2e-2)
"""In meV; the same."""
BIASES = 5
BIAS_MAX = 0.05
"""In meV."""
BRUTE = {"panel": 0.05, "tolerance": 1e-8}
FINER = {"panel": 0.02, "tolerance": 1e-9}
BELOW_GAP = 0.99
"""Part of the gap at which the brute-force integral ends; the finer one goes on across the gap."""


class Case(NamedTuple):
    """One wire, and where it is measured."""

    kind: int
    wire: Nanowire
    mu: FloatArray
    B: FloatArray
    bias: FloatArray
    temperature: float


def random_case(seed: int, index: int, sites: int = SITES, region: Region = "cold") -> Case:
    """Draw the case of an index; every tenth is at B = 0."""
    case, rng = _cold_case(seed, index, sites), np.random.default_rng([seed, index, 1])
    hot = float(np.exp(rng.uniform(*np.log(HOT))))
    if region == "hot":
        return case._replace(temperature=hot)
    if region == "dissipation":
        width = float(np.exp(rng.uniform(*np.log(DISSIPATION))))
        temperature = hot if rng.random() < 0.5 else case.temperature
        return case._replace(wire=replace(case.wire, dissipation=width), temperature=temperature)
    return case


def _cold_case(seed: int, index: int, sites: int) -> Case:
    """Return a case of the first region."""
    rng = np.random.default_rng([seed, index])
    family, amplitude = int(rng.integers(5)), int(rng.integers(2))
    if family == 0:
        kind, V = 0, np.zeros(sites)
    elif family == 4:
        kind, V = 7, rng.normal(0.0, rng.uniform(0.1, 2.0), sites)
    else:
        kind, components = 2 * family - 1 + amplitude, (5, 10, 30)[family - 1]
        strength = ("sum", "double")[amplitude]
        V = disorder_realization(rng, components, sites, amplitude=strength)[1]
    return Case(
        kind=kind,
        wire=Nanowire(V, alpha=rng.uniform(6.4, 9.6)),
        mu=np.array([rng.uniform(0.0, MU_MAX)]),
        B=np.array([rng.uniform(0.0, B_MAX) if index % 10 else 0.0]),
        bias=np.sort(rng.uniform(-BIAS_MAX, BIAS_MAX, BIASES)),
        temperature=float(rng.choice(TEMPERATURES)),
    )


def measure(case: Case, finer: bool) -> dict[str, Any]:
    """Return what is kept of one wire, in e²/h.

    Returns
    -------
    dict
        kind; error, shape (bias, 4): |exact − brute|; estimate and energies of the exact average;
        brute, the brute-force integral's own estimate; if `finer`, converged: its largest
        difference from the finer one, and finest, that one's estimate, else NaN.
    """
    _, wire, mu, B, bias, temperature = case
    G, estimate, energies = thermal_average([wire], mu, B, bias, temperature)
    reach = REACH
    if stays_below_gap([wire], bias, temperature):
        below = BELOW_GAP * (wire.delta0 - abs(bias).max()) / (BOLTZMANN * temperature)
        reach = min(REACH, below)
    brute = thermal_quadrature([wire], mu, B, bias, temperature, reach=reach, **BRUTE)
    converged = finest = np.nan
    if finer:
        best = thermal_quadrature([wire], mu, B, bias, temperature, **FINER)
        converged = abs(brute.conductance - best.conductance).max()
        finest = best.error.item()
    return {
        "kind": case.kind,
        "error": abs(G - brute.conductance)[0, 0, 0],
        "estimate": estimate.item(),
        "energies": energies.item(),
        "brute": brute.error.item(),
        "converged": converged,
        "finest": finest,
    }
