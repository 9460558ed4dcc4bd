"""A dataset as a folder of shards: generate, resume, status, read.

Shard k holds the realizations k·shard_size … of the dataset. It is written whole or not at all, and
is a function of the configuration alone, so workers, order and restarts leave no trace in it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset.hdf5 import ATTRIBUTES, open_hdf5
from disorder_landscape.dataset.store import provenance, read_dataset, write_dataset
from disorder_landscape.executors.executor import WHOLE, Executor, Share
from disorder_landscape.executors.local import IN_THIS_PROCESS
from disorder_landscape.model.quantities import AXES, CONDUCTANCES, DRAWN

VARIABLES = (*CONDUCTANCES, *DRAWN)
"""What is read back; `error` and `energies` of the solver are in most shards, for whoever asks."""
LARGEST_ERROR = "largest_error"
"""Attribute of a shard: the largest of the solver's error estimates in e²/h."""
Progress = Callable[[int], None]


@dataclass(frozen=True)
class Status:
    """How much of a dataset is there: shards, realizations, bytes; and how exact it is."""

    shards: int
    shards_in_all: int
    realizations: int
    realizations_in_all: int
    bytes: int
    largest_error: float | None
    """Of the solver's estimates in e²/h; none if no shard has any."""

    @property
    def complete(self) -> bool:
        """Whether nothing is missing."""
        return self.shards == self.shards_in_all


def shard_path(folder: Path, shard: int) -> Path:
    """Return the file of a shard."""
    return folder / f"shard-{shard:05d}.nc"


def shard_indices(config: DatasetConfig, shard: int) -> range:
    """Return the indices of the realizations in a shard."""
    first = shard * config.shard_size
    return range(first, min(first + config.shard_size, config.realizations))


