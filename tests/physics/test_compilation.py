"""No process that computes compiles, so that all of them get the same bits."""

import fcntl
import os
import subprocess
import sys
import threading
import time

import pytest

from disorder_landscape.physics import compilation

KERNELS = """
import hashlib, pkgutil, sys
from importlib import import_module
import numpy as np
from numba.core.dispatcher import Dispatcher
import disorder_landscape as dl
from disorder_landscape import physics

def conductances(temperature):
    rng = np.random.default_rng(5)
    wires = [dl.Nanowire(rng.normal(0, 0.3, 100)) for _ in range(8)]
    bias = np.array([-0.04, 0.0, 0.02])
    bias.setflags(write=False)
    G = dl.conductance(wires, np.linspace(0.6, 0, 6)[::-1], [0.1, 0.5], bias, temperature)
    return hashlib.sha256(G.to_array().to_numpy().tobytes()).hexdigest()

def compiled():
    names = [found.name for found in pkgutil.iter_modules(physics.__path__)]
    modules = [import_module(f"{physics.__name__}.{name}") for name in names]
    kernels = {f for module in modules for f in vars(module).values() if isinstance(f, Dispatcher)}
    return sorted(f.py_func.__name__ for f in kernels if f.stats.cache_misses)
"""
EVERYTHING = """
wire = dl.Nanowire(np.zeros(20), lead_mu=20)
dl.topological_visibility(wire, 0.1, [0.1, 0.3], barrier=False)
dl.conductance_gradient(wire, [0, 1], 0, np.linspace(-0.1, 0.1, 5)[::2])
dl.conductance(wire, 0, 1, 0.11, temperature=1)
dl.conductance([wire] * 2, [0, 0.1], [0, 0.3], 0.0, theta=0.4)
dl.topological_visibility(wire, 0.1, [0.1, 0.3], theta=0.4)
"""


def output_of(script, **environment):
    command = [sys.executable, "-c", KERNELS + script]
    env = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)} | environment
    return subprocess.run(command, env=env, stdout=subprocess.PIPE, text=True, check=True).stdout


def test_nothing_is_compiled_in_a_process_that_computes():
    script = "conductances(0.0), conductances(0.05)" + EVERYTHING + "print(compiled())"
    assert output_of(script).strip() == "[]"


@pytest.mark.slow
def test_the_first_process_gets_the_bits_of_all_others(tmp_path):
    """Whatever they compute first."""
    first = output_of(
        "print(conductances(0.0), conductances(0.05), compiled())", NUMBA_CACHE_DIR=str(tmp_path)
    )
    second = output_of(
        "warm = conductances(0.05); print(conductances(0.0), warm, compiled())",
        NUMBA_CACHE_DIR=str(tmp_path),
    )
    assert first == second
    assert first.endswith("[]\n")


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """A cache folder, empty, and the list of the threads that have called the kernels."""
    calls = []
    monkeypatch.setattr(compilation, "mark", lambda: tmp_path / "source-machine.compiled")
    monkeypatch.setattr(compilation, "call_kernels", lambda: calls.append(threading.get_ident()))
    monkeypatch.setattr(compilation, "_begun", threading.Event())
    return tmp_path, calls


def no_child(*args, **options):
    raise AssertionError("a child was started")


def test_where_the_mark_is_no_child_is_started(cache, monkeypatch):
    folder, calls = cache
    monkeypatch.setattr(subprocess, "run", no_child)
    (folder / "source-machine.compiled").touch()
    compilation.compile_kernels()
    compilation.compile_kernels()
    assert len(calls) == 1


def test_a_cache_that_cannot_be_written_is_no_error(cache, monkeypatch):
    _, calls = cache
    monkeypatch.setattr(subprocess, "run", no_child)
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    compilation.compile_kernels()
    assert len(calls) == 1


def test_a_child_that_fails_is_warned_of(cache, monkeypatch, capsys):
    _, calls = cache
    monkeypatch.setattr(sys, "executable", "false")
    with pytest.warns(UserWarning, match=r"failed \(exit status 1\)"):
        compilation.compile_kernels()
    assert len(calls) == 1
    assert capsys.readouterr().err.count("\n") == 1


def test_the_calls_of_the_kernels_themselves_start_nothing(cache, monkeypatch):
    _, calls = cache

    def call_kernels():
        calls.append(None)
        compilation.compile_kernels()

    monkeypatch.setattr(compilation, "call_kernels", call_kernels)
    compilation.main()
    assert len(calls) == 1


def test_what_was_compiled_from_other_sources_is_deleted(cache):
    folder, _ = cache
    for name in ("a.nbi", "a.1.nbc", "older-machine.compiled", "a.pyc"):
        (folder / name).touch()
    compilation.main()
    left = {path.name for path in folder.iterdir()}
    assert left == {"a.pyc", "compiling.lock", "source-machine.compiled"}


def test_what_was_compiled_for_another_machine_is_kept(cache):
    folder, _ = cache
    before = {"a.nbi", "a.1.nbc", "source-other.compiled"}
    for name in before:
        (folder / name).touch()
    compilation.main()
    assert before < {path.name for path in folder.iterdir()}


def test_of_two_at_once_one_compiles(cache):
    folder, calls = cache
    with open(folder / "compiling.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        threads = [threading.Thread(target=compilation.main) for _ in range(2)]
        for thread in threads:
            thread.start()
        time.sleep(0.2)
        assert not calls
    for thread in threads:
        thread.join()
    assert len(calls) == 1


def test_the_mark_tells_sources_by_content_and_time(tmp_path, monkeypatch):
    monkeypatch.setattr(compilation, "__file__", str(tmp_path / "compilation.py"))
    source = tmp_path / "kernel.py"
    source.write_text("1")
    os.utime(source, (1, 1))
    first = compilation.mark()
    assert compilation.mark() == first
    os.utime(source, (2, 2))
    touched = compilation.mark()
    source.write_text("2")
    os.utime(source, (2, 2))
    edited = compilation.mark()
    assert len({first, touched, edited}) == 3
    assert len({mark.name.partition("-")[2] for mark in (first, touched, edited)}) == 1
