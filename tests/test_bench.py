"""The benchmark at sizes at which its numbers mean nothing: what it prints and writes."""

import json
import sys

import pytest

from disorder_landscape.bench import measurements, report
from disorder_landscape.cli import main
from disorder_landscape.config import DatasetConfig


def landscape_bench(monkeypatch, *options):
    monkeypatch.setattr(sys, "argv", ["landscape", "bench", *map(str, options)])
    with pytest.raises(SystemExit) as stop:
        main()
    return stop.value.code


@pytest.fixture
def small(monkeypatch):
    tiny = {"sites": 60, "mu_points": 3, "B_points": 3}
    datasets = {
        f"{n} components": DatasetConfig(realizations=8_000, components=n, **tiny) for n in (5, 10)
    }
    for module in (measurements, report):
        monkeypatch.setattr(module, "DATASETS", datasets)
    monkeypatch.setattr(measurements, "WIRES", dict.fromkeys(datasets, 1))
    monkeypatch.setattr(measurements, "LENGTHS", (60, 120))
    monkeypatch.setattr(measurements, "MEMORY", (DatasetConfig(realizations=1, **tiny),))


@pytest.mark.usefixtures("small")
def test_bench_writes_what_it_prints(monkeypatch, capsys, tmp_path):
    folder = tmp_path / "bench"
    assert landscape_bench(monkeypatch, "--repeats", 2, "--output", folder) == 0
    said = capsys.readouterr()
    assert sorted(path.name for path in folder.iterdir()) == [
        "bench.json",
        "bench.png",
        "bench.txt",
    ]
    assert said.out.startswith((folder / "bench.txt").read_text())
    assert "bench: 100%" in said.err
    assert (folder / "bench.png").read_bytes().startswith(b"\x89PNG")
    found = json.loads((folder / "bench.json").read_text())
    assert found["repeats"] == 2
    for name, seconds in found["seconds"].items():
        assert len(seconds) == 2
        assert found["medians"][name] == pytest.approx(sum(seconds) / 2)
    hours = found["core-hours"]["5 components"]
    assert hours["fast"] == pytest.approx(20 * found["medians"]["per set, 5 components"])
    assert hours["paper"] == pytest.approx(20 * 12)
    for of in found["sets"].values():
        assert of["energies"] > 10
        assert of["largest error"] < 1e-3
    assert 50 < found["peak MiB"]["1"] < 5000
    assert set(found["versions"]) >= {"disorder-landscape", "numpy", "kwant"}


def test_a_folder_that_cannot_be_written_is_said_before_measuring(monkeypatch, capsys, tmp_path):
    (tmp_path / "file").write_text("")
    assert landscape_bench(monkeypatch, "--output", tmp_path / "file") == 2
    said = capsys.readouterr()
    assert "Argument output must be a file in a folder that can be written" in said.err
    assert said.out == ""
