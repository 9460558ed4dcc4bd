"""The paper's scores: R² on standard-scaled labels, ΔV_dis(x_i) and Δα."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Self

import numpy as np
from sklearn.metrics import r2_score

from disorder_landscape.learning.scaling import LabelScaler
from disorder_landscape.physics.disorder import potential_from_components
from disorder_landscape.physics.parameters import FloatArray


@dataclass(frozen=True)
class Scores:
    """How well labels of test realizations are predicted."""

    r2: float
    """Scikit-learn's R² on standard-scaled Y, averaged over the labels with equal weights."""
    r2_by_label: dict[str, float]
    """R² of each component and of α."""
    delta_V: float
    """ΔV_dis(x_i) in meV: standard deviation of the error of the potential over all sites and test
    realizations. The potential is made from the components; the mean potential, which no label
    describes, is not counted."""
    delta_alpha: float | None
    """Δα in meV nm: standard deviation of the error of α over test realizations."""
    realizations: int
    """How many test realizations."""

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold."""
        return asdict(self)

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Return the scores that `to_dict` described."""
        return cls(**content)


def score(Y: FloatArray, Y_predicted: FloatArray, scaler: LabelScaler, sites: int) -> Scores:
    """Compare predicted with true labels.

    Parameters
    ----------
    Y, Y_predicted : array, shape (realization, label)
        Labels in meV and meV nm; at least two realizations.
    scaler : LabelScaler
        Names the labels and scales them. (R² per label is the same on any linear scale.)
    sites : int
        Sites of the wire.
    """
    scaled = scaler.scale(Y), scaler.scale(Y_predicted)
    by_label = r2_score(*scaled, multioutput="raw_values")
    n = scaler.components
    error = Y_predicted - Y
    return Scores(
        r2=float(r2_score(*scaled, multioutput="uniform_average")),
        r2_by_label={name: float(r2) for name, r2 in zip(scaler.names, by_label, strict=True)},
        delta_V=float(np.std(potential_from_components(error[:, :n], sites))),
        delta_alpha=float(np.std(error[:, n])) if error.shape[1] > n else None,
        realizations=len(Y),
    )
