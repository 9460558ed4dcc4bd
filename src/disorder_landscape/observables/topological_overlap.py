"""How far two wires are topological at the same chemical potentials and fields."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from disorder_landscape.model.parameters import Nanowire
from disorder_landscape.observables.visibility import topological_visibility

POINTS = 61, 81
"""Of μ and B, from zero on, at which T_IV is compared."""


def topological_points(
    true: Sequence[Nanowire], predicted: Sequence[Nanowire], mu_max: float, B_max: float
) -> tuple[int, int]:
    """Return at how many (wire, μ, B) both wires of a pair are topological, and at how many any.

    Their ratio is 1 if they agree everywhere, 0 if nowhere. Topological is where T_IV of the left
    end is negative (S-I).

    Parameters
    ----------
    true, predicted : sequence of Nanowire
        Of equal lengths.
    mu_max, B_max : float
        In meV and T.
    """
    mu, B = (
        np.linspace(0.0, end, points) for end, points in zip((mu_max, B_max), POINTS, strict=True)
    )
    one, other = (
        topological_visibility(wires, mu, B).sel(lead="L").to_numpy() < 0
        for wires in (true, predicted)
    )
    return int((one & other).sum()), int((one | other).sum())
