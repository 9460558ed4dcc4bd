"""An installation of the simulator alone: what it can do, and which extra it names for the rest."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from disorder_landscape.parts import PARTS, MissingPartError, needs

REPOSITORY = Path(__file__).parents[1]
DISTRIBUTIONS = {
    "flint": "python-flint",
    "iterative_ensemble_smoother": "iterative-ensemble-smoother",
    "sklearn": "scikit-learn",
    "tensorflow": "tensorflow-cpu",
}
ALL = sorted({module for modules in PARTS.values() for module in modules})

PRELUDE = """
import contextlib, io, json, sys
from importlib.machinery import PathFinder

class Without(PathFinder):
    missing = set(json.loads(sys.argv[1]))

    @classmethod
    def find_spec(cls, name, path=None, target=None):
        return None if name in cls.missing else super().find_spec(name, path, target)

sys.meta_path[:] = [Without if finder is PathFinder else finder for finder in sys.meta_path]
import disorder_landscape as dl
from disorder_landscape.cli import main
"""


def without(modules, script, *arguments):
    """Return what the script prints in a process where these modules are not installed."""
    command = [sys.executable, "-c", PRELUDE + script, json.dumps(modules), *arguments]
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


COMMANDS = """
said = []
for arguments in json.loads(sys.argv[2]):
    sys.argv[1:] = arguments
    with contextlib.redirect_stderr(io.StringIO()) as err:
        try:
            main()
        except SystemExit as stop:
            said.append([stop.code, err.getvalue()])
print(json.dumps(said))
"""


def commands_without(modules, *commands):
    """Return exit code and standard error of each command."""
    out = without(modules, COMMANDS, json.dumps([c.split() for c in commands]))
    return json.loads(out.splitlines()[-1])


def sentence(name, extra):
    return f"{name} is missing: pip install 'disorder-landscape[{extra}]'"


def test_the_simulator_needs_none_of_the_parts(tmp_path):
    output = tmp_path / "wire.nc"
    simulate = f"simulate --sites 30 --B 0:0.8:5 --bias 0 --theta 30 -o {output}"
    status = f"status -c {REPOSITORY}/configs/smoke.toml --build {tmp_path}"
    assert commands_without(ALL, simulate, status) == [[0, ""]] * 2
    assert output.exists()


def test_each_command_names_the_extra_that_it_needs(tmp_path):
    config = REPOSITORY / "configs" / "smoke.toml"
    simulate = f"simulate --sites 30 --B 0.3 --bias 0 -o {tmp_path}/wire.nc"
    expected = {
        f"{simulate} --solver kwant": ("Kwant", "kwant"),
        f"{simulate} --plot {tmp_path}/wire.png": ("Matplotlib", "figures"),
        f"train -c {config} --build {tmp_path}": ("scikit-learn", "learning"),
        f"evaluate -c {config} --build {tmp_path}": ("scikit-learn", "learning"),
        "predict wire.nc --model model -o Y.nc": ("scikit-learn", "learning"),
        "infer wire.nc --model model -o found.nc": ("scikit-learn", "inference"),
        "verify Y.nc other.nc": ("scikit-learn", "inference"),
        f"study learning_curves --build {tmp_path} -o {tmp_path}": ("scikit-learn", "learning"),
        "bench": ("Kwant", "kwant"),
    }
    said = commands_without(ALL, *expected)
    assert said == [[2, f"landscape: {sentence(*missing)}\n"] for missing in expected.values()]


def test_calls_name_the_extra_that_they_need():
    script = """
wire = dl.Nanowire([0.0] * 30)
calls = [
    lambda: dl.conductance(wire, 0, 0.3, 0, solver="kwant"),
    lambda: dl.topological_visibility(wire, 0, 0.3, solver="kwant"),
    lambda: dl.infer,
    lambda: dl.predict,
]
dl.verify, dl.without_series_resistance  # need none
for call in calls:
    try:
        call()
    except dl.MissingPartError as error:
        print(error)
"""
    assert without(ALL, script).splitlines() == [
        sentence("Kwant", "kwant"),
        sentence("Kwant", "kwant"),
        sentence("scikit-learn", "inference"),
        sentence("scikit-learn", "learning"),
    ]


@pytest.mark.parametrize(("missing", "name"), [("keras", "Keras"), ("tensorflow", "TensorFlow")])
def test_inference_starts_from_a_guess_with_the_part_for_learning_only(missing, name):
    script = """
from disorder_landscape.learning.backend import import_keras
dl.infer, dl.predict, dl.verify
try:
    import_keras()
except dl.MissingPartError as error:
    print(error)
"""
    others = [module for module in ALL if module not in PARTS["inference"] and module != "keras"]
    assert without([*others, missing], script) == sentence(name, "learning") + "\n"


def test_tab_completes_what_is_imported_later_too():
    script = """
names = dir(dl)
print(names == sorted(dl.__all__), {"infer", "Prior", "verify"} <= set(names))
"""
    assert without([], script) == "True True\n"


def test_what_no_extra_brings_stays_as_it_is():
    with pytest.raises(ModuleNotFoundError, match="no_such_module"), needs("learning"):
        import no_such_module  # noqa: F401
    with pytest.raises(ValueError, match="something else"), needs("kwant"):
        raise ValueError("something else")


def test_an_extra_that_does_not_bring_the_package_is_not_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "kwant", None)
    with pytest.raises(MissingPartError, match=r"Kwant is missing: .*\[kwant\]"), needs("learning"):
        import kwant  # noqa: F401


def test_the_parts_are_the_extras():
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    assert set(extras) == set(PARTS)
    brought = {
        name: {DISTRIBUTIONS.get(module, module) for module in modules}
        for name, modules in PARTS.items()
    }
    dev = extras.pop("dev")
    assert brought.pop("dev") <= set(dev)
    for name, packages in extras.items():
        assert set(packages) == brought[name]
        assert not set(packages) & set(project["dependencies"])
    assert f"disorder-landscape[{','.join(sorted(brought))}]" in dev
