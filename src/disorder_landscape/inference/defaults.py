"""What `infer` and `verify` do unless they are told otherwise."""

from __future__ import annotations

import numpy as np

from disorder_landscape.model.disorder import MEAN_STD
from disorder_landscape.model.parameters import FloatArray

SAMPLES = 64
"""Of the posterior, which are returned."""
CONTROLS = 50
"""Wires with wrong disorder."""
WIDEST_SHIFT = 3 * MEAN_STD
"""Of V in meV, to either side."""
OTHER_BARRIERS = (25.0, 10.0)
"""Left and right in meV, of measurements that check an answer; in the training both are 15."""
OTHER_ANGLE = np.pi / 6
"""θ of the field, of others."""


def shifts(count: int) -> FloatArray:
    """Return so many means of V in meV to try; of an odd number one is 0."""
    return np.linspace(-WIDEST_SHIFT, WIDEST_SHIFT, count) if count > 1 else np.zeros(count)


SHIFTS = shifts(13)
"""Means of V in meV that are tried; the steps are about kT."""
