"""The parts that an installation can lack, the extras of pyproject.toml, and what is said then."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

PARTS = {
    "kwant": {"kwant": "Kwant"},
    "figures": {"matplotlib": "Matplotlib"},
    "inference": {"sklearn": "scikit-learn"},
    "learning": {
        "keras": "Keras",
        "matplotlib": "Matplotlib",
        "sklearn": "scikit-learn",
        "tensorflow": "TensorFlow",
    },
    "cluster": {"distributed": "Dask"},
    "dev": {
        "arviz": "ArviZ",
        "flint": "python-flint",
        "iterative_ensemble_smoother": "iterative-ensemble-smoother",
    },
}
"""For each extra the packages that it brings: the module that is imported, and its name.

Of "dev" those that studies need.
"""


class MissingPartError(ImportError):
    """A part of the installation that is not there; the message is one sentence, how to get it."""


@contextmanager
def needs(part: str) -> Iterator[None]:
    """Name the extra where a package is not installed; for a block, or to decorate a function.

    Parameters
    ----------
    part : str
        One of PARTS. It is named for the packages that it brings; for others the first that does.

    Raises
    ------
    MissingPartError
        If a package that one of PARTS brings cannot be found.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        for extra in (part, *PARTS):
            if package in PARTS[extra]:
                name = PARTS[extra][package]
                raise MissingPartError(
                    f"{name} is missing: pip install 'disorder-landscape[{extra}]'", name=package
                ) from None
        raise
