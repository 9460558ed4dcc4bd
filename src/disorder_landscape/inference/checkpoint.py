"""What an interrupted inversion has already found, in a JSON file beside its result."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from disorder_landscape.files import read_json, write_json

_MUST = "be the file of an interrupted inversion (delete it to start anew)"


class Checkpoint:
    """Results by name, each of which is calculated once, however often the run is interrupted.

    Parameters
    ----------
    path : Path, optional
        The file; None keeps nothing. What another run has left there is ignored.
    fingerprint : bytes
        Everything that the results depend on.
    """

    def __init__(self, path: Path | None = None, fingerprint: bytes = b"") -> None:
        self.path = path
        self._run = hashlib.sha256(fingerprint).hexdigest()
        self._known: dict[str, Any] = {}
        if path is not None and path.exists():
            content = read_json(path, "checkpoint", _MUST)
            if content.get("run") == self._run:
                self._known = dict(content["results"])

    def __len__(self) -> int:
        """How many results there are."""
        return len(self._known)

    def recall(self, name: str, calculate: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """Return the result of this name, after calculating and noting it if it is new."""
        if name not in self._known:
            self._known[name] = calculate()
            if self.path is not None:
                write_json(self.path, {"run": self._run, "results": self._known})
        return dict(self._known[name])

    def remove(self) -> None:
        """Delete the file, when the result is safe."""
        if self.path is not None:
            self.path.unlink(missing_ok=True)
