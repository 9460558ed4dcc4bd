"""The chain of one run: dataset, trained network, test realizations with their predictions."""

from __future__ import annotations

import hashlib
from pathlib import Path

import xarray as xr
from tqdm import tqdm

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.dataset import shards
from disorder_landscape.dataset.realizations import simulate
from disorder_landscape.dataset.store import provenance, read_dataset, write_dataset
from disorder_landscape.estimates import announce_repeated
from disorder_landscape.executors import slurm
from disorder_landscape.executors.executor import WHOLE, Executor, Share
from disorder_landscape.executors.local import LocalProcesses
from disorder_landscape.learning.model_files import NETWORK, SCALER
from disorder_landscape.locks import kept_from_others
from disorder_landscape.model.parameters import NOISE_FLOOR
from disorder_landscape.model.quantities import DRAWN, with_units
from disorder_landscape.runs import Run, shipped_test_set
from disorder_landscape.solver import compiled


def jobs_folder(run: Run) -> Path:
    """Return the folder of the jobs of Slurm that make a run's dataset, and of their logs."""
    return slurm.jobs_folder(run.folder.parent, f"generate-{run.name}")


def generate(run: Run, executor: Executor, share: Share = WHOLE) -> None:
    """Make what is missing of the run's dataset, or of a share of it, with a progress bar.

    Of two processes with the same dataset one waits, unless each has a share of it.
    """
    with kept_from_others(run.dataset_folder, shared=not share.is_whole):
        _generate(run, executor, share)
    warning = accuracy_warning(shards.status(run.config.dataset, run.dataset_folder))
    if warning:
        print(warning)


def _generate(run: Run, executor: Executor, share: Share) -> None:
    config = run.config.dataset
    sizes = [len(shards.shard_indices(config, k)) for k in range(shards.shard_count(config))]
    missing = shards.missing_shards(config, run.dataset_folder, share)
    wires, in_all = sum(sizes[k] for k in missing), sum(share.of(sizes))
    if missing:
        with compiled.threads_at_work(1):
            per_core = wires / executor.at_a_time
            announce_repeated("generate", lambda k: simulate(config, range(k, k + 1)), per_core)
    with tqdm(
        total=in_all, unit=" realizations", desc="generate", smoothing=0.1, initial=in_all - wires
    ) as bar:
        shards.make_shards(config, run.dataset_folder, missing, executor, bar.update)


def accuracy_warning(now: shards.Status) -> str:
    """Return a line about a dataset whose conductances may be less exact than measured ones."""
    if now.largest_error is None or now.largest_error <= NOISE_FLOOR:
        return ""
    return (
        f"The solver estimates errors of up to {now.largest_error:.2g} e²/h in this dataset, more "
        f"than the {NOISE_FLOOR:g} of a measurement: the variable error says at which µ and B."
    )


def train(run: Run) -> None:
    """Train the run's network, or go on with it; generate must have been called."""
    if _holds_this_training(run):  # before the dataset is read and TensorFlow imported
        print(f"'{run.model_folder}' holds this very training, finished: nothing to do.")
        return
    from disorder_landscape.learning.training import train_from_shards

    train_from_shards(run.config, run.dataset_folder, run.model_folder, "landscape train")


def evaluate(run: Run) -> xr.Dataset:
    """Predict the run's test realizations, write evaluation.nc and return it.

    Returns
    -------
    xarray.Dataset
        components, alpha, potential and components_predicted, alpha_predicted, potential_predicted,
        with a dim realization; the scores R2, delta_V, delta_alpha, R2_<label> as attributes.

    Raises
    ------
    ArgumentError
        If the folder holds no finished training of this configuration.
    """
    from disorder_landscape.learning.metrics import score
    from disorder_landscape.learning.model import load_model
    from disorder_landscape.learning.prediction import predict
    from disorder_landscape.learning.scaling import label_array

    if not run.shipped and run.is_trained:
        but = f"'{run.model_folder}' holds one of another (remove it to train anew)"
        require(_holds_this_training(run), "config", "be that of the network", but)
    test = read_test_set(run)
    model = load_model(run.model_folder)
    predicted = predict(model, test)
    labels = model.labels
    true, guess = (label_array(one, labels.names) for one in (test, predicted))
    scores = score(true, guess, labels, run.config.dataset.sites)
    evaluation = xr.merge(
        [test[list(DRAWN)], predicted[list(DRAWN)].rename({n: f"{n}_predicted" for n in DRAWN})],
        combine_attrs="drop",
    )
    evaluation = with_units(evaluation)
    attrs = {
        **provenance(f"landscape evaluate ({run.name})"),
        "fingerprint": _fingerprint(run),
        "R2": scores.r2,
        "delta_V": scores.delta_V,
        **{
            f"delta_{name}": value
            for name, value in (("alpha", scores.delta_alpha), ("mean", scores.delta_mean))
            if value is not None
        },
        **{f"R2_{label}": r2 for label, r2 in scores.r2_by_label.items()},
    }
    write_dataset(evaluation, run.evaluation_file, attrs)
    return evaluation.assign_attrs(attrs)


def evaluation(run: Run, workers: int = 2) -> xr.Dataset:
    """Return what `evaluate` gives for a run, after whatever is missing of its chain."""
    if not run.shipped and not run.is_trained:
        generate(run, LocalProcesses(workers))
        train(run)
    if run.evaluation_file.exists():
        stored = read_dataset(run.evaluation_file, ("components_predicted",))
        if stored.attrs.get("fingerprint") == _fingerprint(run):
            return stored
    return evaluate(run)


def read_test_set(run: Run) -> xr.Dataset:
    """Return the run's test realizations with their conductances."""
    if run.shipped:
        return read_dataset(shipped_test_set(run.name), shards.VARIABLES)
    from disorder_landscape.learning.examples import split

    _, test = split(run.config.dataset.realizations, run.config.training.test_fraction)
    return shards.read_shards(run.config.dataset, run.dataset_folder, test.start)


def _holds_this_training(run: Run) -> bool:
    from disorder_landscape.learning.model import load_model_config

    if not run.is_trained:
        return False
    there = load_model_config(run.model_folder)
    ours = run.config
    return (there.dataset.hash, there.dataset.realizations, there.network, there.training) == (
        ours.dataset.hash,
        ours.dataset.realizations,
        ours.network,
        ours.training,
    )


def _fingerprint(run: Run) -> str:
    """Return a hash that changes with the configuration, the network or the test set."""
    try:
        network, scaler = ((run.model_folder / name).read_bytes() for name in (NETWORK, SCALER))
    except OSError as error:
        must = "be a folder written by `landscape train`"
        but = f"'{run.model_folder}' has no complete network ({error.strerror})"
        raise ArgumentError("model", must, but) from None
    digest = hashlib.sha256(network + scaler)
    for section in (run.config.dataset, run.config.network, run.config.training):
        digest.update(section.model_dump_json().encode())
    if run.shipped:
        digest.update(shipped_test_set(run.name).read_bytes())
    return digest.hexdigest()
