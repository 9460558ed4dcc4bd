"""Kind "noise": what R² a network keeps when the conductances of the test set have errors.

The paper: Gaussian errors of 0.01, 0.05 and 0.1 e²/h leave R² = 0.99, 0.98 and 0.97. It does not
say whether the training data had errors too, so both are measured, and local and nonlocal
conductances apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
import xarray as xr

from disorder_landscape.chain import read_test_set
from disorder_landscape.learning.metrics import score
from disorder_landscape.learning.model import TrainedModel, load_model
from disorder_landscape.learning.scaling import (
    CHANNELS,
    ConductanceArray,
    conductance_array,
    label_array,
)
from disorder_landscape.runs import Run
from disorder_landscape.studies.fresh_wires import Noise
from disorder_landscape.studies.study import Place
from disorder_landscape.studies.trainings import (
    PlannedRun,
    TrainedPlan,
    generate_datasets,
    model_folder,
    trained,
)

CHANNELS_WITH_ERRORS = {
    "all": CHANNELS,
    "local": ("G_LL", "G_RR"),
    "nonlocal": ("G_LR", "G_RL"),
}


@dataclass(frozen=True)
class Task:
    """One network: the name of its runs, the errors in e²/h it is trained with, and its seed."""

    training: str
    training_noise: float
    seed: int
    run: PlannedRun


class NoisePlan(TrainedPlan):
    """Networks whose test wires have errors of several sizes."""

    kind: Literal["noise"]
    noise: tuple[Noise, ...]
    """Standard deviations in e²/h."""

    keys: ClassVar = ("training", "training_noise", "seed")
    common: ClassVar = ("noise",)

    def tasks(self) -> Sequence[Task]:
        """Return the networks."""
        return [
            Task(run.name, run.config.training.noise, run.config.training.seed, run)
            for run in self.trainings()
        ]

    def prepare(self, tasks: Sequence[Task], place: Place) -> None:
        """Generate the datasets."""
        generate_datasets([task.run for task in tasks], place)

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Return R² over the errors of the test wires, by the channels that have them.

        The minutes of the training stand in the first row.
        """
        minutes = trained(task.run, place).minutes
        config = task.run.config
        # A run's dataset is beside its folder.
        wires = read_test_set(Run(task.training, config, place.build / task.training))
        R2 = r2_with_errors(load_model(model_folder(task.run, place.build)), wires, self.noise)
        rows: list[dict[str, object]] = [
            {
                "training": task.training,
                "training_noise": task.training_noise,
                "seed": task.seed,
                "channels": channels,
                "noise": one,
                "R2": round(float(R2.sel(channels=channels, noise=one)), 4),
                "minutes": None,
            }
            for channels in CHANNELS_WITH_ERRORS
            for one in self.noise
        ]
        rows[0]["minutes"] = minutes
        return rows


def with_errors(
    X: ConductanceArray, noise: float, channels: tuple[str, ...] = CHANNELS, seed: int = 0
) -> ConductanceArray:
    """Return conductances with independent Gaussian errors on some channels.

    Parameters
    ----------
    X : array, shape (…, channel)
        In e²/h.
    noise : float
        Standard deviation in e²/h.
    channels : tuple of str
        Which have errors.
    seed : int
        The errors are a function of it and of the shape alone.
    """
    errors = np.random.default_rng(seed).standard_normal(X.shape, dtype=np.float32)
    on = np.array([name in channels for name in CHANNELS], dtype=np.float32)
    return np.asarray(X + np.float32(noise) * on * errors)


def r2_with_errors(
    model: TrainedModel, test: xr.Dataset, noises: Sequence[float], seed: int = 0
) -> xr.DataArray:
    """Return R² of a network over the errors of its test set's conductances.

    Parameters
    ----------
    model : TrainedModel
    test : Dataset
        Conductances with a dim realization, components and alpha, as `chain.read_test_set` gives.
    noises : sequence of float
        In e²/h.
    seed : int
        Of the errors.

    Returns
    -------
    xarray.DataArray, dims (channels, noise)
        Noise in e²/h.
    """
    dataset = model.config.dataset
    X, Y = conductance_array(test), label_array(test, model.labels.names)
    R2 = np.array(
        [
            [
                score(
                    Y,
                    model.predict_labels(with_errors(X, noise, channels, seed)),
                    model.labels,
                    dataset.sites,
                ).r2
                for noise in noises
            ]
            for channels in CHANNELS_WITH_ERRORS.values()
        ]
    )
    return xr.DataArray(
        R2, {"channels": list(CHANNELS_WITH_ERRORS), "noise": list(noises)}, ("channels", "noise")
    )
