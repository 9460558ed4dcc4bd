"""What documents say of claims and studies, written between marks from stored results."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from disorder_landscape.arguments import require
from disorder_landscape.claims.claim import load_claims
from disorder_landscape.claims.conventions import conventions_table
from disorder_landscape.claims.findings import stored_findings
from disorder_landscape.claims.study_tables import (
    accuracy_table,
    components_table,
    uniqueness_table,
    unmodelled_table,
)
from disorder_landscape.claims.table import SUMMARY_COLUMNS, markdown, section, summary, tally
from disorder_landscape.files import replacing
from disorder_landscape.runs import REPOSITORY


@dataclass(frozen=True)
class Section:
    """A part of a document that stands between two marks of its own."""

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
        """Return a document's text with this content in place of the section's.

        Raises
        ------
        ArgumentError
            If the text lacks a mark, or has one twice.
        """
        must = f"have each of the two marks of the {self.name} once"
        once = text.count(self.begin) == text.count(self.end) == 1
        in_order = once and text.index(self.begin) < text.index(self.end)
        require(in_order, "document", must, "it has not")
        before, rest = text.split(self.begin)
        after = rest.split(self.end)[1]
        return f"{before}{self.begin}\n\n{content}\n{self.end}{after}"


def claims_tally() -> str:
    """Return how many claims have which verdict."""
    findings = stored_findings(load_claims())
    return f"{len(findings)} claims: {tally(findings)}.\n"


def claims_table() -> str:
    """Return the tally, a short table of all claims, and a section of each."""
    findings = stored_findings(load_claims())
    sections = "\n".join(section(one) for one in findings)
    return f"{claims_tally()}\n{markdown(SUMMARY_COLUMNS, summary(findings))}\n{sections}"


PAGES: dict[str, dict[str, Callable[[], str]]] = {
    "README.md": {"tally": claims_tally},
    "docs/claims.md": {"claims": claims_table},
    "docs/studies.md": {
        "components": components_table,
        "conventions": conventions_table,
        "inversions": accuracy_table,
        "uniqueness": uniqueness_table,
        "unmodelled": unmodelled_table,
    },
}
"""Documents, and what makes the content of each of their sections."""


def written(page: str, text: str) -> str:
    """Return a document's text with all its sections as the stored results have them."""
    for name, content in PAGES[page].items():
        text = Section(name).replaced(text, content())
    return text


def write_pages(repository: Path = REPOSITORY) -> list[str]:
    """Write the sections of all documents; return the documents that have changed."""
    changed = []
    for page in PAGES:
        path = repository / page
        text = path.read_text("utf-8")
        new = written(page, text)
        if new != text:
            with replacing(path) as temporary:
                temporary.write_text(new, "utf-8")
            changed.append(page)
    return changed
