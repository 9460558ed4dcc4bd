"""Opening HDF5 files that may be damaged.

HDF5 1.14 never returns from a damaged global heap, where texts and dimension scales are: it walks
from object to object by their sizes, and stays where a free one says that it has none.
"""

from __future__ import annotations

import struct
from pathlib import Path

import h5py

HEAPS_END = 2**20
"""Heaps are looked for in so many bytes. They come first: of the files of this project and of
xarray all begin within 30 kB."""
SIGNATURE = b"GCOL"
COLLECTION = struct.Struct("<4xB3xQ")
"""Of a heap: signature, version, its size."""
OBJECT = struct.Struct("<HHxxxxQ")
"""Of an object in it: index (0 if it is free), references, size."""


def open_hdf5(path: str | Path) -> h5py.File:
    """Open an HDF5 file to read.

    Raises
    ------
    OSError
        If it is missing, no HDF5 file, or HDF5 would not return from one of its heaps.
    """
    with Path(path).open("rb") as file:
        beginning = file.read(HEAPS_END)
    at = beginning.find(SIGNATURE)
    while at >= 0:
        if not _ends(beginning, at):
            raise OSError("its global heap is damaged")
        at = beginning.find(SIGNATURE, at + 1)
    return h5py.File(path)


def _ends(content: bytes, start: int) -> bool:
    """Return whether a walk through a heap comes to its end, or leaves what is there."""
    if start + COLLECTION.size > len(content):
        return True
    _, size = COLLECTION.unpack_from(content, start)
    at, end = start + COLLECTION.size, min(start + size, len(content))
    while at + OBJECT.size <= end:
        index, _, length = OBJECT.unpack_from(content, at)
        step = length if index == 0 else OBJECT.size + (length + 7) // 8 * 8
        if step == 0:
            return False
        at += step
    return True
