"""A hint at measurements of which V of every site may not be found."""

from __future__ import annotations

import numpy as np

from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.model.parameters import hopping

FOUND = 3.6
"""Radians. Steps from V = 0 lead to V where disorder adds no more phase than this there and back at
the highest µ, root mean square. (So much it is in 300 sites of the paper's disorder at 4 meV. Of 40
wires measured up to 4.2 meV 36 are found and "converged"; of one up to 3.0 and one up to 2.1 the
search had not ended after 53 and 34 minutes.)"""


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
    needed = std**2 * prior.sites * correlated / hopping(prior.mass, prior.lattice) / FOUND**2
    if highest >= needed:
        return ""
    return (
        f"V of every site may not be found, even in an hour: µ goes up to {highest:.2g} meV, and "
        f"should go up to {needed:.2g} for {prior.sites} sites of this disorder."
    )
