import ast
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from disorder_landscape import ArgumentError, Nanowire
from disorder_landscape.model.parameters import BIAS, BOLTZMANN, TEMPERATURE
from disorder_landscape.solver import compiled, variants


def on_a_grid(core):
    """Return everything that a variant computes, of random wires at random points."""
    rng = np.random.default_rng(1)
    wires = [Nanowire(rng.normal(0, 0.3, 300), alpha=a) for a in (2.0, 8.0, 20.0)]
    arrays, kT = compiled.handed_over(wires), BOLTZMANN * TEMPERATURE
    mu, B, omega = rng.uniform(0, 0.6, 5), rng.uniform(-0.1, 0.8, 3), rng.uniform(0, 0.11, 7)
    return [
        core.conductance(*arrays, mu, B, omega, 0.0, compiled.GROWTH_LIMIT),
        core.conductance(*arrays, mu, B, omega, 0.0, 0.0),  # pivoted
        core.conductance(*arrays, mu, B, 5 * omega, 0.0, compiled.GROWTH_LIMIT),
        core.internals.complex_conductance(*arrays, mu, B, omega, 0.0, compiled.GROWTH_LIMIT),
        core.reflection_determinant(*arrays, mu, B, 0.0, compiled.GROWTH_LIMIT),
        *core.thermal_conductance(
            *arrays, mu, B, np.array(BIAS), kT, core.TOLERANCE, compiled.GROWTH_LIMIT
        ),
    ]


@pytest.mark.parametrize("name", variants.supported())
def test_every_variant_that_the_cpu_has_computes_the_same(name):
    core = variants.variant(name)
    assert core.instruction_set() == name
    *bare, G, error, _ = on_a_grid(core)
    *expected, expected_G, expected_error, _ = on_a_grid(compiled.core)
    for found, same in zip(bare, expected, strict=True):
        assert_allclose(found, same, rtol=0, atol=1e-7)
    assert (abs(G - expected_G).max(axis=(-1, -2)) <= error + expected_error).all()


@pytest.mark.skipif("avx512" not in variants.supported(), reason="needs a CPU with AVX-512")
def test_variants_with_multiply_adds_give_the_same_bits():
    both = (on_a_grid(variants.variant(name)) for name in ("avx2", "avx512"))
    for one, other in zip(*both, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("name", variants.supported())
def test_the_stub_names_what_every_variant_has(name):
    stub = Path(compiled.__file__).with_name("_core_baseline.pyi")
    body = ast.parse(stub.read_text()).body
    stated = {node.name for node in body if isinstance(node, ast.FunctionDef)}
    stated |= {ast.unparse(node.target) for node in body if isinstance(node, ast.AnnAssign)}
    assert stated == {given for given in vars(variants.variant(name)) if given[0] != "_"}


def test_the_fastest_is_chosen(monkeypatch):
    monkeypatch.delenv(variants.CHOICE, raising=False)
    assert variants.chosen() == variants.supported()[-1]


def imported_with(choice):
    code = "from disorder_landscape.solver.compiled import core; print(core.instruction_set())"
    return subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {variants.CHOICE: choice},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("name", variants.supported())
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
    monkeypatch.setattr(variants, "supported", lambda: ["baseline", "avx2"])
    monkeypatch.setenv(variants.CHOICE, "avx512")
    with pytest.raises(ArgumentError) as refused:
        variants.chosen()
    assert str(refused.value) == (
        "Argument DISORDER_LANDSCAPE_CORE must be what this CPU can run (baseline, avx2), "
        "but it is avx512."
    )


def test_a_core_that_was_not_built_is_said_in_one_sentence():
    with pytest.raises(ImportError, match=r"not built for this Python .* run `make setup`"):
        variants.variant("neon")


def test_a_level_of_a_closed_wire_reflects_nothing_that_comes_in():
    """Of a wire whose leads have no open channel, at a level to the last digit: M is singular."""
    wire = Nanowire(
        np.array([-2.2, 0.05]), alpha=0.0, gamma=0.0, barrier=(0, 0), mass=0.3, lead_mu=25.0
    )
    mu, zero = np.array([-0.1595866250045771]), np.zeros(1)
    assert (compiled.reflection_determinant([wire], mu, zero) == 1).all()
    assert (compiled.bare_conductance([wire], mu, zero, zero) == 0).all()
