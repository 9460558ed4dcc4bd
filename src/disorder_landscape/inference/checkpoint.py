"""What an interrupted inversion has already found, in a JSON file beside its result."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from disorder_landscape.files import read_json, write_json

_MUST = "be the file of an interrupted inversion (delete it to start anew)"


class Checkpoint:
    """Results by name, which an interrupted run does not calculate again.

    Parameters
    ----------
    path : Path, optional
        The file; None keeps nothing. What other runs have left there stays.
    fingerprint : bytes
        Everything that the results depend on.
    """

    def __init__(self, path: Path | None = None, fingerprint: bytes = b"") -> None:
        self.path = path
        self._runs: dict[str, dict[str, Any]] = {}
        if path is not None and path.exists():
            self._runs = read_json(path, "checkpoint", _MUST)
        self._known = self._runs.setdefault(hashlib.sha256(fingerprint).hexdigest(), {})

    def __len__(self) -> int:
        """How many results of this run there are."""
        return len(self._known)

    def recall(self, name: str, calculate: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """Return the result of this name, after calculating and noting it if it is new."""
        if name not in self._known:
            self._known[name] = calculate()
            if self.path is not None:
                write_json(self.path, self._runs)
        return dict(self._known[name])
