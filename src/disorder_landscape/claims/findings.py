"""What came out: for each claim our values, each with its verdict, and the claim's verdict."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from disorder_landscape.claims.claim import (
    Claim,
    Measured,
    ResultMissingError,
    Stored,
    Verdict,
)
from disorder_landscape.claims.sources import provenance, stored_value
from disorder_landscape.runs import REPOSITORY


@dataclass(frozen=True)
class Outcome:
    """One value of ours, or the reason why there is none."""

    source: Stored | Measured
    value: float | None
    verdict: Verdict
    interval: tuple[float, float] | None = None
    """Of the value, over seeds."""
    missing: str = ""
    made: Mapping[str, Any] = field(default_factory=dict)
    """How the value was made: command, maybe machine, minutes, versions."""


@dataclass(frozen=True)
class Finding:
    """A claim and all that we have to say of it."""

    claim: Claim
    outcomes: tuple[Outcome, ...]
    again: float | None = None
    """The value of the quick measurement, measured again just now."""

    @property
    def deciding(self) -> Outcome | None:
        """The first outcome that has a value."""
        return next((one for one in self.outcomes if one.value is not None), None)

    @property
    def verdict(self) -> Verdict:
        """That of the deciding outcome."""
        return "not tested" if self.deciding is None else self.deciding.verdict

    @property
    def reason(self) -> str:
        """Why the verdict is not "reproduced"."""
        if self.verdict == "reproduced":
            return ""
        if self.verdict == "not tested" and self.outcomes:
            return self.outcomes[0].missing
        return self.claim.reason

    @property
    def command(self) -> str:
        """What measures the deciding value again; empty where there is none."""
        if self.deciding is None:
            return ""
        if isinstance(self.deciding.source, Measured):
            return f"make claims ONLY={self.claim.id}"
        return self.claim.command or str(self.deciding.made["command"])

    @property
    def minutes(self) -> float | None:
        """What this command takes, where it is known."""
        if self.deciding is None:
            return None
        if self.claim.minutes is not None and isinstance(self.deciding.source, Stored):
            return self.claim.minutes
        return self.deciding.made.get("minutes")

    @property
    def disagreement(self) -> str:
        """In what the value measured again is not the stored one, if it is not."""
        source = self.claim.measured
        if self.again is None or source is None:
            return ""
        stored = next(one.value for one in self.outcomes if one.source is source)
        if stored is None or abs(self.again - stored) <= source.spread * max(1, abs(stored)):
            return ""
        return (
            f"{self.claim.id}: measured again it is {self.again:.6g}, stored is {stored:.6g}, "
            f"and {source.spread:g} apart is what two runs may be"
        )


def stored_findings(claims: Iterable[Claim], root: Path = REPOSITORY) -> tuple[Finding, ...]:
    """Return what the repository's files say of the claims, after checking where they come from.

    Raises
    ------
    ArgumentError
        If a file is damaged, lacks a value or does not tell how it was made.
    """
    return tuple(
        Finding(claim, tuple(_outcome(claim, source, root) for source in claim.ours))
        for claim in claims
    )


def with_measured(findings: Iterable[Finding], again: Mapping[str, float]) -> tuple[Finding, ...]:
    """Return the findings with what has just been measured again, by id."""
    return tuple(replace(one, again=again.get(one.claim.id)) for one in findings)


def _outcome(claim: Claim, source: Stored | Measured, root: Path) -> Outcome:
    try:
        made = provenance(claim, source, root)
        ours = stored_value(claim, source, root)
    except ResultMissingError as missing:
        return Outcome(source, None, "not tested", missing=str(missing))
    return Outcome(source, ours.value, claim.judge(ours), ours.interval, made=made)
