"""Where a set's levels are densest: there its model is compared with the solver as well.

A model of few nodes may follow the wire at every check, to 1e-8, and yet be all wrong in between,
where many levels lie closer together than the nodes, at the edge of the induced gap for example: in
96 of 6,000 odd sets (µ to 0.6 meV, γ from 0.05 to 0.5 meV, no barriers or up to 300 meV) the error,
up to 0.01 e²/h, was more than three times an estimate from CHECKS energies alone. In all of them
seven levels of the model lay within 0.7 of the nodes' distance. Two comparisons, each in the widest
gap of one of the densest runs of levels, show it in all but one.
"""

from __future__ import annotations

import numba as nb
import numpy as np

from disorder_landscape.physics.energy_plan import SOUGHT
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.pole_starts import INVISIBLE

RUN = 4
"""Gaps between the levels of a run."""
ELSEWHERE = (0.382, 0.764)
"""Where sets of fewer levels are checked: shares of the window, as angles."""


@nb.njit(cache=True, error_model="numpy")
def dense_energies(
    E: FloatArray, weight: FloatArray, hop: float, window: float, out: FloatArray
) -> None:  # pragma: no cover
    """Write SOUGHT energies in meV, of levels E (level,) and what the ends see of them.

    Distances are measured in θ, ω = W sin θ, in which the nodes are as far from each other.
    """
    angles = np.empty(E.size)
    count = 0
    for n in range(E.size):
        coupling = 0.0
        for i in range(weight.shape[1]):
            coupling += weight[n, i] ** 2
        if E[n] < window and hop * coupling > INVISIBLE:
            angles[count] = np.arcsin(E[n] / window)
            count += 1
    angles = np.sort(angles[:count])
    taken = np.zeros(count, dtype=np.bool_)
    for k in range(SOUGHT):
        least, first = np.inf, -1
        for n in range(count - RUN):
            span = angles[n + RUN] - angles[n]
            if span < least and not taken[n] and not taken[n + RUN]:
                least, first = span, n
        at = ELSEWHERE[k] * np.pi / 2
        if first >= 0:
            widest = -1.0
            for n in range(first, first + RUN):
                gap = angles[n + 1] - angles[n]
                if gap > widest:
                    widest, at = gap, (angles[n] + angles[n + 1]) / 2
            taken[first : first + RUN + 1] = True
        out[k] = window * np.sin(at)
