"""A hint at measurements of which V of every site may not be found."""

from __future__ import annotations

import numpy as np

from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.model.parameters import hopping

PHASE = 3.6
"""Radians. V is found where disorder adds no more phase than this there and back at the highest µ,
root mean square: so much it is in 300 sites of the paper's disorder at 4 meV. (Of 40 such wires,
measured up to 4.2 meV, all are found. Of one up to 3.0 and one up to 2.1 the search had not ended
after 53 and 34 minutes.) …"""
ABOVE = 5.4
"""… And it is found where the highest µ is so many times the standard deviation of V, as 0.6 meV
are that of disorder a fifth as strong."""


def landscape_hint(observation: Observation) -> str:
    """Return a line about µ that do not go up high enough for V of every site, or nothing.

    The phase is 2/(ħv) √(σ² L c), of a potential with the standard deviation σ that is correlated
    over c on a length L, where ħv = 2a√(Tµ).
    """
    unknowns = observation.unknowns
    if not unknowns.is_whole_landscape:
        return ""
    middle = unknowns.devices(unknowns.white_noise.mean[None], observation.measurement)[0]
    highest, prior = float(middle.setup.mu.max()), unknowns.prior
    std = unknowns.site_std(unknowns.white_noise.covariance)
    correlated = np.sqrt(2 * np.pi) * prior.correlation_length  # the integral of exp(−x²/2ℓ²)
    phase_there = std**2 * prior.sites * correlated / hopping(prior.mass, prior.lattice)
    needed = max(phase_there / PHASE**2, ABOVE * std)
    if highest >= needed:
        return ""
    return (
        f"V of every site may not be found, even in an hour: µ goes up to {highest:.2g} meV. It is "
        f"known to be found from {needed:.2g} meV on ({prior.sites} sites of this disorder)."
    )
