"""The study of accuracy, of a few wires."""

import json
import sys
from concurrent.futures import Future
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "results"))  # as if run as a script

import accuracy


@pytest.fixture(scope="module")
def measured():
    """Return six short wires, the first of them integrated more finely."""
    rows = [accuracy.measure(accuracy.random_case(i, sites=80), finer=i == 0) for i in range(6)]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def test_cases_are_drawn_from_their_index():
    cases = [accuracy.random_case(i) for i in range(60)]
    assert {case.kind for case in cases} == set(range(len(accuracy.KINDS)))
    assert {case.temperature for case in cases} == set(accuracy.TEMPERATURES)
    assert [i for i, case in enumerate(cases) if case.B == 0] == list(range(0, 60, 10))
    again = accuracy.random_case(7)
    np.testing.assert_array_equal(again.wire.potential, cases[7].wire.potential)
    np.testing.assert_array_equal(again.bias, cases[7].bias)
    pristine = next(case for case in cases if case.kind == 0)
    assert not pristine.wire.potential.any()


def test_a_few_wires_keep_the_bounds(measured):
    numbers = accuracy.summary(measured)
    assert numbers["passed"]
    assert numbers["wires"] == 6
    assert numbers["conductances"] == 6 * accuracy.BIASES * 4
    assert numbers["brute_force"]["wires_integrated_finer"] == 1
    assert numbers["brute_force"]["largest_difference_from_finer"] < 3e-5
    kinds = dict(numbers["kinds"])
    whole = kinds.pop("all")
    for name in ("sets", "sets_with_quadrature", "sets_with_error_above_estimate"):
        assert sum(group[name] for group in kinds.values()) == whole[name]
    assert sum(whole["sets_by_energies"].values()) + whole["sets_with_quadrature"] == 6


@pytest.mark.parametrize("index", [647, 1483])
def test_the_worst_cases(index):
    """647: two poles just off the imaginary axis; 1483: a level at 0.03 µeV, its b of no sign."""
    case = accuracy.measure(accuracy.random_case(index), finer=False)
    assert case["error"].max() <= case["estimate"] + case["brute"]


@pytest.mark.parametrize("wrong", [2e-3, np.nan])
def test_an_error_beyond_the_bounds_fails(measured, wrong):
    error = measured["error"].copy()
    error[3, 2, 1] = wrong
    numbers = accuracy.summary({**measured, "error": error})
    assert not numbers["passed"]
    assert "FAILS" in accuracy.report(numbers, {"seed": "1"})


def test_the_study_is_written_and_goes_on_where_it_stopped(tmp_path, monkeypatch, capsys, measured):
    asked = []

    def make(folder, chunk):
        asked.append(chunk)
        folder.mkdir(parents=True, exist_ok=True)
        np.savez(accuracy._chunk_path(folder, chunk), **measured)
        return 6

    class AtOnce:
        """A pool of one process, this one."""

        def __init__(self, *_):
            pass

        def __enter__(self):
            return self

        def __exit__(self, *_):
            return False

        def submit(self, function, *arguments):
            function(*arguments)
            future = Future()
            future.set_result(6)
            return future

    monkeypatch.setattr(accuracy, "_make_chunk", make)
    monkeypatch.setattr(accuracy, "ProcessPoolExecutor", AtOnce)
    arguments = ["--wires", "6", "--output", str(tmp_path), "--build", str(tmp_path / "chunks")]
    for _ in range(2):
        with pytest.raises(SystemExit) as stop:
            accuracy.main(arguments)
        assert stop.value.code == 0
    assert asked == [0]
    text = (tmp_path / "accuracy.txt").read_text("utf-8")
    assert capsys.readouterr().out == 2 * text
    assert json.loads((tmp_path / "accuracy.json").read_text("utf-8"))["wires"] == 6
    assert (tmp_path / "accuracy.png").stat().st_size > 1000


def test_arguments_that_cannot_be_used(tmp_path, capsys):
    for arguments in (["--wires", "0"], ["--workers", "0"]):
        with pytest.raises(SystemExit) as stop:
            accuracy.main([*arguments, "--output", str(tmp_path)])
        assert stop.value.code == 2
        assert "Argument" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
