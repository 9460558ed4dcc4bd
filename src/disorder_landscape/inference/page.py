"""A page (HTML) of what `infer` has found, in one file that any browser opens."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from disorder_landscape.files import replacing
from disorder_landscape.inference.inferred import prior_of_result
from disorder_landscape.inference.problem.parameters import BY_NAME
from disorder_landscape.inference.report import (
    error_bar,
    misfits,
    not_fixed_lines,
    parameter_with_std,
    prior_as_text,
    sentences_on,
)
from disorder_landscape.inference.verdict import CONVERGED
from disorder_landscape.pictures import picture

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DPI = 200
"""Of pictures."""
STYLE = """
body { font: 16px/1.5 sans-serif; max-width: 60em; margin: 1em auto; padding: 0 1em; }
img { max-width: 100%; height: auto; }
table { border-collapse: collapse; margin: 1em 0; display: block; overflow-x: auto; }
th, td { text-align: left; padding: .2em 1em .2em 0; border-bottom: 1px solid #ccc; }
.verdict { border-left: .4em solid; padding: .3em .8em; }
.converged { border-color: #2a7; background: #f0faf5; }
.doubtful { border-color: #c33; background: #fdf2f2; }
"""


def write_page(result: xr.Dataset, figure: Figure, path: Path) -> None:
    """Write the verdict in a sentence, the figure, and the parameters beside what was known.

    Parameters
    ----------
    result : Dataset
        What `infer` returned.
    figure : Figure
        Of the result.
    path : Path
    """
    text = page(result, figure)
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def page(result: xr.Dataset, figure: Figure) -> str:
    """Return the page."""
    attrs = result.attrs
    kind = "converged" if attrs["verdict"] == CONVERGED else "doubtful"
    sentences = " ".join(sentences_on(result))
    png = base64.b64encode(picture(figure, "png", dpi=DPI)).decode()
    parts = [
        "<!doctype html>",
        '<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{escape(attrs['verdict'])}</title><style>{STYLE}</style></head><body>",
        "<h1>From a measurement to the disorder</h1>",
        f'<p class="verdict {kind}">{escape(sentences)}</p>',
        f'<img alt="{escape(sentences)}" src="data:image/png;base64,{png}">',
        _table("Parameters", ("", "before", "found"), _parameters(result)),
        *(f"<p>{escape(line)}</p>" for line in not_fixed_lines(result)),
        _table("Misfit", ("", "root mean square (e²/h)", "stated noise"), misfits(result)),
        _table("How it was found", ("", ""), _how(result)),
        "</body></html>",
    ]
    return "\n".join(part for part in parts if part)


def _table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table, or nothing without rows."""
    if not rows:
        return ""
    lines = ["".join(f"<th>{escape(cell)}</th>" for cell in head)] if any(head) else []
    lines += ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows]
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    return f"<h2>{escape(title)}</h2><table>{body}</table>"


def _parameters(result: xr.Dataset) -> list[tuple[str, str, str]]:
    return [
        (
            f"{BY_NAME[name].long_name} ({name})",
            prior_as_text(result, name, belief),
            parameter_with_std(result, name),
        )
        for name, belief in prior_of_result(result).unknown.items()
    ]


def _how(result: xr.Dataset) -> list[tuple[str, str]]:
    attrs = result.attrs
    return [
        ("start", attrs["start"]),
        ("attempts, rounds", f"{attrs['attempts']}, {attrs['rounds']}"),
        ("error bar of V, root mean square", f"{error_bar(result):.3g} µeV"),
        ("effective sample size", f"{attrs['effective_sample_size']:.0f}"),
        ("log evidence", f"{attrs['log_evidence']:.1f}"),
    ]
