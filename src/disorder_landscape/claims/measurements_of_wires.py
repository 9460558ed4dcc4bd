"""Quick measurements of the disorder's statistics and of pristine wires."""

from __future__ import annotations

from functools import cache

import numpy as np

from disorder_landscape.claims.claim import paper_value
from disorder_landscape.model import disorder
from disorder_landscape.model.parameters import SITES, FloatArray, Nanowire
from disorder_landscape.observables.visibility import topological_visibility, transition_field

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


def r2_of_mean_from_components(components: float) -> float:
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
