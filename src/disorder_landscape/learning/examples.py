"""What a training shows the network: wires, their mirror images, errors of measurement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.arguments import require
from disorder_landscape.config import TrainingConfig
from disorder_landscape.learning.mirror import MirrorImages, mirrored_conductance, mirrored_labels
from disorder_landscape.learning.scaling import (
    ConductanceArray,
    Conductances,
    InputScaler,
    LabelScaler,
)
from disorder_landscape.model.parameters import FloatArray


@dataclass(frozen=True, eq=False)
class Rows:
    """Some realizations of many, whose conductances are read when they are asked for.

    Parameters
    ----------
    whole : Conductances
    which : array of int, shape (realization,)
    """

    whole: Conductances
    which: NDArray[np.intp]

    @property
    def shape(self) -> tuple[int, ...]:
        """(realization, mu, B, bias, channel)."""
        return (len(self), *self.whole.shape[1:])

    def __len__(self) -> int:
        """Return how many realizations there are."""
        return len(self.which)

    def __getitem__(self, which: slice | NDArray[np.intp]) -> ConductanceArray:
        """Return the conductances of some of them."""
        return self.whole[self.which[which]]


@dataclass(frozen=True, eq=False)
class Examples:
    """The training realizations, and with `training.mirror` their mirror images behind them.

    Conductances and images are made when they are asked for: a dataset may exceed the memory.

    Parameters
    ----------
    X : Conductances, shape (realization, mu, B, bias, channel)
        In e²/h.
    Y : array, shape (realization, label)
        Labels in meV and meV nm.
    components : int
        How many of the labels are disorder components.
    training : TrainingConfig
        Says whether to mirror, and the noise.
    """

    X: Conductances
    Y: FloatArray
    components: int
    training: TrainingConfig

    def __len__(self) -> int:
        """Return how many examples an epoch shows."""
        return len(self.X) * (2 if self.training.mirror else 1)

    def fit_labels(self, names: tuple[str, ...]) -> LabelScaler:
        """Return the scaler of all examples' labels."""
        return LabelScaler.fit(names, self.labels(np.arange(len(self))))

    def fit_inputs(self) -> InputScaler:
        """Return the scaler of all examples' conductances."""
        parts = [self.X, MirrorImages(self.X)] if self.training.mirror else [self.X]
        return InputScaler.fit(*parts, noise=self.training.typical_noise)

    def labels(self, which: NDArray[np.intp]) -> FloatArray:
        """Return the labels of these examples, shape (example, label)."""
        Y = self.Y[which % len(self.X)]
        images = mirrored_labels(Y, self.components)
        return np.where((which < len(self.X))[:, None], Y, images)

    def conductances(
        self, which: NDArray[np.intp], rng: np.random.Generator | None = None
    ) -> ConductanceArray:
        """Return the conductances of these examples, with errors drawn from rng if it is given."""
        X = self.X[which % len(self.X)]
        images = which >= len(self.X)
        X[images] = mirrored_conductance(X[images])
        if rng is not None and self.training.noise > 0:
            X += self._noise(len(X), rng) * rng.standard_normal(X.shape, dtype=np.float32)
        return X

    def _noise(self, examples: int, rng: np.random.Generator) -> ConductanceArray:
        """Return the standard deviation of each example's errors in e²/h."""
        low, high = self.training.noise, self.training.noise_up_to
        if high is None:
            return np.array(low, dtype=np.float32)
        noise = np.exp(rng.uniform(np.log(low), np.log(high), size=(examples, 1, 1, 1, 1)))
        return noise.astype(np.float32)


def split(realizations: int, test_fraction: float) -> tuple[slice, slice]:
    """Return which realizations train and which, the last ones, test (S-II.2: 90 % and 10 %).

    Raises
    ------
    ArgumentError
        If fewer than two are left on a side: R² needs two.
    """
    test = round(test_fraction * realizations)
    must = "leave two realizations at least for training and for testing"
    but = f"its {realizations} are split into {realizations - test} and {test}"
    require(min(test, realizations - test) >= 2, "dataset", must, but)
    return slice(0, realizations - test), slice(realizations - test, realizations)


def chosen(training: slice, realizations: int | None, seed: int) -> slice | NDArray[np.intp]:
    """Return as many training realizations, drawn by the seed; all of them if none is asked for.

    Those of a smaller number are among those of a larger one.

    Raises
    ------
    ArgumentError
        If there are fewer.
    """
    if realizations is None:
        return training
    there = training.stop - training.start
    must = f"be at most {there}, the number of training realizations"
    require(realizations <= there, "training.realizations", must, f"it is {realizations}")
    order = np.random.default_rng(seed).permutation(np.arange(training.start, training.stop))
    return np.sort(order[:realizations])
