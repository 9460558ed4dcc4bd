"""Files and folders that are either whole or not there, and JSON files."""

from __future__ import annotations

import glob
import hashlib
import json
import os
import shutil
import socket
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from disorder_landscape.arguments import ArgumentError, require, shown

CHECKSUM = "checksum"
"""Key of a JSON file, about all others."""
_HOST = socket.gethostname().replace("-", "_")  # a hyphen ends it in names of temporary files


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary path beside `path` to write to, and rename it to `path` in the end.

    What is written may be a file or a folder.

    Raises
    ------
    ArgumentError
        If the folder cannot be written, or the disk is full; nothing is left behind then.
    """
    temporary = path.with_name(_temporary_name(path))
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _remove_left_behind(path)
        yield temporary
        temporary.replace(path)
    except (OSError, RuntimeError) as error:  # HDF5 says RuntimeError when a disk is full
        reason = getattr(error, "strerror", None) or str(error).splitlines()[0]
        raise unwritable(path, reason) from None
    finally:
        with suppress(OSError):
            _remove(temporary)


def _temporary_name(path: Path) -> str:
    """Return a name of this process' own, whoever else writes the same."""
    return f".writing-{_HOST}-{os.getpid()}-{path.name}"  # Keras looks at the suffix


def unwritable(path: Path, reason: str | None) -> ArgumentError:
    """Return the error of a file or folder that cannot be written."""
    but = f"'{path}' cannot be written ({reason})"
    return ArgumentError("folder", "be a place to write to", but)


def _remove_left_behind(path: Path) -> None:
    """Remove what processes of this machine that were killed have left beside a path."""
    prefix = f".writing-{_HOST}-"
    for there in path.parent.glob(f"{glob.escape(prefix)}*-{glob.escape(path.name)}"):
        process = there.name.removeprefix(prefix).split("-")[0]
        if process.isdecimal() and not _is_running(int(process)):
            _remove(there)


def _is_running(process: int) -> bool:
    if process == os.getpid():
        return False  # it writes nothing yet: another one had the same number
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:  # another user's
        return True
    return True


def check_writable(name: str, path: Path) -> None:
    """Raise an ArgumentError where a file could not be written; nothing is touched.

    For results that take long: `replacing` would notice, but only at the end.
    """
    must = "be a file in a folder that can be written"
    try:
        folder = next((one for one in path.absolute().parents if one.exists()), path)
        with suppress(FileNotFoundError, NotADirectoryError):
            os.lstat(folder / _temporary_name(path))
        usable = folder.is_dir() and os.access(folder, os.W_OK) and not path.is_dir()
    except OSError as error:  # of a name that is too long
        raise ArgumentError(name, must, f"it is {shown(str(path))} ({error.strerror})") from None
    require(usable, name, must, f"it is '{path}'")


def check_netcdf(name: str, path: Path) -> None:
    """Raise an ArgumentError where a netCDF file could not be written, or has another's name."""
    check_writable(name, path)
    require(path.suffix == ".nc", name, "be a netCDF file, named ….nc", f"it is '{path}'")


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write a JSON file with a checksum; floats are written so that reading gives the same bits."""
    whole = {**content, CHECKSUM: _checksum(content)}
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(whole, indent=1, ensure_ascii=False) + "\n", "utf-8")


def read_json(path: Path, name: str, must: str) -> dict[str, Any]:
    """Read a JSON file that holds an object; return it without its checksum.

    Raises
    ------
    ArgumentError
        If it cannot be read, holds something else or was changed: `name` must `must`.
    """
    try:
        content = json.loads(path.read_text("utf-8"))
    except OSError as error:
        but = f"'{path}' cannot be read ({error.strerror})"
        raise ArgumentError(name, must, but) from None
    except ValueError as error:
        raise ArgumentError(name, must, f"'{path}' is not JSON: {error}") from None
    require(isinstance(content, dict), name, must, f"'{path}' holds no JSON object")
    stated = content.pop(CHECKSUM, None)
    same = stated in (None, _checksum(content))  # none in files of older versions
    require(same, name, must, f"'{path}' was changed after it was written, or is damaged")
    return dict(content)


def _checksum(content: Mapping[str, Any]) -> str:
    """Return the SHA-256 of what a JSON file says, whatever its spaces and its order."""
    as_read = json.loads(json.dumps(content))
    return hashlib.sha256(json.dumps(as_read, sort_keys=True).encode()).hexdigest()
