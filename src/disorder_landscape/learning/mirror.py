"""The wire's mirror image, which gives training data and better predictions for nothing.

x → −x swaps the leads L and R and turns cₙ into (−1)ⁿ cₙ, since the cosine n of the DCT-II is even
in the middle of the wire for even n and odd for odd n. α stays: its sign is a choice of spin axes.
"""

from __future__ import annotations

import numpy as np

from disorder_landscape.learning.scaling import CHANNELS, ConductanceArray
from disorder_landscape.model.parameters import FloatArray

_SWAPPED = [CHANNELS.index(name.translate(str.maketrans("LR", "RL"))) for name in CHANNELS]


def mirrored_conductance(X: ConductanceArray) -> ConductanceArray:
    """Return the conductance of the mirrored wires, shape (…, channel)."""
    return X[..., _SWAPPED]


def mirrored_labels(Y: FloatArray, components: int) -> FloatArray:
    """Return the labels of the mirrored wires.

    Parameters
    ----------
    Y : array, shape (…, label)
        c₁ … c_n in meV, then α if it is a label.
    components : int
        How many of the labels are components, n.
    """
    sign = np.ones(Y.shape[-1])
    sign[0:components:2] = -1  # c₁, c₃, …
    return sign * Y
