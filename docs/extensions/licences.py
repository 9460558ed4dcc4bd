"""The directive `licences`: all packages that requirements.lock pins, by their licence.

It is read from what the installed packages say of themselves.
"""

from __future__ import annotations

import re
from collections import defaultdict
from importlib import metadata
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

LOCK = Path(__file__).parents[2] / "requirements.lock"
PINNED = re.compile(r"^([a-z0-9][a-z0-9._-]*)==", re.MULTILINE)
FAMILIES = (
    ("GPL", r"(?<!L)GPL|General Public License"),
    ("LGPL", r"LGPL"),
    ("MPL 2.0", r"MPL|Mozilla"),
    ("Apache 2.0", r"Apache"),
    ("BSD", r"BSD"),
    ("MIT", r"MIT|ISC"),
    ("Python", r"PSF|Python Software Foundation"),
)
"""In this order: of several licences the one that asks for most."""
NOT_STATED = {"namex": "Apache 2.0"}
"""Where the package names none: what its repository says."""


def licences() -> dict[str, list[str]]:
    """Return the names of the pinned packages by licence; "not installed here" is one."""
    found = defaultdict(list)
    for name in dict.fromkeys(PINNED.findall(LOCK.read_text())):
        found[_licence(name)].append(name)
    return dict(found)


def _licence(name: str) -> str:
    try:
        said = metadata.metadata(name)
    except metadata.PackageNotFoundError:
        return "not installed here"
    classes = [line for line in said.get_all("Classifier", []) if line.startswith("License")]
    first = (said.get("License") or "").splitlines()[:1]
    text = said.get("License-Expression") or " ".join(classes + first)
    for family, pattern in FAMILIES:
        if re.search(pattern, text):
            return family
    return NOT_STATED.get(name, "not stated")


def table() -> str:
    """Return the table in MyST Markdown."""
    rows = ["| licence | packages |", "|---|---|"]
    rows += [
        f"| {licence} | {', '.join(names)} |"
        for licence, names in sorted(licences().items(), key=lambda row: -len(row[1]))
    ]
    return "\n".join(rows)


class Licences(SphinxDirective):
    """The table, in the place of the directive."""

    def run(self) -> list[nodes.Node]:
        """Return the table's nodes."""
        self.env.note_dependency(str(LOCK))
        return self.parse_text_to_nodes(table())


def setup(app: Sphinx) -> dict[str, bool]:
    """Make the directive known to Sphinx."""
    app.add_directive("licences", Licences)
    return {"parallel_read_safe": True}
