"""A name for what these very solvers make, so that no results of others are read."""

from __future__ import annotations

import hashlib

from disorder_landscape.runs import REPOSITORY

PACKAGE = REPOSITORY / "src" / "disorder_landscape"


def fingerprint(*modules: str, settings: str) -> str:
    """Return a hash of the solvers' code, of some modules of studies, and of settings."""
    paths = [path for room in ("model", "solver") for path in PACKAGE.glob(f"{room}/*.py")]
    paths += (REPOSITORY / "core").glob("**/*.hpp")
    paths += [PACKAGE / "studies" / f"{name}.py" for name in modules]
    content = [path.read_bytes() for path in sorted(paths)]
    return hashlib.sha256(b"\n".join([*content, settings.encode()])).hexdigest()[:12]
