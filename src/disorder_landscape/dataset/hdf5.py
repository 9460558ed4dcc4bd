"""Opening HDF5 files that may be damaged.

HDF5 1.14 never returns from a damaged global heap, where texts and dimension scales are: it walks
from object to object by their sizes, and stays where a free one says that it has none, or where a
size is so large that the sum begins anew.
"""

from __future__ import annotations

import mmap
import struct
from pathlib import Path

import h5py

SIGNATURE = b"GCOL\x01\0\0\0"
"""Of a heap: its name, version 1, nothing. Its size follows, which includes all of this."""
SIZE = struct.Struct("<Q")
OBJECT = struct.Struct("<HHxxxxQ")
"""Of an object in it: index (0 if it is free), references, size."""
ATTRIBUTES = 2**20
"""In so many bytes are the heaps of a shard that hold texts; later ones hold dimension scales."""


def open_hdf5(path: str | Path, looked_at: int | None = None) -> h5py.File:
    """Open an HDF5 file to read.

    Parameters
    ----------
    path : str or Path
    looked_at : int, optional
        How many of its bytes are searched for damaged heaps; by default all.

    Raises
    ------
    OSError
        If it is missing, no HDF5 file, or HDF5 would not return from one of its heaps.
    """
    if Path(path).stat().st_size > 0:
        with (
            Path(path).open("rb") as file,
            mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content,
        ):
            end, at = looked_at or len(content), -1
            while (at := content.find(SIGNATURE, at + 1, end)) >= 0:
                if not _ends(content, at):
                    raise OSError("its global heap is damaged")
    return h5py.File(path)


def _ends(content: mmap.mmap, start: int) -> bool:
    """Return whether a walk through a heap comes to its end; what is no whole heap is none."""
    at = start + len(SIGNATURE) + SIZE.size
    if at > len(content):
        return True
    (size,) = SIZE.unpack_from(content, start + len(SIGNATURE))
    end = start + size
    if end > len(content):
        return True
    while at + OBJECT.size <= end:
        index, _, length = OBJECT.unpack_from(content, at)
        step = length if index == 0 else OBJECT.size + (length + 7) // 8 * 8
        if step == 0 or at + step > end:
            return False
        at += step
    return True
