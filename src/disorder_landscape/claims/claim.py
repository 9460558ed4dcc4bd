"""A claim of the paper, as results/claims.toml states it, and the rule that judges a value."""

from __future__ import annotations

import math
import tomllib
from functools import cache
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.claims.value import Value
from disorder_landscape.runs import REPOSITORY

CLAIMS_FILE = REPOSITORY / "results" / "claims.toml"

WORDS = 8
"""Of a reason in the short table."""

Sense = Literal["at least", "at most", "within", "exactly"]
Verdict = Literal["reproduced", "differs", "undecided", "not tested"]


class ResultMissingError(Exception):
    """What a value would come from is not there: the study has not run, or not all of it."""


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    scale: str
    """At which size, on what, or in which reading of the paper our value was measured."""


class Stored(_Table):
    """Our value in a file of results: by a key (JSON), from a column (CSV), or derived from it."""

    file: str
    """From the root of the repository; where it is missing, the study has not run yet."""
    key: str | None = None
    """JSON: names of the nested objects and of the value, joined with slashes."""
    where: dict[str, str | float] = {}
    """CSV: what columns must hold in the rows that count; no condition takes all rows."""
    minus: dict[str, str | float] | None = None
    """CSV: of the rows that fit this instead, the value is subtracted."""
    column: str | None = None
    """CSV: the column of the value."""
    reduce: Literal["only", "mean", "median", "min", "max", "sum"] = "only"
    """CSV: what becomes of several rows; "only" allows one, "mean" takes seeds, or wires."""
    derive: str | None = None
    """A study's table: the name of a function of `claims.derived`."""
    times: float = 1.0
    """A factor, such as 2 where an error is compared as two standard deviations."""
    from_one: bool = False
    """Whether it is subtracted from one then, so that a scaled square error becomes R²."""

    @model_validator(mode="after")
    def _one_of_three(self) -> Stored:
        if sum(what is not None for what in (self.key, self.column, self.derive)) != 1:
            raise ValueError("a file needs one of key (JSON), column (CSV) and derive")
        return self


class Measured(_Table):
    """Our value from a quick measurement, which is stored in results/measured.json."""

    measure: str
    """Name of a function of `claims.measurements`."""
    arguments: dict[str, str | float] = {}
    spread: Annotated[float, Field(ge=0)] = 0.0
    """How far two runs may lie apart, also on different processors; above one, relative."""
    needs: str | None = None
    """A file or folder without which it cannot be measured: a study that has not run yet."""


class Claim(BaseModel):
    """One number, or one sentence that can be checked, of the paper."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    id: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9.-]*$")]
    statement: str
    """In our words."""
    where: str
    """Section or figure of the paper."""
    paper: int | float | None = None
    """The paper's number; or, where it has words only, the number that we ask for instead."""
    words: str | None = None
    """What the paper says where it gives no number."""
    unit: str = ""
    sense: Sense = "within"
    """How `paper` and `tolerance` bound our value."""
    tolerance: Annotated[float, Field(ge=0)] = 0.0
    ours: tuple[Stored | Measured, ...] = ()
    """Where our values come from. The first of these that is there decides."""
    why: str = ""
    """The reason, in eight words at most, for the short table."""
    reason: str = ""
    """Why it differs, where it does; or why it is not tested, where there is nothing to test."""
    remark: str = ""
    """What should be known of the verdict, whichever it is."""
    command: str | None = None
    """Measures it again; left out where `make claims ONLY=…` or what the file says does."""
    minutes: Annotated[float, Field(ge=0)] | None = None
    """What this command takes on two cores; left out with it."""

    @model_validator(mode="after")
    def _consistent(self) -> Claim:
        if bool(self.why) != bool(self.reason) or len(self.why.split()) > WORDS:
            raise ValueError(
                f"'{self.id}' must say why in {WORDS} words at most, if it has a reason"
            )
        if not self.ours:
            if not self.reason:
                raise ValueError(f"'{self.id}' is not tested, so it must give the reason")
            return self
        if self.paper is None or (self.sense == "exactly" and self.tolerance):
            raise ValueError(f"'{self.id}' needs a number to compare with, and its tolerance")
        if (self.command is None) != (self.minutes is None):
            raise ValueError(f"'{self.id}' must give its command and the minutes, or neither")
        if len([source for source in self.ours if isinstance(source, Measured)]) > 1:
            raise ValueError(f"'{self.id}' must have one quick measurement at most")
        return self

    @property
    def measured(self) -> Measured | None:
        """The quick measurement, if it has one."""
        return next((source for source in self.ours if isinstance(source, Measured)), None)

    def judge(self, ours: Value) -> Verdict:
        """Return whether a value of ours reproduces the paper's, within the tolerance.

        "Undecided" is a value that does not, but whose interval reaches those that would. A
        relative 1e-12 is allowed for, since 0.95 − 0.005 is no decimal number to a computer.
        """
        if self.paper is None:
            return "not tested"
        rounding = 1e-12 * abs(self.paper)
        least, most = self.paper - self.tolerance - rounding, self.paper + self.tolerance + rounding
        if self.sense == "exactly":
            least = most = self.paper
        if self.sense == "at least":
            most = math.inf
        if self.sense == "at most":
            least = -math.inf
        if least <= ours.value <= most:
            return "reproduced"
        low, high = ours.interval or (ours.value, ours.value)
        return "undecided" if low <= most and least <= high else "differs"


@cache
def load_claims(path: Path = CLAIMS_FILE) -> tuple[Claim, ...]:
    """Read and check the claims.

    Raises
    ------
    ArgumentError
        If the file is missing or no TOML, a claim is not as `Claim` says, or two share an id.
    """
    try:
        content = tomllib.loads(path.read_text("utf-8"))
        claims = tuple(Claim.model_validate(table) for table in content.get("claim", []))
    except OSError as error:
        but = f"'{path}' cannot be read ({error.strerror})"
        raise ArgumentError("claims", "be a readable TOML file", but) from None
    except tomllib.TOMLDecodeError as error:
        raise ArgumentError("claims", "be a TOML file", f"'{path}' is not: {error}") from None
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        but = f"{place or 'a claim'} is wrong: {first['msg'].removeprefix('Value error, ')}"
        raise ArgumentError("claims", f"be the paper's claims ('{path}')", but) from None
    names = [claim.id for claim in claims]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        must = "have an id of its own each"
        raise ArgumentError("claims", must, f"{', '.join(twice)} is there twice")
    return claims


def claim_of(name: str, claims: tuple[Claim, ...] | None = None) -> Claim:
    """Return the claim of an id.

    Raises
    ------
    ArgumentError
        If there is none.
    """
    claims = load_claims() if claims is None else claims
    for claim in claims:
        if claim.id == name:
            return claim
    must = f"be one of {', '.join(claim.id for claim in claims)}"
    raise ArgumentError("only", must, f"it is '{name}'")


def paper_value(name: str) -> float:
    """Return the paper's number of a claim, for what is computed from several of them."""
    value = claim_of(name).paper
    if value is None:
        raise ArgumentError("claim", "have a number", f"'{name}' has none")
    return value
