"""What `infer` and `verify` do unless they are told otherwise."""

from __future__ import annotations

import numpy as np

from disorder_landscape.model.disorder import MEAN_STD

SAMPLES = 64
"""Of the posterior, which are returned."""
CONTROLS = 50
"""Wires with wrong disorder."""
WIDEST_SHIFT = 3 * MEAN_STD
"""Of V in meV, to either side."""
SHIFTS = np.linspace(-WIDEST_SHIFT, WIDEST_SHIFT, 13)
"""Means of V in meV that are tried; the steps are about kT."""
