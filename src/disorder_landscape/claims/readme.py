"""The README's tables of claims and of studies, written between marks from stored results."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from disorder_landscape.arguments import require
from disorder_landscape.chain import REPOSITORY
from disorder_landscape.claims.claim import load_claims
from disorder_landscape.claims.conventions import conventions_table
from disorder_landscape.claims.findings import stored_findings
from disorder_landscape.claims.inversions import (
    accuracy_table,
    components_table,
    uniqueness_table,
    unmodelled_table,
)
from disorder_landscape.claims.table import COLUMNS, markdown, rows, tally
from disorder_landscape.files import replacing

README = REPOSITORY / "README.md"


@dataclass(frozen=True)
class Section:
    """A part of the README that stands between two marks of its own."""

    name: str

    @property
    def begin(self) -> str:
        """The first mark."""
        return f"<!-- {self.name}: written by `make claims-table`, not by hand -->"

    @property
    def end(self) -> str:
        """The last mark."""
        return f"<!-- end of the {self.name} -->"

    def replaced(self, text: str, content: str) -> str:
        """Return a README's text with this content in place of the section's.

        Raises
        ------
        ArgumentError
            If the text lacks a mark, or has one twice.
        """
        must = f"have each of the two marks of the {self.name} once"
        once = text.count(self.begin) == text.count(self.end) == 1
        in_order = once and text.index(self.begin) < text.index(self.end)
        require(in_order, "README", must, "it has not")
        before, rest = text.split(self.begin)
        after = rest.split(self.end)[1]
        return f"{before}{self.begin}\n\n{content}\n{self.end}{after}"


def claims_content() -> str:
    """Return the tally and the table of all claims."""
    findings = stored_findings(load_claims())
    return f"{len(findings)} claims: {tally(findings)}.\n\n{markdown(COLUMNS, rows(findings))}"


def written(text: str) -> str:
    """Return a README's text with all sections as the stored results have them."""
    contents = {
        "claims": claims_content,
        "components": components_table,
        "conventions": conventions_table,
        "inversions": accuracy_table,
        "uniqueness": uniqueness_table,
        "unmodelled": unmodelled_table,
    }
    for name, content in contents.items():
        text = Section(name).replaced(text, content())
    return text


def write_readme(path: Path = README) -> bool:
    """Write the tables into the README; return whether it has changed."""
    text = path.read_text("utf-8")
    new = written(text)
    if new == text:
        return False
    with replacing(path) as temporary:
        temporary.write_text(new, "utf-8")
    return True
