"""The core in WebAssembly, by its C interface, beside the one that Python calls."""

import base64
import json
import shutil
import subprocess
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import arithmetics
from disorder_landscape import Nanowire
from disorder_landscape.model.parameters import BIAS, BOLTZMANN, TEMPERATURE
from disorder_landscape.runs import REPOSITORY
from disorder_landscape.solver import compiled, variants
from random_wires import random_wire

pytestmark = [
    pytest.mark.skipif(shutil.which("node") is None, reason="needs Node"),
    pytest.mark.skipif(find_spec("ziglang") is None, reason="needs Zig, which `make wasm` fetches"),
]

KT = BOLTZMANN * TEMPERATURE
DONE, INEXACT, BAD_COUNT, NOT_FINITE, BAD_WIRE, BAD_TEMPERATURE, BAD_BIAS = range(7)
RANDOM = [random_wire(seed) for seed in range(25)]


def compile_to(module, sources=REPOSITORY):
    """Compile as `make wasm` does: in five seconds, at the first time in forty."""
    subprocess.run(["sh", "scripts/wasm.sh", module], cwd=sources, check=True)


@pytest.fixture(scope="module")
def wasm(tmp_path_factory):
    module = tmp_path_factory.mktemp("wasm") / "nanowire.wasm"
    compile_to(module)
    return module


def answers_of(module, requests):
    """Return what requests are answered: each a status and arrays, flat."""
    asked, answered = module.with_name("requests.json"), module.with_name("answers.json")
    script = Path(__file__).with_name("wasm_check.mjs")
    asked.write_text(json.dumps(requests))
    subprocess.run(["node", script, module, asked, answered], check=True)
    return [
        (answer["status"], [np.frombuffer(base64.b64decode(x)) for x in answer["results"]])
        for answer in json.loads(answered.read_text())
    ]


def request(function, wires, grids, results, others=()):
    """Return the call of a function for wires at all points of the grids."""
    V, parameters = compiled.handed_over(wires)
    numbers = [part for x in grids for part in (len(x), list(x))]
    arguments = [*V.shape, V.ravel().tolist(), parameters.ravel().tolist(), *numbers, *others]
    return {"function": f"nanowire_{function}", "arguments": arguments, "results": results}


def random_points(rng, energies):
    return rng.uniform(0, 0.6, 2), rng.uniform(0, 0.8, 2), rng.uniform(0, 0.11, energies)


def test_the_module_is_small(wasm):
    assert wasm.stat().st_size < 400_000


def test_1000_conductances_at_zero_temperature_are_those_of_python(wasm):
    """With the variant that rounds as WebAssembly does, which has no multiply-add either."""
    core, rng = variants.variant("baseline"), np.random.default_rng(0)
    requests, expected = [], []
    for wire in RANDOM:
        mu, B, omega = random_points(rng, 5)
        arrays = compiled.handed_over([wire])
        requests.append(request("conductance", [wire], (mu, B, omega), [160]))
        expected.append(core.conductance(*arrays, mu, B, omega, 0.0, compiled.GROWTH_LIMIT))
        requests.append(request("reflection_determinant", [wire], (mu, B), [8]))
        expected.append(compiled.reflection_determinant([wire], mu, B))
    answers = answers_of(wasm, requests)
    assert sum(found.size for _, (found,) in answers[::2]) == 1000 * 4
    for (status, (found,)), same in zip(answers, expected, strict=True):
        assert status == DONE
        assert_allclose(found, same.ravel(), rtol=0, atol=1e-9)


def test_conductances_above_the_gap_and_with_dissipation_are_those_of_python(wasm):
    mu, B, omega = np.array([0.2]), np.array([0.3, 0.5]), np.array([0.05, 0.2, 0.5])
    clean = RANDOM[:2]
    leaky = [Nanowire(w.potential, alpha=w.alpha, dissipation=0.01) for w in clean]
    above = arithmetics.complex_conductance(clean, mu, B, omega[1:])
    below = compiled.bare_conductance(clean, mu, B, omega[:1])
    everywhere = arithmetics.complex_conductance(leaky, mu, B, omega)
    grids = mu, B, omega
    answers = answers_of(
        wasm, [request("conductance", wires, grids, [96]) for wires in (clean, leaky)]
    )
    expected = np.concatenate([below, above], axis=3), everywhere
    for (status, (found,)), same in zip(answers, expected, strict=True):
        assert status == DONE
        assert_allclose(found, same.ravel(), rtol=0, atol=1e-9)


