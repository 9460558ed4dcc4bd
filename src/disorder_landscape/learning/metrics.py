"""The paper's scores: R² on standard-scaled labels, ΔV_dis(x_i) and Δα."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Self

import numpy as np
from sklearn.metrics import r2_score

from disorder_landscape.learning.scaling import LabelScaler
from disorder_landscape.model.disorder import potential_from_components
from disorder_landscape.model.parameters import FloatArray


@dataclass(frozen=True)
class Scores:
    """How well labels of test realizations are predicted."""

    r2: float
    """Scikit-learn's R² on standard-scaled Y, averaged over the paper's labels, the components and
    α, with equal weights."""
    r2_by_label: dict[str, float]
    """R² of each component and of α, and of the mean of V where it is predicted."""
    delta_V: float
    """ΔV_dis(x_i) in meV: standard deviation of the error of the potential over all sites and test
    realizations. The potential is made from the components; the mean potential, which no label
    describes, is not counted."""
    delta_alpha: float | None
    """Δα in meV nm: standard deviation of the error of α over test realizations."""
    realizations: int
    """How many test realizations."""
    delta_mean: float | None = None
    """The same of the mean of V in meV, where it is predicted; the paper does not."""

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
    by_label = r2_score(scaler.scale(Y), scaler.scale(Y_predicted), multioutput="raw_values")
    r2 = {name: float(one) for name, one in zip(scaler.names, by_label, strict=True)}
    error = Y_predicted - Y
    std = dict(zip(scaler.names, error.std(axis=0).tolist(), strict=True))
    return Scores(
        r2=float(np.mean([one for name, one in r2.items() if name != "mean"])),
        r2_by_label=r2,
        delta_V=float(np.std(potential_from_components(error[:, : scaler.components], sites))),
        delta_alpha=std.get("alpha"),
        realizations=len(Y),
        delta_mean=std.get("mean"),
    )
