"""The cases on which the old and the new solver are compared: see solve.py.

A case depends on its kind and index alone. Even ones are the paper's wires at points of the paper's
grids, odd ones are drawn from broader ranges.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

POINTS = 100_000
KINDS = {  # how many points of each: (wire, μ, B, ω), (wire, μ, B) for averages and determinants
    "T = 0": POINTS,
    "above the gap": POINTS,
    "dissipation": POINTS,
    "tilted": POINTS,
    "det r": POINTS,
    "det r, tilted": POINTS,
    "gradient": POINTS,
    "20-60 mK": POINTS,
    "20-60 mK, tilted": 2000,
    "20-60 mK, quadrature": 400,
}
BOLTZMANN, REACH, BELOW_GAP = 0.0861733, 11.0, 0.975
"""k_B in meV/K; kT and the part of the gap that the window of an average may take."""


class Case(NamedTuple):
    """A wire and where it is solved."""

    wire: Any  # the Nanowire of either code
    mu: Any
    B: Any
    omega: Any  # energies, or biases
    theta: float
    temperature: float


def case(kind: str, index: int) -> Case:
    """Draw a case: 7 or 9 points."""
    from disorder_landscape import Nanowire
    try:
        from disorder_landscape.model.disorder import disorder_realization
    except ImportError:  # the old code's room
        from disorder_landscape.physics.disorder import disorder_realization

    rng = np.random.default_rng([33, list(KINDS).index(kind), index])

    def log(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    given: dict[str, Any] = {"alpha": rng.uniform(6.4, 9.6)}
    V = disorder_realization(rng, 5, 300)[1]
    mus, mu_count = [rng.uniform(0, 0.6, 9)], 7 if index // 2 % 2 else 9
    fields = [rng.uniform(0, 0.8)]
    if index % 2:
        sites = int(rng.choice([300, rng.integers(200, 301), rng.integers(2, 301), log(2, 300)]))
        smooth = rng.choice([n for n in (5, 10, 30) if n < sites] or [1])
        strength = rng.choice(["sum", "double", "unit-variance"])
        potentials = [np.zeros(sites), rng.normal(0, log(0.01, 10), sites)]
        potentials.append(np.where(np.arange(sites) < rng.integers(sites), log(0.01, 10), 0.0))
        potentials += 3 * [disorder_realization(rng, smooth, sites, amplitude=strength)[1]]
        V = potentials[rng.integers(len(potentials))]
        given = {
            "alpha": rng.choice([8.0, 0.0, rng.uniform(0, 40)]),
            "mass": rng.choice([0.03, log(0.01, 0.3)]),
            "g": rng.choice([25.0, rng.uniform(0, 60)]),
            "gamma": rng.choice([0.15, 0.15, rng.uniform(0, 1), 0.0]),
            "delta0": rng.choice([0.12, rng.uniform(0.1, 0.5)]),
            "barrier": tuple(rng.choice([15.0, 0.0, rng.uniform(0, 300)], 2)),
            "lead_mu": rng.choice([25.0, rng.uniform(0.5, 60)]),
            "lead_alpha": rng.choice([None, None, 0.0, rng.uniform(0, 30)]),
            "lead_g": rng.choice([None, None, 0.0, rng.uniform(0, 60)]),
        }
        mus += [rng.uniform(-5, 30, 9)]
        fields += [0.0, -rng.uniform(0, 1), log(1e-3, 5)]
    delta0 = given.get("delta0", 0.12)
    theta = 0.0
    if "tilted" in kind:
        theta = float(
            rng.choice([np.pi / 2, rng.uniform(-0.1, 0.1), *rng.uniform(-np.pi, np.pi, 3)])
        )
    temperature, energies = 0.0, 1
    if "mK" in kind:
        temperature, energies = rng.uniform(0.02, 0.06), 5
        most = BELOW_GAP * delta0 - REACH * BOLTZMANN * temperature
        omega = np.linspace(-1, 1, 5) * min(0.04, most)
        if index % 2:
            omega = np.sort(rng.uniform(-most, most, 5))
        if "quadrature" in kind:  # below the gap only where there is dissipation
            given["dissipation"] = rng.choice([0.0, log(1e-6, 0.1)])
            omega = omega if given["dissipation"] > 0 else omega * delta0 / max(abs(omega))
    elif "det" in kind:
        omega = np.zeros(1)
    else:
        energies = 1 if mu_count == 7 else 3
        below = rng.choice([0.0, 0.02 / delta0, *rng.uniform(0, 0.99, 6)], 3, replace=False)
        above = 1 + np.array([log(1e-4, 2) for _ in range(3)])
        share = above if kind == "above the gap" else below
        if kind in ("dissipation", "tilted") and rng.random() < 0.3:
            share = above
        omega = np.sort(share[:energies]) * delta0
        if kind == "gradient":
            omega = np.sort(omega * rng.choice([-1, 1], energies))
        if kind == "dissipation" or (kind == "tilted" and rng.random() < 0.2):
            given["dissipation"] = log(1e-6, 0.1)
        mu_count = mu_count if energies == 1 else 3
    mu_count = 1 if "quadrature" in kind else mu_count
    mu = np.sort(mus[rng.integers(len(mus))][:mu_count])
    B = np.array([fields[rng.integers(len(fields))]])
    return Case(Nanowire(V, **given), mu, B, omega, theta, float(temperature))
