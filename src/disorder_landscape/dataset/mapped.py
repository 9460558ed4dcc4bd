"""The conductances of a dataset that need not fit into memory: read from its shards when asked for.

A shard holds each conductance in one piece, so that the operating system can show it as memory
(mmap), and keep of it what is used and fits.
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset.hdf5 import open_hdf5
from disorder_landscape.dataset.shards import (
    require_complete,
    shard_count,
    shard_indices,
    shard_path,
)
from disorder_landscape.model.quantities import CONDUCTANCES


class MappedConductances:
    """Conductances in e²/h of all wires of a dataset, shape (realization, mu, B, bias, channel).

    Parameters
    ----------
    config : DatasetConfig
    folder : Path
        Of the shards.

    Raises
    ------
    ArgumentError
        If a shard is missing, damaged or of another configuration. Each is read once to see that.
    """

    def __init__(self, config: DatasetConfig, folder: Path) -> None:
        require_complete(config, folder)
        self._shard_size = config.shard_size
        self._shards = [
            _mapped(shard_path(folder, k), len(shard_indices(config, k)))
            for k in range(shard_count(config))
        ]
        one_wire = self._shards[0][0].shape[1:]
        self.shape: tuple[int, ...] = (config.realizations, *one_wire, len(CONDUCTANCES))

    def __len__(self) -> int:
        """Return how many realizations there are."""
        return self.shape[0]

    def __getitem__(self, which: slice | NDArray[np.intp]) -> NDArray[np.float32]:
        """Read the conductances of some realizations into memory."""
        indices = np.arange(len(self))[which]
        X = np.empty((len(indices), *self.shape[1:]), dtype=np.float32)
        shards = indices // self._shard_size
        for k in np.unique(shards):
            here = np.flatnonzero(shards == k)
            inside = indices[here] - k * self._shard_size
            for channel, G in enumerate(self._shards[k]):
                X[here, ..., channel] = G[inside]
        return X


def _mapped(path: Path, realizations: int) -> list[NDArray[np.float32]]:
    """Return each conductance of a shard, mapped, after looking at all of it once."""
    must = "hold only whole shards"
    try:
        with open_hdf5(path) as file:
            variables = [file[name] for name in CONDUCTANCES]
            finite = all(np.isfinite(variable[:]).all() for variable in variables)
            places = [(_offset(variable), variable.dtype, variable.shape) for variable in variables]
        whole = np.memmap(path, mode="r")
    except (OSError, KeyError, RuntimeError, ValueError):
        raise ArgumentError("dataset", must, f"'{path}' is damaged; delete it") from None
    require(finite, "dataset", must, f"'{path}' holds numbers that are not finite")
    return [
        np.ndarray(shape, dtype, whole, offset)[:realizations] for offset, dtype, shape in places
    ]


def _offset(variable: h5py.Dataset) -> int:
    """Return where in its file a variable begins that is there in one piece, not compressed.

    Raises
    ------
    ValueError
        If it is not.
    """
    offset = variable.id.get_offset()  # none if it is in chunks: one, with a checksum
    if offset is None and variable.id.get_num_chunks() == 1 and variable.compression is None:
        offset = variable.id.get_chunk_info(0).byte_offset
    if offset is None:
        raise ValueError(f"{variable.name} is in pieces")
    return int(offset)
