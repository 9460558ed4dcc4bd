"""A hint at measurements of which V of every site may not be found."""

from __future__ import annotations

import numpy as np

from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.model.parameters import hopping

PHASE = 5.0
"""Radians. V is found where disorder adds no more phase than this there and back at the highest µ,
root mean square: so much it is in 300 sites of the paper's disorder at 2.1 meV. (Of 40 such wires,
measured up to 4.2 meV, all are found, and all of four up to 3.0 and of three up to 2.1. Of one up
to 1.2 the first way ended 612 µeV off.) …"""
ABOVE = 3.9
"""… And it is found where the highest µ is so many times the standard deviation of V, as it is
there."""


def landscape_hint(observation: Observation) -> str:
    """Return a line about µ that do not go up high enough for V of every site, or nothing."""
    if not observation.unknowns.is_whole_landscape:
        return ""
    highest, needed = highest_and_needed_mu(observation)
    if highest >= needed:
        return ""
    sites = observation.unknowns.prior.sites
    return (
        f"V of every site may not be found: µ goes up to {highest:.2g} meV. It is "
        f"known to be found from {needed:.2g} meV on ({sites} sites of this disorder)."
    )


def highest_and_needed_mu(observation: Observation) -> tuple[float, float]:
    """Return up to which µ there are data, in meV, and from which on ways from high µ find V.

    The phase is 2/(ħv) √(σ² L c), of a potential with the standard deviation σ that is correlated
    over c on a length L, where ħv = 2a√(Tµ).
    """
    unknowns = observation.unknowns
    middle = unknowns.devices(unknowns.white_noise.mean[None], observation.measurement)[0]
    highest, prior = float(middle.setup.mu.max()), unknowns.prior
    std = unknowns.site_std(unknowns.white_noise.covariance)
    correlated = np.sqrt(2 * np.pi) * prior.correlation_length  # the integral of exp(−x²/2ℓ²)
    phase_there = std**2 * prior.sites * correlated / hopping(prior.mass, prior.lattice)
    return highest, max(phase_there / PHASE**2, ABOVE * std)
