"""The claims in print: numbers as they are written, Markdown for people, JSON for programs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

from disorder_landscape.claims.claim import Claim
from disorder_landscape.claims.findings import Finding, Outcome

_SIGNS = {"at least": "≥", "at most": "≤", "exactly": "="}
_MARKS = {"reproduced": "✓", "differs": "✗", "undecided": "?", "not tested": ""}


_POWER = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float, digits: int = 4) -> str:
    """Return a number as it is printed: so many digits, and more where it is close to one."""
    return _printed(value, digits).replace("-", "−")


def _printed(value: float, digits: int) -> str:
    if value == int(value) and abs(value) < 1e8:
        return f"{int(value):,}"
    if abs(value) >= 1e8 or 0 < abs(value) < 1e-4:
        factor, power = f"{value:.1e}".split("e")
        return f"{factor}·10{str(int(power)).translate(_POWER)}"
    if abs(value) >= 1000:
        return f"{value:,.0f}"
    near_one = 0.99 <= abs(value) < 1
    return f"{value:.5f}".rstrip("0").rstrip(".") if near_one else f"{value:.{digits}g}"


def stated(claim: Claim) -> str:
    """Return what the paper states: its words, or its number and unit."""
    if claim.words is not None:
        return claim.words
    return "" if claim.paper is None else f"{number(claim.paper, 6)} {claim.unit}".rstrip()


def accepted(claim: Claim) -> str:
    """Return which values of ours count as reproducing the paper's."""
    if claim.paper is None:
        return ""
    if claim.sense == "within":
        return f"{number(claim.paper, 6)} ± {number(claim.tolerance)}"
    side = {"at least": -1, "at most": 1, "exactly": 0}[claim.sense]
    return f"{_SIGNS[claim.sense]} {number(claim.paper + side * claim.tolerance, 6)}"


def ours(finding: Finding, separator: str = "; ") -> str:
    """Return our values with their scales, the deciding one first, each with its own verdict."""
    there = [one for one in finding.outcomes if one.value is not None]
    unit = f" {finding.claim.unit}" if finding.claim.unit else ""
    return separator.join(_value(one, unit) for one in there)


def _value(outcome: Outcome, unit: str) -> str:
    mark = _MARKS[outcome.verdict]
    return f"{_with_interval(outcome)}{unit} {mark} ({outcome.source.scale})"


def _with_interval(outcome: Outcome) -> str:
    """Return a value and, in brackets, the interval that it has over seeds."""
    assert outcome.value is not None
    text = number(outcome.value)
    if outcome.interval is None:
        return text
    low, high = (number(end, 3) for end in outcome.interval)
    return f"{text} [{low}, {high}]"


def verdict(finding: Finding) -> str:
    """Return the verdict with its reason and remark."""
    waits = finding.verdict == "not tested" and bool(finding.outcomes)
    parts = [finding.verdict + " yet" * waits + (f": {finding.reason}" if finding.reason else "")]
    if finding.claim.remark and finding.deciding is not None:
        parts.append(finding.claim.remark)
    return "; ".join(parts)


def tally(findings: Iterable[Finding]) -> str:
    """Return how many claims have which verdict."""
    count = Counter(finding.verdict for finding in findings)
    undecided = f"{count['undecided']} undecided, " if count["undecided"] else ""
    return (
        f"{count['reproduced']} reproduced, {count['differs']} differ, {undecided}"
        f"{count['not tested']} not tested"
    )


COLUMNS = ("claim", "paper", "accepted", "ours", "verdict", "measured by")


def rows(findings: Iterable[Finding]) -> list[tuple[str, ...]]:
    """Return the cells of the table, a tuple of COLUMNS for each claim."""
    return [
        (
            f"**{one.claim.id}** {one.claim.statement} ({one.claim.where})",
            stated(one.claim),
            accepted(one.claim),
            ours(one),
            verdict(one),
            measured_by(one),
        )
        for one in findings
    ]


SUMMARY_COLUMNS = ("claim", "paper", "ours", "verdict", "why")


def summary(findings: Iterable[Finding]) -> list[tuple[str, ...]]:
    """Return the cells of a short table, whose claims are links to their `section`."""
    return [
        (
            f"[{one.claim.id}](#{_anchor(one.claim)})",
            stated(one.claim),
            _deciding(one),
            one.verdict,
            "" if one.verdict == "reproduced" else one.claim.why,
        )
        for one in findings
    ]


def section(finding: Finding) -> str:
    """Return all there is to say of a claim, under a heading of its own, as Markdown."""
    claim, values = finding.claim, ours(finding, "\n  - ")
    items = [f"**Paper**: {stated(claim)} ({claim.where})".replace(":  (", ": (")]
    if accepted(claim):
        items.append(f"**Accepted**: {accepted(claim)}")
    if values:
        items.append(f"**Ours**:\n  - {values}")
    items.append(f"**Verdict**: {verdict(finding)}")
    if measured_by(finding):
        items.append(f"**Measured by**: {measured_by(finding)}")
    lines = "".join(f"- {item}\n" for item in items)
    return f"## {claim.id}\n\n{claim.statement}.\n\n{lines}"


def _anchor(claim: Claim) -> str:
    """Return what a claim's heading is linked by, in Sphinx and on the web alike."""
    return claim.id.replace(".", "")


def _deciding(finding: Finding) -> str:
    """Return our value that decides, without its scale."""
    one = finding.deciding
    if one is None or one.value is None:
        return ""
    return f"{_with_interval(one)} {finding.claim.unit or ''}".rstrip()


def measured_by(finding: Finding) -> str:
    """Return the command that measures our value again, and its minutes."""
    command = f"`{finding.command}`" if finding.command else ""
    if finding.minutes is None:
        return command
    minutes = max(finding.minutes, 0.1)
    return f"{command}, {minutes:.0f} min" if minutes >= 2 else f"{command}, {minutes:.1f} min"


def markdown(columns: Sequence[str], table: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    lines = [" | ".join(columns), "|".join("---" for _ in columns)]
    lines += [" | ".join(cell.replace("|", "\\|") for cell in row) for row in table]
    return "".join(f"| {line} |\n" if i != 1 else f"|{line}|\n" for i, line in enumerate(lines))


def as_json(findings: Iterable[Finding]) -> list[dict[str, Any]]:
    """Return the findings as what JSON can hold."""
    return [
        {
            "id": one.claim.id,
            "statement": one.claim.statement,
            "where": one.claim.where,
            "paper": one.claim.paper,
            "words": one.claim.words,
            "unit": one.claim.unit,
            "sense": one.claim.sense,
            "tolerance": one.claim.tolerance,
            "ours": [
                {
                    "scale": outcome.source.scale,
                    "value": outcome.value,
                    "interval": outcome.interval,
                    "verdict": outcome.verdict,
                    "missing": outcome.missing,
                }
                for outcome in one.outcomes
            ],
            "measured_again": one.again,
            "verdict": one.verdict,
            "reason": one.reason,
            "remark": one.claim.remark,
            "command": one.command,
            "minutes": one.minutes,
            "disagreement": one.disagreement,
        }
        for one in findings
    ]
