"""The directive `paper-formulas`: a table of the paper's formulas, the functions and their tests.

It is read from tests/test_equations.py.  A test whose docstring begins with a place in the paper
("S-I: …", "Eq. S1: …") is a row; its functions are those of the package that the test calls.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

TESTS = Path(__file__).parents[2] / "tests" / "test_equations.py"
PACKAGE = "disorder_landscape"
PLACE = re.compile(r"(Eq\. \w+|S-[IV.\d]+): (.*)", re.DOTALL)
REFERENCE = "kwant_reference"
"""What a test compares with is no function of a formula."""


def table(source: str) -> str:
    """Return the table, in MyST Markdown, of the tests in a source text."""
    module = ast.parse(source)
    known = _imported(module)
    constants = _constants(module)
    head = ["| in the paper | formula | function | test |", "|---|---|---|---|"]
    body = []
    for test in module.body:
        said = ast.get_docstring(test) if isinstance(test, ast.FunctionDef) else None
        place = PLACE.fullmatch(" ".join(said.split())) if said else None
        if place is None:
            continue
        of_test = _functions(test, known)
        if not of_test:
            used = {node.id for node in ast.walk(test) if isinstance(node, ast.Name)}
            of_test = [
                name
                for c in sorted(used & set(constants))
                for name in _functions(constants[c], known)
            ]
        functions = ", ".join(map(_written, dict.fromkeys(of_test)))
        body.append(f"| {place[1]} | {_escaped(place[2])} | {functions} | `{test.name}` |")
    return "\n".join(head + body)


def _imported(module: ast.Module) -> dict[str, str]:
    """Return the dotted name of everything that comes from the package."""
    return {
        alias.asname or alias.name: f"{node.module}.{alias.name}"
        for node in module.body
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(PACKAGE)
        for alias in node.names
        if alias.name not in (REFERENCE, "ArgumentError") and not alias.name.isupper()
    }


def _constants(module: ast.Module) -> dict[str, ast.expr]:
    return {
        node.targets[0].id: node.value
        for node in module.body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    }


def _functions(tree: ast.AST, known: dict[str, str]) -> list[str]:
    """Return the dotted names of what is called, but for Nanowire where there is anything else."""
    called = list(_called(tree, known))
    return [name for name in called if not name.endswith(".Nanowire")] or called


def _called(tree: ast.AST, known: dict[str, str]) -> Iterator[str]:
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Name(id=name)) if name in known:
                yield known[name]
            case ast.Call(func=ast.Attribute(value=ast.Name(id=name), attr=attr)) if name in known:
                yield f"{known[name]}.{attr}"


def _written(name: str) -> str:
    """Return a link to a public name, and the path of another one within the package."""
    short = name.removeprefix(f"{PACKAGE}.")
    return f"`{short}`" if "." in short else f"{{py:obj}}`~{name}`"


def _escaped(text: str) -> str:
    return re.sub(r"([\\*_|`<$])", r"\\\1", text)


class PaperFormulas(SphinxDirective):
    """The table, in the place of the directive."""

    def run(self) -> list[nodes.Node]:
        """Return the table's nodes."""
        self.env.note_dependency(str(TESTS))
        return self.parse_text_to_nodes(table(TESTS.read_text("utf-8")))


def setup(app: Sphinx) -> dict[str, bool]:
    """Make the directive known to Sphinx."""
    app.add_directive("paper-formulas", PaperFormulas)
    return {"parallel_read_safe": True}
