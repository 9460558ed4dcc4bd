"""Training of the network as the paper did it (S-II.2), resumable."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from tqdm import tqdm

from disorder_landscape.arguments import require
from disorder_landscape.config import Config, TrainingConfig
from disorder_landscape.dataset.mapped import MappedConductances
from disorder_landscape.dataset.shards import read_disorder
from disorder_landscape.estimates import Pace
from disorder_landscape.files import write_json
from disorder_landscape.learning.backend import import_keras
from disorder_landscape.learning.checkpoints import (
    Checkpoints,
    claim,
    drop_checkpoints,
    load_checkpoint,
)
from disorder_landscape.learning.curves import Epoch, plot_curves, write_curves
from disorder_landscape.learning.ensembles import combine, member_configs
from disorder_landscape.learning.examples import Examples, Rows, chosen, split
from disorder_landscape.learning.metrics import Scores, score
from disorder_landscape.learning.model import TrainedModel, on_grid_of, read_model_file
from disorder_landscape.learning.model_files import METRICS
from disorder_landscape.learning.networks.build import build_network
from disorder_landscape.learning.scaling import (
    Conductances,
    conductance_array,
    label_array,
    label_names,
)
from disorder_landscape.learning.schedule import learning_rate, numbered_epochs
from disorder_landscape.locks import kept_from_others


def train(
    dataset: xr.Dataset,
    config: Config,
    folder: str | Path,
    command: str = "",
    progress: bool = True,
    conductances: Conductances | None = None,
) -> Scores:
    """Train a network on a dataset and write the model's folder (what it holds: `model`).

    Adam on the mean squared error of standard-scaled Y, in sets of epochs, the learning rate
    divided by 10 from set to set, or along a cosine; `training.networks` of them, each in a folder
    of its own inside this one, if their mean is to predict. A training that was interrupted goes on
    after its last saved epoch, with the numbers it would have had; one that is finished is left
    alone. The validation data are the test realizations, as in the paper; nothing is chosen by
    them.

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
    conductances : Conductances, optional
        Those of the dataset, where it does not hold them itself since they may exceed the memory.

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
    if conductances is None:
        conductances = conductance_array(on_grid_of(config.dataset, dataset, "dataset"))
    training, test = split(dataset.sizes["realization"], config.training.test_fraction)
    used = chosen(training, config.training.realizations, config.training.seed)
    rows, Y = np.arange(len(conductances)), label_array(dataset, names_of_labels(config))
    claim(folder, config, dataset, command)
    with kept_from_others(folder):
        if (folder / METRICS).exists():
            if progress:
                tqdm.write(f"'{folder}' holds this very training, finished: nothing to do.")
            return Scores.from_dict(read_model_file(folder / METRICS))

        def scores(model: TrainedModel) -> Scores:
            predicted = model.predict_labels(Rows(conductances, rows[test]))
            return score(Y[test], predicted, model.labels, config.dataset.sites)

        if config.training.networks == 1:
            X = Rows(conductances, rows[used])
            examples = Examples(X, Y[used], config.dataset.components, config.training)
            model, curves = _train_one(examples, config, folder, scores, progress)
        else:
            folders = [folder / f"network-{i + 1}" for i in range(config.training.networks)]
            for member, one in zip(folders, member_configs(config), strict=True):
                train(dataset, one, member, command, progress, conductances)
            model, curves = combine(folders, config)
            write_curves(folder / "curves.csv", curves)

        final = scores(model)
        model.save(folder)
        for suffix in ("pdf", "png"):
            plot_curves(folder / f"curves.{suffix}", curves)
        write_json(folder / METRICS, final.to_dict())
        drop_checkpoints(folder)
        return final


def train_from_shards(
    config: Config, shards: Path, folder: Path, command: str, progress: bool = True
) -> Scores:
    """Do as `train`, with a dataset in a folder of shards that need not fit into memory."""
    dataset = read_disorder(config.dataset, shards)
    conductances = MappedConductances(config.dataset, shards)
    return train(dataset, config, folder, command, progress, conductances)


