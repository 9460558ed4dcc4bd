"""What the report's cells show: each function returns something that a notebook can display."""

from __future__ import annotations

import ast
import base64
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.claims.claim import Stored, load_claims
from disorder_landscape.claims.findings import Finding, Outcome, stored_findings
from disorder_landscape.claims.sources import MEASURED_FILE
from disorder_landscape.claims.table import COLUMNS, number, rows, tally
from disorder_landscape.dataset.store import read_dataset
from disorder_landscape.runs import REPOSITORY

FIGURES = REPOSITORY / "build" / "figures"
SCRIPTS = REPOSITORY / "paper_figures"
DOCS = REPOSITORY / "docs"
WIDTH_PER_DOT = 0.45
"""Pixels of the page per dot of a picture: a figure of full width, 2118 dots, takes 953."""


@dataclass(frozen=True)
class Html:
    """HTML, displayed as it is."""

    text: str

    def _repr_html_(self) -> str:
        return self.text


@dataclass(frozen=True)
class Markdown:
    """Markdown, rendered by whoever displays it."""

    text: str

    def _repr_markdown_(self) -> str:
        return self.text


def claims_summary() -> Markdown:
    """Return how many claims have which verdict."""
    found = stored_findings(load_claims())
    return Markdown(f"{len(found)} claims of the paper: **{tally(found)}**.")


def claims_table() -> Html:
    """Return the table of claims, as in docs/claims.md."""
    found = stored_findings(load_claims())
    table = rows(found)
    classes = [one.verdict.replace(" ", "-") for one in found]
    ids = [one.claim.id for one in found]
    body = (_row(COLUMNS, row, *of) for row, *of in zip(table, classes, ids, strict=True))
    return Html(_table(COLUMNS, body))


def stored_results() -> Html:
    """Return a folded table of where each of our values comes from."""
    columns = ("claim", "scale", "value", "from", "made by", "on")
    found = stored_findings(load_claims())
    body = (
        _row(columns, _origin(one, outcome))
        for one in found
        for outcome in one.outcomes
        if outcome.value is not None
    )
    summary = "Where each of our values comes from"
    return Html(f"<details><summary>{summary}</summary>{_table(columns, body)}</details>")


def _origin(finding: Finding, outcome: Outcome) -> tuple[str, ...]:
    source = outcome.source
    made = outcome.made
    value = "" if outcome.value is None else number(outcome.value)
    key = (
        (source.key or source.column or source.derive)
        if isinstance(source, Stored)
        else finding.claim.id
    )
    file = source.file if isinstance(source, Stored) else MEASURED_FILE
    machine = str(made.get("machine", ""))
    command = f"`{made['command']}`"
    return finding.claim.id, source.scale, value, f"`{file}`, {key}", command, machine


def drawn_figures(folder: Path = FIGURES) -> Html:
    """Return every figure that has been drawn, in the paper's order, with caption and command.

    Raises
    ------
    ArgumentError
        If none has been drawn.
    """
    scripts = sorted(SCRIPTS.glob("figure_*.py"), key=_place)
    drawn = [script for script in scripts if (folder / f"{_name(script)}.png").exists()]
    if not drawn:
        but = f"there is none in '{folder}'"
        raise ArgumentError("figures", "have been drawn (make figures)", but)
    minutes = _minutes()
    found = "".join(_figure(script, folder, minutes) for script in drawn)
    missing = [f"<code>make {_target(s)}</code>" for s in scripts if s not in drawn]
    note = f"<p>Not drawn yet: {', '.join(missing)}.</p>" if missing else ""
    return Html(found + note)


def document(name: str) -> Markdown:
    """Return a page of the documentation, without its title and without links to other pages.

    Raises
    ------
    ArgumentError
        If there is no such page.
    """
    path = DOCS / f"{name}.md"
    require(path.exists(), "document", f"have a page '{path}'", "it has none")
    _, _, text = path.read_text("utf-8").partition("\n")
    text = re.sub(r"\[([^][]*)\]\((?!#|https?:)[^)]*\)", r"\1", text)
    return Markdown(re.sub(r"^## ", "### ", text.strip(), flags=re.MULTILINE))


def _figure(script: Path, folder: Path, minutes: dict[str, str]) -> str:
    """Return one figure: title, picture, caption, command and minutes."""
    name = _name(script)
    docstring = ast.get_docstring(ast.parse(script.read_text("utf-8"))) or name
    title, _, caption = docstring.partition("\n\n")
    png = (folder / f"{name}.png").read_bytes()
    image = base64.b64encode(png).decode()
    width = round(WIDTH_PER_DOT * int.from_bytes(png[16:20]))  # PNG has its width in dots there
    attrs = read_dataset(folder / f"{name}.nc").attrs
    taken = minutes.get(script.name)
    said = [f"<code>{escape(str(attrs['command']))}</code>"]
    said += [f"{taken} min"] if taken else []
    return (
        f'<figure id="{name}"><h3>{escape(title.rstrip("."))}</h3>'
        f'<img width="{width}" alt="{escape(title)}" src="data:image/png;base64,{image}">'
        f"<figcaption>{_paragraphs(caption)}<p>{' · '.join(said)}</p></figcaption></figure>"
    )


def _paragraphs(text: str) -> str:
    return "".join(f"<p>{_inline(part)}</p>" for part in text.split("\n\n") if part.strip())


def _minutes() -> dict[str, str]:
    """Return the minutes of each figure's script, from the table in docs/reproduce.md."""
    rows_of_table = re.findall(
        r"^\|[^|]*\| *`(figure_[^`]*\.py)` *\|.*\| *([\d.]+) *\|$",
        (DOCS / "reproduce.md").read_text("utf-8"),
        re.MULTILINE,
    )
    return dict(rows_of_table)


def _name(script: Path) -> str:
    """Return figure_3 for figure_3_conductance_bias.py."""
    return "_".join(script.stem.split("_")[:2])


def _target(script: Path) -> str:
    return _name(script).replace("_", "-")


def _place(script: Path) -> tuple[bool, int]:
    """Return a key that sorts Figs. 1, 2, …, S1, S2, …, S10."""
    label = script.stem.split("_")[1]
    return label.startswith("S"), int(label.removeprefix("S"))


def _table(columns: Sequence[str], body: Iterable[str]) -> str:
    head = "".join(f"<th>{escape(column)}</th>" for column in columns)
    rows_ = "".join(body)
    return f'<table class="cards"><thead><tr>{head}</tr></thead><tbody>{rows_}</tbody></table>'


def _row(columns: Sequence[str], cells: Sequence[str], class_: str = "", id_: str = "") -> str:
    """Return a row whose cells name their column, for narrow screens."""
    tds = "".join(
        f'<td data-column="{escape(column)}">{_inline(cell)}</td>'
        for column, cell in zip(columns, cells, strict=True)
    )
    attributes = f' class="{class_}"' if class_ else ""
    attributes += f' id="{id_}"' if id_ else ""
    return f"<tr{attributes}>{tds}</tr>"


def _inline(text: str) -> str:
    """Return HTML of a line with **bold** and `code`."""
    html = re.sub(r"\*\*(.+?)\*\*", r"<b>\1</b>", escape(text, quote=False))
    return re.sub(r"`(.+?)`", r"<code>\1</code>", html)