def test_thermal_averages_are_those_of_python_within_their_errors(wasm, averages):
    """To 1e-9 in most: models of few nodes take up rounding, the more the less they are sure."""
    requests, expected = averages
    apart = []
    for (status, (G, error)), (same, same_error, _) in zip(
        answers_of(wasm, requests), expected, strict=True
    ):
        assert status == (DONE if (error <= compiled.core.TOLERANCE).all() else INEXACT)
        difference = abs(G.reshape(4, -1) - same.reshape(4, -1))
        assert (difference.max(axis=1) <= error + same_error.ravel()).all()
        apart.append(difference)
    assert np.size(apart) == 4 * 500
    assert np.median(apart) < 1e-9


def test_the_status_says_how_it_went(wasm):
    V = RANDOM[0].potential
    wire, leaky = RANDOM[0], Nanowire(V, dissipation=0.001)
    leaky_alone = Nanowire(V, dissipation=0.001, parent_dissipation=0.0)  # by quadrature

    def average(wire=wire, bias=(0.0,), kT=KT, tolerance=1e-4):
        grids = [0.2], [0.3], bias
        return request("thermal_conductance", [wire], grids, [4, 1], [kT, tolerance])

    broken = average()
    broken["arguments"][2][7] = "NaN"  # in V
    expected = [
        (average(), DONE),
        (average(tolerance=0.0), INEXACT),
        (average(bias=()), BAD_COUNT),
        (broken, NOT_FINITE),
        (average(leaky), DONE),
        (average(leaky_alone), BAD_WIRE),
        (request("reflection_determinant", [leaky], ([0.2], [0.3]), [2]), BAD_WIRE),
        (average(kT=0.0), BAD_TEMPERATURE),
        (average(bias=(0.12,)), BAD_BIAS),
    ]
    answers = answers_of(wasm, [asked for asked, _ in expected])
    assert [status for status, _ in answers] == [status for _, status in expected]


@pytest.fixture(scope="module")
def averages():
    """Return requests for averages at 100 points, and what Python's core finds.

    A fifth of the wires are broadened.
    """
    rng, requests, expected = np.random.default_rng(1), [], []
    for number, clean in enumerate(RANDOM):
        wire = clean if number % 5 else replace(clean, dissipation=1e-3)
        mu, B, _ = random_points(rng, 0)
        others = [KT, compiled.core.TOLERANCE]
        requests.append(request("thermal_conductance", [wire], (mu, B, BIAS), [80, 4], others))
        expected.append(compiled.thermal_conductance([wire], mu, B, np.array(BIAS), TEMPERATURE))
    return requests, expected


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "limit", "lowered", "some_are_missed"),
    [
        ("poles/iteration.hpp", "ROUNDS = 8", "ROUNDS = 1", True),
        ("poles/tridiagonal.hpp", "SWEEPS = 60", "SWEEPS = 1", True),
        ("poles/starts.hpp", "SWEEPS = 12", "SWEEPS = 0", False),  # the iteration makes up for it
    ],
)
def test_a_search_that_meets_its_limits_says_so(
    tmp_path, averages, file, limit, lowered, some_are_missed
):
    """What is then found is found within its error, or not at all."""
    shutil.copytree(REPOSITORY / "core", tmp_path / "core")
    for name in ("scripts", ".venv"):
        (tmp_path / name).symlink_to(REPOSITORY / name)
    source = tmp_path / "core" / file
    text = source.read_text()
    assert text.count(limit) == 1
    source.write_text(text.replace(limit, lowered))
    module = tmp_path / "nanowire.wasm"
    compile_to(module, tmp_path)
    requests, expected = averages
    answers = answers_of(module, requests)
    missed = 0
    for (status, (G, error)), (same, same_error, _) in zip(answers, expected, strict=True):
        sure = error <= compiled.core.TOLERANCE
        assert status == (DONE if sure.all() else INEXACT)
        difference = abs(G.reshape(4, -1) - same.reshape(4, -1)).max(axis=1)
        assert (difference <= error + same_error.ravel())[sure].all()
        missed += (~sure).sum()
    assert (missed > 0) == some_are_missed