def _train_one(
    examples: Examples,
    config: Config,
    folder: Path,
    scores: Callable[[TrainedModel], Scores],
    progress: bool,
) -> tuple[TrainedModel, list[Epoch]]:
    """Train a single network from where it stands to the end of its schedule."""
    model, curves = _start_or_resume(folder, config, examples)
    steps = Steps(model, examples, config.training)
    checkpoints = Checkpoints(folder)
    per_epoch = len(examples) * config.training.passes
    left = sum(config.training.epochs) - len(curves)
    pace = Pace("train", left * per_epoch, tqdm.write if progress else lambda said: None)
    with tqdm(
        total=sum(config.training.epochs) * per_epoch,
        initial=len(curves) * per_epoch,
        unit=" realizations",
        disable=not progress,
    ) as bar:
        for epoch, set_ in numbered_epochs(config.training)[len(curves) :]:
            bar.set_description(f"epoch {epoch}/{sum(config.training.epochs)}")
            started = time.perf_counter()
            loss = steps.take_epoch(epoch, bar, pace)
            r2 = scores(model).r2
            seconds = time.perf_counter() - started
            curves.append(
                Epoch(epoch, set_, learning_rate(config.training, epoch), loss, r2, seconds)
            )
            checkpoints.save_if_due(model.network, curves)
            write_curves(folder / "curves.csv", curves)
    return model, curves


@dataclass(frozen=True)
class Steps:
    """The steps of a training."""

    model: TrainedModel
    examples: Examples
    training: TrainingConfig

    def take_epoch(self, epoch: int, bar: Any, pace: Pace) -> float:
        """Take one step per batch, in an order of their own; return the mean loss per example."""
        # Functions of seed and epoch alone, so that a resumed training sees the same.
        shuffle = np.random.default_rng([self.training.seed, epoch])
        passes = [shuffle.permutation(len(self.examples)) for _ in range(self.training.passes)]
        order = np.concatenate(passes)
        noise = np.random.default_rng([self.training.seed, epoch, 1])
        batch_size, network = self.training.batch_size, self.model.network
        total = 0.0
        for start in range(0, len(order), batch_size):
            network.optimizer.learning_rate = learning_rate(
                self.training, epoch, start / len(order)
            )
            which = order[start : start + batch_size]
            x = self.model.scale_inputs(self.examples.conductances(which, noise))
            y = self.model.labels.scale(self.examples.labels(which)).astype(np.float32)
            loss = float(network.train_on_batch(x, y, return_dict=True)["loss"])
            total += loss * len(which)
            bar.set_postfix({"loss": f"{total / (start + len(which)):.4f}"}, refresh=False)
            bar.update(len(which))
            pace.step(len(which))
        return total / len(order)


def names_of_labels(config: Config) -> tuple[str, ...]:
    """Return the names of what a configuration's network predicts."""
    dataset = config.dataset
    return label_names(dataset.components, dataset.alpha_is_label, config.training.predict_mean)


def _start_or_resume(
    folder: Path, config: Config, examples: Examples
) -> tuple[TrainedModel, list[Epoch]]:
    names = names_of_labels(config)
    labels = examples.fit_labels(names)
    inputs = examples.fit_inputs() if config.training.compress_inputs else None
    saved = load_checkpoint(folder)
    if saved is not None:
        return TrainedModel(saved[0], labels, inputs, config), saved[1]
    import_keras().utils.set_random_seed(config.training.seed)
    network = build_network(
        examples.X.shape[1:],
        len(names),
        config.network.width_fraction,
        config.training.learning_rate,
        config.training.precision,
        config.network.architecture,
        config.training.weight_decay,
    )
    return TrainedModel(network, labels, inputs, config), []
