"""What the inference of a file is told besides it, and what a result says that it answers."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.dataset.hdf5 import open_hdf5
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.learning.model_files import CONFIG, NETWORK, SCALER

ASKED = "asked"
"""Attribute of a result: the measurement, the model and the options that it answers."""


@dataclass(frozen=True)
class Settings:
    """What `infer` is told about a measurement besides its file.

    Parameters
    ----------
    prior : Path or None
        TOML file of what is known; without it the model's dataset says so.
    model : Path or None
        Folder of the model whose network guesses.
    noise : float or dict, optional
    from_prior : bool
    samples : int
    seed : int
    discrepancy : bool
        As in `infer`.
    made : mapping
        Provenance of the results.
    """

    prior: Path | None
    model: Path | None
    noise: float | dict[str, float] | None
    from_prior: bool
    samples: int
    seed: int
    discrepancy: bool
    made: Mapping[str, str]

    def prior_and_network(self) -> tuple[Prior | Path, Path | bool]:
        """Return the two arguments of `infer`.

        Raises
        ------
        ArgumentError
            If neither a prior nor a model is given, or the prior cannot be read.
        """
        network = False if self.from_prior or self.model is None else self.model
        if self.prior is not None:
            return Prior.from_toml(self.prior), network
        if self.model is not None:
            return self.model, network
        must = "be given, or a model whose dataset says what is known"
        raise ArgumentError("prior", must, "there is neither")

    def hashes(self) -> dict[str, str]:
        """Return those of the prior and of the model; one without a network serves as prior."""
        given = {}
        if self.prior is not None:
            given["prior"] = _hash([self.prior])
        if self.model is not None:
            paths = [self.model / name for name in (CONFIG, SCALER, NETWORK)]
            given["model"] = _hash([path for path in paths if path.exists()])
        return given


def asked_for(measurement: Path, settings: Settings, hashes: Mapping[str, str]) -> str:
    """Return what a result depends on, as JSON text; the hashes are those of the settings."""
    asked = {
        "measurement": _hash([measurement]),
        **hashes,
        "noise": settings.noise,
        "from_prior": settings.from_prior,
        "samples": settings.samples,
        "seed": settings.seed,
        **({"discrepancy": True} if settings.discrepancy else {}),
    }
    return json.dumps(asked, sort_keys=True)


def asked_of(output: Path) -> str:
    """Return what a result says that it answers; nothing if it is no result."""
    try:
        with open_hdf5(output) as file:
            asked = file.attrs.get(ASKED, "")
    except OSError:
        return ""
    return asked if isinstance(asked, str) else ""


def _hash(paths: Sequence[Path]) -> str:
    content = hashlib.sha256()
    for path in paths:
        try:
            content.update(path.read_bytes())
        except OSError as error:
            but = f"'{path}' cannot be read ({error.strerror})"
            raise ArgumentError("file", "be readable", but) from None
    return content.hexdigest()
