"""Folders and files that one process at a time works on."""

from __future__ import annotations

import fcntl
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from disorder_landscape.files import unwritable


@contextmanager
def kept_from_others(folder: Path, name: str = "", shared: bool = False) -> Iterator[None]:
    """Keep other processes from working on the same; wait as long as one works on it.

    A lock of the operating system, which ends with its process. Where a file system has none, all
    go on without.

    Parameters
    ----------
    folder : Path
        It is made if it is not there.
    name : str
        Of what in the folder is worked on; by default it is all.
    shared : bool
        Of a whole folder: work beside others that share it, and keep from those that do not.

    Raises
    ------
    ArgumentError
        If the folder cannot be written.
    """
    path = folder / f".{name}.lock" if name else folder
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle = _locked(path, fcntl.LOCK_SH if shared else fcntl.LOCK_EX)
    except OSError as error:
        raise unwritable(folder, error.strerror) from None
    try:
        yield
    finally:
        if name:
            path.unlink(missing_ok=True)
        os.close(handle)


def _locked(path: Path, kind: int) -> int:
    """Return an open and locked file."""
    while True:
        handle = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR | os.O_CREAT)
        try:
            fcntl.flock(handle, kind | fcntl.LOCK_NB)
        except BlockingIOError:
            print(f"waiting for another process that works on '{path}'", file=sys.stderr)
            fcntl.flock(handle, kind)
        except OSError:  # no locks on this file system
            return handle
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(handle), path.stat()):
                return handle
        os.close(handle)  # whoever held it has removed the file
