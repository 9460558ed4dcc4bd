"""What a fresh process gets: the bits of every other one, and at once."""

import os
import subprocess
import sys

CONDUCTANCES = """
import hashlib, time
import numpy as np
import disorder_landscape as dl

def conductances(temperature):
    rng = np.random.default_rng(5)
    wires = [dl.Nanowire(rng.normal(0, 0.3, 100)) for _ in range(8)]
    bias = np.array([-0.04, 0.0, 0.02])
    bias.setflags(write=False)
    G = dl.conductance(wires, np.linspace(0.6, 0, 6)[::-1], [0.1, 0.5], bias, temperature)
    return hashlib.sha256(G.to_array().to_numpy().tobytes()).hexdigest()
"""
EVERYTHING = """
started = time.process_time()
wire = dl.Nanowire(np.zeros(20), lead_mu=20)
dl.topological_visibility(wire, 0.1, [0.1, 0.3], barrier=False)
dl.conductance_gradient(wire, [0, 1], 0, np.linspace(-0.1, 0.1, 5)[::2], temperature=0)
dl.conductance(wire, 0, 1, 0.11, temperature=1)
dl.conductance([wire] * 2, [0, 0.1], [0, 0.3], 0.0, theta=0.4)
dl.topological_visibility(wire, 0.1, [0.1, 0.3], theta=0.4)
print(time.process_time() - started)
"""


def output_of(script):
    command = [sys.executable, "-c", CONDUCTANCES + script]
    env = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.run(command, env=env, stdout=subprocess.PIPE, text=True, check=True).stdout


def test_the_first_results_of_a_process_take_no_time():
    """In seconds of the processor, which other loads hardly change; nothing is compiled."""
    assert float(output_of(EVERYTHING)) < 2


def test_every_process_gets_the_same_bits():
    """Whatever it computes first."""
    first = output_of("print(conductances(0.0), conductances(0.05))")
    second = output_of("warm = conductances(0.05); print(conductances(0.0), warm)")
    assert first == second


def test_threads_are_as_many_as_the_cores_that_a_process_may_use():
    """Under `taskset`, say, or where Slurm has given it one of a shared node."""
    one_core = "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\n"
    ask = "from disorder_landscape.solver.compiled import core; print(core.set_threads(1))"
    command = [sys.executable, "-c", one_core + ask]
    env = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    assert subprocess.run(command, env=env, capture_output=True, check=True).stdout == b"1\n"


FEW_THREADS = """
import resource
from disorder_landscape.solver.compiled import core

alone = core.set_threads(1) and conductances(0.05)
core.set_threads(10_000)
used = resource.getpagesize() * int(open("/proc/self/statm").read().split()[0])
resource.setrlimit(resource.RLIMIT_AS, (used + 2**28, resource.RLIM_INFINITY))
print(alone == conductances(0.05))
"""


def test_where_there_are_fewer_threads_than_asked_for_these_do_all():
    """Each has a stack of some megabytes: 96 are more than 256 MB allow."""
    assert output_of(FEW_THREADS) == "True\n"