def shard_count(config: DatasetConfig) -> int:
    """Return the number of shards."""
    return -(-config.realizations // config.shard_size)


def make_shard(config: DatasetConfig, folder: Path, shard: int) -> int:
    """Simulate and write one shard; return how many realizations it holds."""
    from disorder_landscape.dataset.realizations import simulate

    indices = shard_indices(config, shard)
    attrs = {
        **provenance("landscape generate"),
        "config_hash": config.hash,
        "config": config.model_dump_json(exclude={"realizations"}),
        "seed": config.seed,
        "first_index": indices.start,
        "last_index": indices.stop - 1,
    }
    made = simulate(config, indices)
    if "error" in made:
        attrs[LARGEST_ERROR] = float(made["error"].max())
    write_dataset(made, shard_path(folder, shard), attrs)
    return len(indices)


def shard_is_done(config: DatasetConfig, folder: Path, shard: int) -> bool:
    """Return whether a shard is there with at least the realizations that it needs.

    Raises
    ------
    ArgumentError
        If the file is damaged, or of another configuration: it is refused, never overwritten.
    """
    return _inspect(config, folder, shard)[0]


def status(config: DatasetConfig, folder: Path) -> Status:
    """Return how much of the dataset is there."""
    found = {k: _inspect(config, folder, k) for k in range(shard_count(config))}
    shards = {k: error for k, (is_done, error) in found.items() if is_done}
    return Status(
        shards=len(shards),
        shards_in_all=shard_count(config),
        realizations=sum(len(shard_indices(config, k)) for k in shards),
        realizations_in_all=config.realizations,
        bytes=sum(shard_path(folder, k).stat().st_size for k in shards),
        largest_error=max((error for error in shards.values() if error is not None), default=None),
    )


def _inspect(config: DatasetConfig, folder: Path, shard: int) -> tuple[bool, float | None]:
    """Return whether a shard is done, and the largest error that it states."""
    path = shard_path(folder, shard)
    if not path.exists():
        return False, None
    try:
        with open_hdf5(path, ATTRIBUTES) as file:
            made_with, held = file.attrs.get("config_hash"), len(file["realization"])
            error, first = file.attrs.get(LARGEST_ERROR), file.attrs.get("first_index")
    except (OSError, KeyError, RuntimeError, ValueError):
        must = "hold only whole shards"
        raise ArgumentError("dataset", must, f"'{path}' is damaged; delete it") from None
    must = "be a folder of this configuration's shards"
    require(
        made_with == config.hash, "dataset", must, f"'{path}' was made with another configuration"
    )
    begins = np.array_equal(np.ravel(first), [shard_indices(config, shard).start])
    require(begins, "dataset", must, f"'{path}' holds the realizations of another shard")
    return held >= len(shard_indices(config, shard)), None if error is None else float(error[0])


def missing_shards(config: DatasetConfig, folder: Path, share: Share = WHOLE) -> list[int]:
    """Return the shards of a share that are not there, or lack realizations.

    Raises
    ------
    ArgumentError
        If the folder holds a damaged shard, or one of another configuration.
    """
    shards = share.of(range(shard_count(config)))
    return [k for k in shards if not shard_is_done(config, folder, k)]


def generate(
    config: DatasetConfig,
    folder: Path,
    executor: Executor = IN_THIS_PROCESS,
    progress: Progress = lambda done: None,
    share: Share = WHOLE,
) -> None:
    """Make the shards that are missing.

    Parameters
    ----------
    config : DatasetConfig
    folder : Path
        Where the shards are.
    executor : Executor
    progress : callable
        Called with the number of realizations of every shard that is made.
    share : Share
        Which of the shards are looked at.

    Raises
    ------
    ArgumentError
        If the folder holds shards of another configuration or cannot be written; every shard made
        until then stays.
    """
    make_shards(config, folder, missing_shards(config, folder, share), executor, progress)


def make_shards(
    config: DatasetConfig,
    folder: Path,
    missing: Iterable[int],
    executor: Executor,
    progress: Progress,
) -> None:
    """Make these shards, and call `progress` as `generate` does."""
    for realizations in executor.each_result(partial(make_shard, config, folder), missing):
        progress(realizations)


def require_complete(config: DatasetConfig, folder: Path) -> None:
    """Raise an ArgumentError if a shard is missing, damaged or of another configuration."""
    now = status(config, folder)
    must = f"hold {now.realizations_in_all} realizations (run `landscape generate`)"
    require(now.complete, "dataset", must, f"'{folder}' holds {now.realizations}")


def read_shards(config: DatasetConfig, folder: Path, first: int = 0) -> xr.Dataset:
    """Read the dataset, from realization `first` on, into memory.

    Raises
    ------
    ArgumentError
        If a shard is missing, damaged or of another configuration.
    """
    require_complete(config, folder)
    first_shard = first // config.shard_size
    parts = [
        _read_shard(config, folder, k, VARIABLES) for k in range(first_shard, shard_count(config))
    ]
    return _joined(parts).isel(realization=slice(first - first_shard * config.shard_size, None))


def read_disorder(config: DatasetConfig, folder: Path) -> xr.Dataset:
    """Read components, alpha and the potential's mean of a whole dataset, and its grid.

    Of a million wires that is 100 MB.

    Raises
    ------
    ArgumentError
        As `read_shards`.
    """
    require_complete(config, folder)
    parts = []
    for k in range(shard_count(config)):
        part = _read_shard(config, folder, k, DRAWN)
        parts.append(part.assign(mean=part["potential"].mean("site")).drop_vars("potential"))
    return _joined(parts)


def _read_shard(
    config: DatasetConfig, folder: Path, shard: int, variables: Collection[str]
) -> xr.Dataset:
    """Read some variables, and the grid, of the realizations that a dataset has in a shard."""
    wanted = [*variables, *AXES]
    whole = read_dataset(shard_path(folder, shard), wanted)[wanted]
    return whole.isel(realization=slice(len(shard_indices(config, shard))))


def _joined(parts: Iterable[xr.Dataset]) -> xr.Dataset:
    return xr.concat(parts, "realization", data_vars="minimal", combine_attrs="drop_conflicts")
