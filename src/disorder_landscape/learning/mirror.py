"""The wire's mirror image, which gives training data and better predictions for nothing.

x → −x swaps the leads L and R and turns cₙ into (−1)ⁿ cₙ, since the cosine n of the DCT-II is even
in the middle of the wire for even n and odd for odd n. α stays: its sign is a choice of spin axes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.learning.scaling import CHANNELS, ConductanceArray, Conductances
from disorder_landscape.model.parameters import FloatArray

_SWAPPED = [CHANNELS.index(name.translate(str.maketrans("LR", "RL"))) for name in CHANNELS]


def mirrored_conductance(X: ConductanceArray) -> ConductanceArray:
    """Return the conductance of the mirrored wires, shape (…, channel)."""
    return X[..., _SWAPPED]


@dataclass(frozen=True, eq=False)
class MirrorImages:
    """The conductances of the mirrored wires of others, made when they are asked for."""

    X: Conductances

    @property
    def shape(self) -> tuple[int, ...]:
        """(realization, mu, B, bias, channel)."""
        return self.X.shape

    def __len__(self) -> int:
        """Return how many realizations there are."""
        return len(self.X)

    def __getitem__(self, which: slice | NDArray[np.intp]) -> ConductanceArray:
        """Return those of some realizations."""
        return mirrored_conductance(self.X[which])


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
