"""What an interrupted inversion has already found, in a JSON file beside its result."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from disorder_landscape.files import read_json, write_json
from disorder_landscape.inference.problem.gaussian import Gaussian

Cache = Callable[[str, Callable[[], dict[str, Any]]], dict[str, Any]]
"""`Checkpoint.cached`: returns the result of a name, from the file or calculated now."""

_MUST = "be the file of an interrupted inversion (delete it to start anew)"


def uncached(name: str, calculate: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """Calculate the result: the `Cache` that keeps nothing."""
    return calculate()


def cached_gaussian(cache: Cache, name: str, make: Callable[[], Gaussian]) -> Gaussian:
    """Return the normal distribution of a name, from the file or made now."""
    return Gaussian.from_dict(cache(name, lambda: make().to_dict()))


class Checkpoint:
    """Results by name, which an interrupted run does not calculate again.

    Parameters
    ----------
    path : Path, optional
        The file; None keeps nothing. Results of runs with another fingerprint are ignored, and stay
        in the file.
    fingerprint : bytes
        Everything that the results depend on.
    """

    def __init__(self, path: str | Path | None = None, fingerprint: bytes = b"") -> None:
        self.path = None if path is None else Path(path)
        self._runs: dict[str, dict[str, Any]] = {}
        if self.path is not None and os.path.exists(self.path):
            self._runs = read_json(self.path, "checkpoint", _MUST)
        self._known = self._runs.setdefault(hashlib.sha256(fingerprint).hexdigest(), {})

    def __len__(self) -> int:
        """How many results of this run there are."""
        return len(self._known)

    def cached(self, name: str, calculate: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """Return the result of this name; if it is new, calculate and store it."""
        if name not in self._known:
            self._known[name] = calculate()
            if self.path is not None:
                write_json(self.path, self._runs)
        return dict(self._known[name])
