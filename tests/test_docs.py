"""The documentation: its table of formulas, and the README that leads to it."""

from __future__ import annotations

import re
import sys
from dataclasses import fields

from disorder_landscape.model.parameters import Nanowire
from disorder_landscape.runs import REPOSITORY
from test_claims import make_exists

sys.path.insert(0, str(REPOSITORY / "docs" / "extensions"))  # as docs/conf.py does

import licences
import paper_formulas
import wire_parameters

README = (REPOSITORY / "README.md").read_text("utf-8")


def test_every_stated_formula_has_a_function_and_a_test():
    source = paper_formulas.TESTS.read_text("utf-8")
    stated = re.findall(r'def (test_\w+)\(.*\):\n    """(?:Eq\. |S-)', source)
    rows = paper_formulas.table(source).splitlines()[2:]
    cells = [[cell.strip() for cell in re.split(r"(?<!\\)\|", row)[1:-1]] for row in rows]
    assert [test for *_, test in cells] == [f"`{name}`" for name in stated]
    assert all(place and formula and function for place, formula, function, _ in cells)


def test_every_parameter_of_a_wire_is_listed_with_its_range():
    rows = wire_parameters.table().splitlines()[2:]
    listed = [row.split("|")[1].strip(" `") for row in rows]
    assert listed == [field.name for field in fields(Nanowire)][1:]
    assert rows[2].endswith("| 10 | 0.1 to 100 nm |")
    assert "V_Barrier on the first and on the last site" in rows[6]
    assert "| 15, 15 | -1,000 to 1,000 meV |" in rows[6]


def test_every_target_of_make_that_is_named_exists():
    pages = [*(REPOSITORY / "docs").rglob("*.md"), *REPOSITORY.glob("*.md")]
    named = {
        command for page in pages for command in re.findall(r"`make ([^`<]+)`", page.read_text())
    }
    assert len(named) > 10
    for one in named:
        words = one.replace("figure-NAME", "figure-4").split()
        assert make_exists([word for word in words if word not in ("ONLY=id", "STUDY=NAME")]), one


def test_every_package_has_a_licence_and_none_that_is_needed_is_under_the_gpl():
    """What is under the GPL checks spelling, builds pages, or is compared with in one study."""
    found = licences.licences()
    assert "not stated" not in found
    assert found["GPL"] == ["codespell", "docutils", "iterative-ensemble-smoother"]
    assert sum(map(len, found.values())) > 140


def test_a_function_is_what_the_test_calls_of_the_package():
    table = paper_formulas.table(
        "import numpy as np\n"
        "from disorder_landscape import Nanowire, conductance\n"
        "from disorder_landscape.model import disorder\n"
        "WIRE = Nanowire(np.zeros(3))\n"
        'def test_a():\n    """Eq. S1: a*b."""\n    disorder.kernel(np.zeros(2))\n'
        'def test_b():\n    """S-I: c."""\n    conductance(Nanowire(np.zeros(3)), 0, 0)\n'
        'def test_c():\n    """S-II.1: d."""\n    WIRE.mass\n'
        'def test_d():\n    """Something else."""\n    WIRE.mass\n'
    )
    assert table.splitlines()[2:] == [
        r"| Eq. S1 | a\*b. | `model.disorder.kernel` | `test_a` |",
        "| S-I | c. | {py:obj}`~disorder_landscape.conductance` | `test_b` |",
        "| S-II.1 | d. | {py:obj}`~disorder_landscape.Nanowire` | `test_c` |",
    ]


def test_the_readme_is_one_page():
    assert len(README.splitlines()) <= 120
    assert len(README.split()) <= 900


def test_links_of_the_readme_lead_to_files():
    links = [link for link in re.findall(r"\]\(([^)]*)\)", README) if "://" not in link]
    assert links
    assert [link for link in links if not (REPOSITORY / link).is_file()] == []


def test_each_promise_about_faults_is_held_by_a_test():
    page = (REPOSITORY / "docs" / "faults.md").read_text("utf-8")
    there = {
        name
        for path in (REPOSITORY / "tests").glob("**/test_*.py")
        for name in re.findall(r"^def (test_\w+)", path.read_text("utf-8"), re.MULTILINE)
    }
    named = set(re.findall(r"`(test_\w+)`", page))
    assert len(named) > 15
    assert named <= there
