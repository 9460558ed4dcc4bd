"""Write the report: one HTML page with everything in it, which asks no other machine for anything.

The source is report.py, a notebook in Jupytext's percent format. Its cells run in this process,
so that no Jupyter kernel is needed, and nbconvert makes the page from what they return.
"""

from __future__ import annotations

import argparse
import ast
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jupytext
from nbconvert import HTMLExporter
from nbformat import NotebookNode
from nbformat.v4 import new_output

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.files import check_writable, replacing

SOURCE = Path(__file__).with_name("report.py")
PAGE = Path(__file__).with_name("page.html.j2")
FORMATS = {"text/html": "_repr_html_", "text/markdown": "_repr_markdown_"}
"""What a cell's last value may know of itself."""


def run_cells(
    notebook: NotebookNode, resources: dict[str, Any]
) -> tuple[NotebookNode, dict[str, Any]]:
    """Run the code cells one after the other in one namespace, and keep what they return."""
    namespace: dict[str, Any] = {"__name__": "__main__"}
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    for count, cell in enumerate(code, 1):
        value = run(cell.source, namespace)
        data = {
            mime: getattr(value, method)()
            for mime, method in FORMATS.items()
            if hasattr(value, method)
        }
        cell.execution_count = count
        cell.outputs = [new_output("display_data", data)] if data else []
    return notebook, resources


def run(source: str, namespace: dict[str, Any]) -> Any:
    """Run a cell and return the value of its last line, None where that is no expression."""
    statements = ast.parse(source).body
    last = statements.pop() if statements and isinstance(statements[-1], ast.Expr) else None
    exec(compile(ast.Module(statements, []), "<cell>", "exec"), namespace)
    if not isinstance(last, ast.Expr):
        return None
    return eval(compile(ast.Expression(last.value), "<cell>", "eval"), namespace)


def build(source: Path = SOURCE) -> str:
    """Return the page."""
    notebook = jupytext.read(source)
    for count, cell in enumerate(notebook.cells, 1):
        cell.id = f"cell-{count}"  # Jupytext's are random, and would end up in the page
    exporter = HTMLExporter(template_name="basic", template_file=str(PAGE))
    exporter.register_preprocessor(run_cells, enabled=True)
    page, _ = exporter.from_notebook_node(notebook)
    return str(page)


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the page; exit with 2 for what cannot be used."""
    options = _parse(arguments)
    try:
        check_writable("output", options.output)
        page = build()
        with replacing(options.output) as temporary:
            temporary.write_text(page, "utf-8")
    except ArgumentError as error:
        print(f"report: {error}", file=sys.stderr)
        sys.exit(2)
    print(f"wrote {options.output} ({options.output.stat().st_size / 2**20:.1f} MiB)")


def _parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="build.py",
        description=__doc__,
        epilog="example: python report/build.py --output build/report.html\n"
        "with the figures that are in build/figures by then",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("build/report.html"),
        metavar="FILE",
        help="the page (default: %(default)s)",
    )
    return parser.parse_args(arguments)


if __name__ == "__main__":
    main()
