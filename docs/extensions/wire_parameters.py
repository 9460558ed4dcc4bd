"""The directive `wire-parameters`: the parameters of a wire, what each is, its default and range.

It is read from the docstring of `Nanowire` and from the ranges that it checks.
"""

from __future__ import annotations

import inspect
import re
from dataclasses import fields

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from disorder_landscape.model.parameters import Nanowire
from disorder_landscape.model.ranges import BARRIER_RANGE, PARAMETER_RANGES

ENTRY = re.compile(r"^(\w+) : .*\n((?:    .*\n?)+)", re.MULTILINE)
"""A parameter of a NumPy docstring, and what is said of it."""


def table() -> str:
    """Return the table in MyST Markdown."""
    ranges = {**PARAMETER_RANGES, "barrier": BARRIER_RANGE}
    defaults = {field.name: field.default for field in fields(Nanowire)}
    rows = ["| parameter | what it is | default | range |", "|---|---|---|---|"]
    for name, said in ENTRY.findall(inspect.getdoc(Nanowire) or ""):
        if name in ranges:
            low, high, unit = ranges[name]
            default = _written(defaults[name])
            limits = f"{low:,g} to {high:,g} {unit}".strip()
            rows.append(f"| `{name}` | {' '.join(said.split())} | {default} | {limits} |")
    return "\n".join(rows)


def _written(default: object) -> str:
    if default is None:
        return "the wire's"
    if isinstance(default, tuple):
        return ", ".join(map(_written, default))
    return f"{default:g}"


class WireParameters(SphinxDirective):
    """The table, in the place of the directive."""

    def run(self) -> list[nodes.Node]:
        """Return the table's nodes."""
        self.env.note_dependency(inspect.getfile(Nanowire))
        return self.parse_text_to_nodes(table())


def setup(app: Sphinx) -> dict[str, bool]:
    """Make the directive known to Sphinx."""
    app.add_directive("wire-parameters", WireParameters)
    return {"parallel_read_safe": True}
