"""The report: one page that holds everything and asks no other machine for anything."""

from __future__ import annotations

import base64
import re
import sys
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from disorder_landscape import ArgumentError
from disorder_landscape.claims.claim import load_claims

sys.path.insert(0, str(Path(__file__).parents[1] / "report"))  # as if run as a script

import build
import pieces

PNG = b"\x89PNG\r\n\x1a\n" + b"\0\0\0\x0dIHDR" + (1000).to_bytes(4)
VOID = {"meta", "img", "br", "hr", "link", "input"}


@pytest.fixture
def drawn(monkeypatch, tmp_path):
    """Two figures that have been drawn."""
    for name in ("figure_3", "figure_S9"):
        (tmp_path / f"{name}.png").write_bytes(PNG + name.encode())
        attrs = {"command": f"python paper_figures/{name}.py --preset smoke"}
        data = xr.Dataset({"x": ("y", np.zeros(2))}, attrs=attrs)
        data.to_netcdf(tmp_path / f"{name}.nc", engine="h5netcdf")
    monkeypatch.setattr(pieces.drawn_figures, "__defaults__", (tmp_path,))
    return tmp_path


@pytest.fixture
def page(drawn):
    return build.build()


class Reader(HTMLParser):
    """Collects ids, sources and links, and sees whether every tag is closed."""

    def __init__(self, page):
        super().__init__()
        self.ids, self.sources, self.links, self.tags, self.open = [], [], [], set(), []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        known = dict(attrs)
        self.tags.add(tag)
        self.ids += [known["id"]] if "id" in known else []
        self.sources += [known["src"]] if "src" in known else []
        self.links += [known["href"]] if "href" in known else []
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag


def test_the_page_asks_no_other_machine_for_anything(page):
    read = Reader(page)
    assert not {"script", "link", "iframe", "object"} & read.tags
    assert read.sources
    assert all(source.startswith("data:image/png;base64,") for source in read.sources)
    assert "@import" not in page
    assert "url(" not in page


def test_tags_are_closed_and_links_on_the_page_lead_somewhere(page):
    read = Reader(page)
    assert read.open == []
    assert len(read.ids) == len(set(read.ids))
    assert {link[1:] for link in read.links if link.startswith("#")} <= set(read.ids)


def test_the_page_holds_claims_figures_and_conventions(page):
    read = Reader(page)
    assert {claim.id for claim in load_claims()} <= set(read.ids)
    assert {"figure_3", "figure_S9"} <= set(read.ids)
    assert "Not drawn yet: <code>make figure-1</code>" in page
    assert "python paper_figures/figure_S9.py --preset smoke</code> · 0.3 min" in page
    pictures = [base64.b64decode(source.split(",")[1]) for source in read.sources]
    assert page.count('width="450"') == 2
    assert pictures == [PNG + b"figure_3", PNG + b"figure_S9"]
    text = re.sub(r"<[^>]*>", "", page)
    assert "301 sites, or barriers on sites of their own" in text  # of docs/conventions.md
    assert "viewport" in page


def test_the_same_results_give_the_same_page(drawn):
    assert build.build() == build.build()


def test_figures_come_in_the_papers_order():
    names = ["figure_S10_a.py", "figure_3_b.py", "figure_S2_c.py", "figure_1_d.py"]
    ordered = sorted(map(Path, names), key=pieces._place)
    assert [pieces._name(path) for path in ordered] == [
        "figure_1",
        "figure_3",
        "figure_S2",
        "figure_S10",
    ]


def test_a_cell_gives_the_value_of_its_last_line():
    namespace = {}
    assert build.run("a = 2\na + 1", namespace) == 3
    assert build.run("b = a", namespace) is None
    assert build.run("", namespace) is None
    assert namespace["b"] == 2


def test_text_is_escaped():
    assert pieces._inline("a < b, `c & d`, **e**") == "a &lt; b, <code>c &amp; d</code>, <b>e</b>"


def test_without_a_figure_it_is_one_sentence_and_nothing_is_written(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(pieces.drawn_figures, "__defaults__", (tmp_path / "none",))
    with pytest.raises(SystemExit) as stop:
        build.main(["--output", str(tmp_path / "report.html")])
    assert stop.value.code == 2
    assert capsys.readouterr().err.startswith("report: Argument figures must have been drawn")
    assert not list(tmp_path.iterdir())


def test_a_page_that_the_docs_lack_is_refused():
    with pytest.raises(ArgumentError, match=r"a page '.*nonesuch\.md'"):
        pieces.document("nonesuch")
