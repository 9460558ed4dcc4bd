"""Notebooks run from the first cell to the last, from the repository's root."""

import sys
from pathlib import Path

import jupytext
import pytest
from matplotlib import pyplot as plt

from disorder_landscape.runs import REPOSITORY

sys.path.insert(0, str(REPOSITORY / "report"))  # as if run as a script

from build import run_cells


@pytest.mark.parametrize(
    "path", sorted((REPOSITORY / "notebooks").glob("*.py")), ids=lambda p: p.stem
)
def test_notebook(path: Path, monkeypatch, capsys):
    monkeypatch.chdir(REPOSITORY)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    run_cells(jupytext.read(path), {})
    assert len(plt.get_fignums()) == 2  # left open, so that a notebook shows them
    plt.close("all")
    said = capsys.readouterr().out
    assert "\nconverged after" in f"\n{said}"
    assert "all samples agree at" in said
    off = {
        line.split(":")[0]: float(line.split()[4]) for line in said.splitlines() if "off by" in line
    }
    assert off["inversion"] < 5.0 < 8.0 < off["network"]
