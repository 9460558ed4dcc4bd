"""Carry a study out: what its table lacks is generated, trained and scored."""

from __future__ import annotations

import math
from pathlib import Path

from tqdm import tqdm

from disorder_landscape.chain import dataset_folder
from disorder_landscape.dataset import shards
from disorder_landscape.learning.curves import training_seconds
from disorder_landscape.studies.plan import PlannedRun, Study
from disorder_landscape.studies.trainings_table import Result, read_table, write_table


def run_study(study: Study, table: Path, build: Path, workers: int = 2) -> list[Result]:
    """Carry out what is missing of a study and return its whole table, in the plan's order.

    The table is written after every training, so that an interrupted study goes on where it was; a
    training goes on after its last finished epoch. Datasets and models are shared with all other
    studies, in build/datasets and build/models.

    Parameters
    ----------
    study : Study
    table : Path
        CSV file. Rows of trainings that the plan no longer has are dropped.
    build : Path
    workers : int
        Processes that generate.

    Raises
    ------
    ArgumentError
        If the table or a folder cannot be read or written; what was finished stays.
    """
    there = {result.key: result for result in read_table(table)}
    missing = [run for run in study.runs if run.key not in there]
    with tqdm(missing, desc=study.name, unit=" trainings") as bar:
        for run in bar:
            bar.set_postfix_str(f"{run.name}, {run.config.training.realizations} realizations")
            there[run.key] = carry_out(run, build, workers)
            write_table(table, [there[one.key] for one in study.runs if one.key in there])
    return [there[run.key] for run in study.runs]


def carry_out(run: PlannedRun, build: Path, workers: int) -> Result:
    """Generate, train and score one training."""
    from disorder_landscape.learning.training import train

    config, folder = run.config, model_folder(run, build)
    if not (folder / "metrics.json").exists():
        dataset = dataset_folder(config.dataset, build)
        shards.generate(config.dataset, dataset, workers)
        train(shards.read_shards(config.dataset, dataset), config, folder, "landscape study")
    return _result(run, folder)


def model_folder(run: PlannedRun, build: Path) -> Path:
    """Return the folder of a training's network."""
    return build / "models" / run.key


def _result(run: PlannedRun, folder: Path) -> Result:
    from disorder_landscape.learning.examples import split
    from disorder_landscape.learning.model import load_model, read_model_file

    dataset, network, training = run.config.dataset, run.config.network, run.config.training
    metrics = read_model_file(folder / "metrics.json")
    used = training.realizations or split(dataset.realizations, training.test_fraction)[0].stop
    weights = load_model(folder).network.trainable_weights
    return Result(
        name=run.name,
        key=run.key,
        dataset=dataset.hash,
        components=dataset.components,
        amplitude=dataset.amplitude,
        realizations=used,
        test_realizations=metrics["realizations"],
        architecture=network.architecture,
        width_fraction=network.width_fraction,
        weights=sum(math.prod(weight.shape) for weight in weights),
        compress_inputs=training.compress_inputs,
        mirror=training.mirror,
        noise=training.noise,
        seed=training.seed,
        R2=metrics["r2"],
        delta_V=metrics["delta_V"],
        delta_alpha=metrics["delta_alpha"],
        minutes=round(training_seconds(folder / "curves.csv") / 60, 2),
    )
