"""NetCDF in and out, with provenance and with checks."""

from __future__ import annotations

import io
import warnings
from collections.abc import Collection, Hashable, Iterable, Mapping
from importlib.metadata import version
from pathlib import Path

import h5py
import numpy as np
import xarray as xr

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.dataset.hdf5 import open_hdf5
from disorder_landscape.files import replacing

PACKAGES = ("disorder-landscape", "numpy", "scipy", "xarray", "h5netcdf")


def provenance(command: str) -> dict[str, str]:
    """Return the attributes that tell how a file was made: the command and package versions."""
    return {"command": command, **{f"version_{name}": version(name) for name in PACKAGES}}


def write_dataset(
    dataset: xr.Dataset,
    path: Path,
    attrs: Mapping[str, object],
    may_lack: Collection[Hashable] = (),
) -> None:
    """Write a netCDF4 file with these further attributes; it appears whole or not at all.

    Parameters
    ----------
    dataset : Dataset
    path : Path
    attrs : mapping
    may_lack : collection
        Names of variables that may hold NaN.

    Raises
    ------
    ArgumentError
        If a number in it is not finite, the folder cannot be written, or the disk is full.
    """
    for name, variable in dataset.variables.items():
        if np.issubdtype(variable.dtype, np.floating) and name not in may_lack:
            bad = int((~np.isfinite(variable.to_numpy())).sum())
            require(bad == 0, "dataset", "be finite", f"{name} has {bad} numbers that are not")
    with replacing(path) as temporary:
        # In memory first: HDF5 itself crashes where the disk is full.
        content = io.BytesIO(_empty_without_times())
        dataset.assign_attrs(attrs).to_netcdf(
            content, mode="a", engine="h5netcdf", encoding=_with_checksums(dataset)
        )
        temporary.write_bytes(content.getvalue())


def _with_checksums(dataset: xr.Dataset) -> dict[Hashable, dict[str, object]]:
    """Return the encoding by which damaged numbers are an error when they are read."""
    return {
        name: {"fletcher32": True, "chunksizes": variable.shape}
        for name, variable in dataset.variables.items()
        if variable.size and variable.ndim and np.issubdtype(variable.dtype, np.number)
    }


def _empty_without_times() -> bytes:
    """Return an empty netCDF4 file without HDF5's times, so that equal content is equal bytes."""
    creation = h5py.h5p.create(h5py.h5p.FILE_CREATE)
    creation.set_obj_track_times(False)
    in_order = h5py.h5p.CRT_ORDER_TRACKED | h5py.h5p.CRT_ORDER_INDEXED
    creation.set_link_creation_order(in_order)
    creation.set_attr_creation_order(in_order)
    in_memory = h5py.h5p.create(h5py.h5p.FILE_ACCESS)
    in_memory.set_fapl_core(backing_store=False)
    file = h5py.h5f.create(b"empty.nc", h5py.h5f.ACC_TRUNC, fcpl=creation, fapl=in_memory)
    try:
        h5py.h5f.flush(file)
        image: bytes = file.get_file_image()
        return image
    finally:
        file.close()


def read_dataset(path: str | Path, variables: Iterable[str] = ()) -> xr.Dataset:
    """Read a whole netCDF file into memory.

    Raises
    ------
    ArgumentError
        If it is missing, truncated, not netCDF, or lacks one of the variables or its numbers.
    """
    must = "be a netCDF file (version 4)"
    try:
        with open_hdf5(path) as raw:
            dict(raw.attrs)  # h5netcdf fails badly where these are damaged
            stored = {name for name, of in raw.items() if _is_stored(of)}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of what is odd; what is missing is told below
            with xr.open_dataset(path, engine="h5netcdf", decode_times=False) as file:
                dataset = file.load()
    except FileNotFoundError:
        raise ArgumentError("file", must, f"there is no '{path}'") from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RuntimeError) as error:
        raise ArgumentError("file", must, f"'{path}' {_unreadable(path, error)}") from None
    lost = [name for name, of in dataset.variables.items() if of.size and name not in stored]
    require(not lost, "file", must, f"'{path}' has lost what {', '.join(map(str, lost))} held")
    missing = [name for name in variables if name not in dataset.variables]
    require(not missing, "file", must, f"'{path}' lacks {', '.join(missing)}")
    return dataset


def _unreadable(path: str | Path, error: Exception) -> str:
    """Return as words why a file cannot be read."""
    if Path(path).is_dir():
        return "is a folder"
    if Path(path).is_file() and not h5py.is_hdf5(path):
        return "is of another format, or damaged"
    reason = str(error).splitlines()[0] if str(error) else type(error).__name__
    return f"cannot be read: {reason}"


def _is_stored(member: h5py.Dataset | h5py.Group | h5py.Datatype) -> bool:
    """Return whether numbers are there: HDF5 fills up with NaN where it finds none.

    None are at the file's very beginning, where a damaged index says that they are.
    """
    if not isinstance(member, h5py.Dataset) or member.id.get_storage_size() == 0:
        return False
    pieces: list[h5py.h5d.StoreInfo] = []
    if member.chunks is not None:
        member.id.chunk_iter(pieces.append)
    return all(piece.byte_offset > 0 for piece in pieces)
