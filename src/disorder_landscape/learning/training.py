"""Training of the network as the paper did it (S-II.2), resumable after every epoch."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from tqdm import tqdm

from disorder_landscape.arguments import require
from disorder_landscape.config import Config, TrainingConfig
from disorder_landscape.files import read_json, write_json
from disorder_landscape.learning.backend import import_keras
from disorder_landscape.learning.checkpoints import (
    claim,
    drop_checkpoints,
    load_checkpoint,
    save_checkpoint,
)
from disorder_landscape.learning.curves import Epoch, plot_curves, write_curves
from disorder_landscape.learning.metrics import Scores, score
from disorder_landscape.learning.mirror import mirrored
from disorder_landscape.learning.model import METRICS, TrainedModel, check_grid
from disorder_landscape.learning.networks import build_network
from disorder_landscape.learning.scaling import (
    ConductanceArray,
    InputScaler,
    LabelScaler,
    conductance_array,
    label_array,
    label_names,
)
from disorder_landscape.physics.parameters import FloatArray


def train(
    dataset: xr.Dataset,
    config: Config,
    folder: str | Path,
    command: str = "",
    progress: bool = True,
) -> Scores:
    """Train a network on a dataset and write the model's folder (what it holds: `model`).

    Adam on the mean squared error of standard-scaled Y, in sets of epochs, the learning rate
    divided by 10 from set to set. A training that was interrupted goes on after its last finished
    epoch, with the numbers it would have had; one that is finished is left alone. The validation
    data are the test realizations, as in the paper; nothing is chosen by them.

    Parameters
    ----------
    dataset : Dataset
        Variables G_LL … G_RL (realization, mu, B, bias) in e²/h, components (realization,
        component) in meV, alpha (realization) in meV nm; attrs config_hash and command.
    config : Config
        The run; its dataset section is the one the dataset was made with.
    folder : path
        New, empty, or of this very training.
    command : str
        The command that started this, for the record.
    progress : bool
        Show a progress bar.

    Returns
    -------
    Scores
        Of the test realizations, as in metrics.json.

    Raises
    ------
    ArgumentError
        If the dataset is not the configuration's, or the folder is another training's.
    """
    folder = Path(folder)
    made_with = dataset.attrs.get("config_hash")
    but = f"its hash is {made_with}, the config's {config.dataset.hash}"
    require(made_with == config.dataset.hash, "dataset", "be the one the config describes", but)
    check_grid(dataset, config.dataset, "dataset")
    training, test = split(dataset.sizes["realization"], config.training.test_fraction)
    X = conductance_array(dataset)
    Y = label_array(dataset, config.dataset.alpha_is_label)
    claim(folder, config, dataset, command)
    if (folder / METRICS).exists():
        if progress:
            tqdm.write(f"'{folder}' holds this very training, finished: nothing to do.")
        return Scores.from_dict(read_json(folder / METRICS))

    X_training, Y_training = X[training], Y[training]
    if config.training.mirror:
        copies = mirrored(X_training, Y_training, config.dataset.components)
        X_training = np.concatenate([X_training, copies[0]])
        Y_training = np.concatenate([Y_training, copies[1]])
    model, curves = _start_or_resume(folder, config, X_training, Y_training)
    x, y = model.scale_inputs(X_training), model.labels.scale(Y_training).astype(np.float32)

    def scores() -> Scores:
        predicted = model.predict_labels(X[test])
        return score(Y[test], predicted, model.labels, config.dataset.sites)

    with tqdm(
        total=sum(config.training.epochs) * len(x),
        initial=len(curves) * len(x),
        unit=" realizations",
        disable=not progress,
    ) as bar:
        for epoch, set_, rate in schedule(config.training):
            if epoch <= len(curves):
                continue
            bar.set_description(f"epoch {epoch}/{sum(config.training.epochs)}")
            started = time.perf_counter()
            model.network.optimizer.learning_rate = rate
            # A function of seed and epoch alone, so that a resumed training sees the same order.
            order = np.random.default_rng([config.training.seed, epoch]).permutation(len(x))
            loss = _train_epoch(
                model.network, x, y, order=order, batch_size=config.training.batch_size, bar=bar
            )
            r2 = scores().r2
            seconds = time.perf_counter() - started
            curves.append(Epoch(epoch, set_, rate, loss, r2, seconds))
            save_checkpoint(folder, model.network, curves)
            write_curves(folder / "curves.csv", curves)

    final = scores()
    model.save(folder)
    for suffix in ("pdf", "png"):
        plot_curves(folder / f"curves.{suffix}", curves)
    write_json(folder / METRICS, final.to_dict())
    drop_checkpoints(folder)
    return final


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


def schedule(training: TrainingConfig) -> Iterator[tuple[int, int, float]]:
    """Yield epoch, set (both from 1) and learning rate, which each set divides by 10 (S-II.2)."""
    epoch = 0
    for i, epochs in enumerate(training.epochs):
        for _ in range(epochs):
            epoch += 1
            yield epoch, i + 1, training.learning_rate / 10**i


def _start_or_resume(
    folder: Path, config: Config, X: ConductanceArray, Y: FloatArray
) -> tuple[TrainedModel, list[Epoch]]:
    names = label_names(config.dataset.components, config.dataset.alpha_is_label)
    labels = LabelScaler.fit(names, Y)
    inputs = InputScaler.fit(X) if config.training.compress_inputs else None
    saved = load_checkpoint(folder)
    if saved is not None:
        return TrainedModel(saved[0], labels, inputs, config), saved[1]
    import_keras().utils.set_random_seed(config.training.seed)
    network = build_network(
        X.shape[1:],
        len(names),
        config.network.width_fraction,
        config.training.learning_rate,
        config.training.precision,
    )
    return TrainedModel(network, labels, inputs, config), []


def _train_epoch(
    network: Any,
    x: ConductanceArray,
    y: ConductanceArray,
    *,
    order: NDArray[np.intp],
    batch_size: int,
    bar: Any,
) -> float:
    """Take one step per batch in the given order, return the mean loss per realization."""
    total = 0.0
    for start in range(0, len(order), batch_size):
        batch = order[start : start + batch_size]
        loss = float(network.train_on_batch(x[batch], y[batch], return_dict=True)["loss"])
        total += loss * len(batch)
        bar.set_postfix({"loss": f"{total / (start + len(batch)):.4f}"}, refresh=False)
        bar.update(len(batch))
    return total / len(order)
