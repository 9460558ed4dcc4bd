"""The README's table of claims, written between two marks from the claims and their results."""

from __future__ import annotations

from pathlib import Path

from disorder_landscape.arguments import require
from disorder_landscape.chain import REPOSITORY
from disorder_landscape.claims.claim import load_claims
from disorder_landscape.claims.findings import Finding, stored_findings
from disorder_landscape.claims.table import COLUMNS, markdown, rows, tally
from disorder_landscape.files import replacing

README = REPOSITORY / "README.md"
BEGIN = "<!-- claims: written by `make claims-table`, not by hand -->"
END = "<!-- end of the claims -->"


def claims_section(findings: tuple[Finding, ...]) -> str:
    """Return what stands between the marks."""
    table = markdown(COLUMNS, rows(findings))
    return f"{BEGIN}\n\n{len(findings)} claims: {tally(findings)}.\n\n{table}\n{END}"


def with_claims(text: str, section: str) -> str:
    """Return a README's text with the section in place of the one that it has.

    Raises
    ------
    ArgumentError
        If it lacks a mark, or has one twice.
    """
    must = "have each of the two marks of the claims once"
    once = text.count(BEGIN) == text.count(END) == 1 and text.index(BEGIN) < text.index(END)
    require(once, "README", must, "it has not")
    before, rest = text.split(BEGIN)
    return before + section + rest.split(END)[1]


def write_readme(path: Path = README) -> bool:
    """Write the table of claims into the README; return whether it has changed."""
    text = path.read_text("utf-8")
    new = with_claims(text, claims_section(stored_findings(load_claims())))
    if new == text:
        return False
    with replacing(path) as temporary:
        temporary.write_text(new, "utf-8")
    return True
