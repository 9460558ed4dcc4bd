"""What the network sees and what it answers: conductances, labels, and their scales."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, Self

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from sklearn.preprocessing import StandardScaler

from disorder_landscape.arguments import require
from disorder_landscape.model.parameters import NOISE_FLOOR, FloatArray
from disorder_landscape.model.quantities import AXES, CONDUCTANCES

ConductanceArray = NDArray[np.float32]


class Conductances(Protocol):
    """Conductances of many realizations that may be in files: an array, as far as it is used."""

    @property
    def shape(self) -> tuple[int, ...]:
        """(realization, mu, B, bias, channel)."""

    def __len__(self) -> int:
        """Return how many realizations there are."""

    def __getitem__(self, which: slice | NDArray[np.intp], /) -> ConductanceArray:
        """Return those of some realizations, in memory."""


CHANNELS = CONDUCTANCES
"""The network's input channels, in this order: the "4 different measurements" of S-II.2."""
COMPRESSION: ConductanceArray = np.array([0.2, 0.2, 0.003, 0.003], dtype=np.float32)
"""Scale s in e²/h of asinh(G/s) per channel: typical local and nonlocal conductances."""
ROWS_AT_A_TIME = 2000
"""Realizations that are compressed at a time, for memory's sake."""


def conductance_array(G: xr.Dataset) -> ConductanceArray:
    """Return what the network sees, whatever the order of the dimensions of G.

    Parameters
    ----------
    G : Dataset
        Variables G_LL, G_RR, G_LR, G_RL in e²/h, dims mu, B, bias and maybe realization.

    Returns
    -------
    array, shape (realization, mu, B, bias, channel)
        One realization where G has no such dimension.

    Raises
    ------
    ArgumentError
        If a variable or a dimension is missing or superfluous, or a conductance is not finite.
    """
    channels = []
    for name in CHANNELS:
        require(name in G, "G", f"hold the variables {', '.join(CHANNELS)}", f"{name} is missing")
        dims = set(G[name].dims)
        must = "have the dimensions mu, B, bias and at most realization"
        require(dims - {"realization"} == set(AXES), "G", must, f"{name} has {G[name].dims}")
        require(G[name].dtype.kind in "fiu", "G", "hold numbers", f"{name} holds something else")
        G_ab = G[name] if "realization" in dims else G[name].expand_dims("realization")
        with np.errstate(over="ignore"):
            channels.append(G_ab.transpose("realization", *AXES).to_numpy().astype(np.float32))
    same = len({channel.shape for channel in channels}) == 1 and channels[0].size > 0
    must = "hold the same realizations of each conductance, at least one"
    require(same, "G", must, f"their shapes are {', '.join(str(one.shape) for one in channels)}")
    X = np.stack(channels, axis=-1)
    require(bool(np.isfinite(X).all()), "G", "be finite", "it holds NaN or infinity")
    return X


def label_names(
    components: int, alpha_is_label: bool, mean_is_label: bool = False
) -> tuple[str, ...]:
    """Return the names of the labels: c_1 … c_n, then alpha, then mean."""
    names = [f"c_{n}" for n in range(1, components + 1)]
    return (*names, *["alpha"] * alpha_is_label, *["mean"] * mean_is_label)


def label_array(dataset: xr.Dataset, names: Sequence[str]) -> FloatArray:
    """Return the named labels, shape (realization, label), in meV and alpha in meV nm.

    The paper's are Y = (c₁ … c_n[, α]); mean is the potential's spatial mean, in meV.
    """
    columns = list(dataset["components"].transpose("component", "realization").to_numpy())
    if "alpha" in names:
        columns.append(dataset["alpha"].to_numpy())
    if "mean" in names:
        mean = dataset["mean"] if "mean" in dataset else dataset["potential"].mean("site")
        columns.append(mean.to_numpy())
    return np.column_stack(columns).astype(np.float64)


@dataclass(frozen=True, eq=False)
class LabelScaler:
    """Standard scaling of the labels: zero mean and unit variance over the training set.

    Parameters
    ----------
    names : tuple of str
        c_1 … c_n, alpha and mean.
    mean, std : array, shape (label,)
        In meV, for alpha in meV nm.
    """

    names: tuple[str, ...]
    mean: FloatArray
    std: FloatArray

    @classmethod
    def fit(cls, names: tuple[str, ...], Y: FloatArray) -> Self:
        """Return the scaler of a training set, Y of shape (realization, label)."""
        fitted = StandardScaler().fit(Y)
        return cls(names, fitted.mean_, fitted.scale_)

    def scale(self, Y: FloatArray) -> FloatArray:
        """Return standard-scaled labels, shape (…, label)."""
        return (Y - self.mean) / self.std

    def unscale(self, Y: FloatArray) -> FloatArray:
        """Return labels in meV and meV nm from standard-scaled ones, shape (…, label)."""
        return Y * self.std + self.mean

    @property
    def components(self) -> int:
        """How many of the labels are disorder components."""
        return sum(name.startswith("c_") for name in self.names)

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold, to the last bit."""
        return {"names": self.names, "mean": self.mean.tolist(), "std": self.std.tolist()}

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Return the scaler that `to_dict` described."""
        return cls(tuple(content["names"]), np.array(content["mean"]), np.array(content["std"]))


@dataclass(frozen=True, eq=False)
class InputScaler:
    """asinh(G/s), then standard scaling per pixel over the training set.

    Conductances reach from 10⁻⁴ to 2 e²/h; asinh is linear below s and logarithmic above, which
    shows the network the small ones too. Some pixels hardly vary over the training set: nonlocal
    ones at B = 0 by 10⁻¹⁰ e²/h. Errors of measurement would be all that the network sees of them,
    so that the standard deviation is taken as if each conductance had the experiment's errors, or
    the training's.

    Parameters
    ----------
    mean, std : array of float32, shape (mu, B, bias, channel)
        Of asinh(G/s), G with errors.
    """

    mean: ConductanceArray
    std: ConductanceArray

    @classmethod
    def fit(cls, *parts: Conductances, noise: float = NOISE_FLOOR) -> Self:
        """Return the scaler of a training set.

        Parameters
        ----------
        parts : arrays, shape (realization, mu, B, bias, channel)
            Conductances in e²/h, without errors.
        noise : float
            Deviation in e²/h of the errors that the network is to be shown; NOISE_FLOOR if less.
        """
        fitted = StandardScaler()
        for X in parts:
            for start in range(0, len(X), ROWS_AT_A_TIME):
                compressed = np.arcsinh(X[start : start + ROWS_AT_A_TIME] / COMPRESSION)
                fitted.partial_fit(compressed.reshape(len(compressed), -1))
        mean, variance = (
            values.reshape(parts[0].shape[1:]) for values in (fitted.mean_, fitted.var_)
        )
        std = np.sqrt(variance + (max(noise, NOISE_FLOOR) / COMPRESSION) ** 2)
        return cls(mean.astype(np.float32), std.astype(np.float32))

    def scale(self, X: ConductanceArray) -> ConductanceArray:
        """Return the network's input, shape (realization, mu, B, bias, channel)."""
        compressed: ConductanceArray = np.arcsinh(X / COMPRESSION)
        return (compressed - self.mean) / self.std

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold, to the last bit."""
        return {"mean": self.mean.tolist(), "std": self.std.tolist()}

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Return the scaler that `to_dict` described."""
        return cls(
            np.array(content["mean"], dtype=np.float32), np.array(content["std"], dtype=np.float32)
        )
