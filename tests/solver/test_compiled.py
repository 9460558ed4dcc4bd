import ast
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from disorder_landscape import ArgumentError
from disorder_landscape.solver import compiled


def values(count=1003):
    return np.random.default_rng(1).normal(size=count)


@pytest.mark.parametrize("name", compiled.supported())
def test_every_variant_that_the_cpu_has_computes_the_same(name):
    core = compiled.variant(name)
    assert core.instruction_set() == name
    assert core.sum_of_squares(values()) == pytest.approx(values() @ values(), rel=1e-13)


@pytest.mark.parametrize("name", compiled.supported())
def test_the_stub_names_what_every_variant_has(name):
    stub = Path(compiled.__file__).with_name("_core_baseline.pyi")
    stated = {node.name for node in ast.parse(stub.read_text()).body if hasattr(node, "name")}
    assert stated == {function for function in vars(compiled.variant(name)) if function[0] != "_"}


@pytest.mark.parametrize(
    "array", [values(20)[::2], np.ones(3, np.float32), np.ones((2, 2))], ids=["gaps", "32", "2d"]
)
def test_no_array_is_copied_or_converted_unasked(array):
    with pytest.raises(TypeError):
        compiled.core.sum_of_squares(array)


def test_the_fastest_is_chosen(monkeypatch):
    monkeypatch.delenv(compiled.CHOICE, raising=False)
    assert compiled.chosen() == compiled.supported()[-1]


def imported_with(choice):
    code = "from disorder_landscape.solver.compiled import core; print(core.instruction_set())"
    return subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {compiled.CHOICE: choice},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("name", compiled.supported())
def test_the_environment_chooses(name):
    assert imported_with(name).stdout == f"{name}\n"


def test_an_unknown_variant_is_refused_in_one_sentence():
    refused = imported_with("sse9")
    assert refused.stdout == ""
    assert refused.stderr.splitlines()[-1].endswith(
        "ArgumentError: Argument DISORDER_LANDSCAPE_CORE must be one of baseline, avx2, avx512, "
        "but it is 'sse9'."
    )


def test_a_variant_that_the_cpu_lacks_is_refused_in_one_sentence(monkeypatch):
    monkeypatch.setattr(compiled, "supported", lambda: ["baseline", "avx2"])
    monkeypatch.setenv(compiled.CHOICE, "avx512")
    with pytest.raises(ArgumentError) as refused:
        compiled.chosen()
    assert str(refused.value) == (
        "Argument DISORDER_LANDSCAPE_CORE must be what this CPU can run (baseline, avx2), "
        "but it is avx512."
    )


def test_a_core_that_was_not_built_is_said_in_one_sentence():
    with pytest.raises(ImportError, match=r"not built for this Python .* run `make setup`"):
        compiled.variant("neon")
