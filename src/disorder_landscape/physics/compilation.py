"""The kernels are compiled by a process of its own, so that every process runs the same code.

Numba compiles a kernel on its first call and keeps it in a cache. Each kernel holds copies of the
functions that it calls, each optimised for its place; of copies of one function a process uses the
one that was loaded first. With `fastmath` two copies may differ in the last digits, and so did the
results of a process that compiled, function by function, from those of one that found the kernels
in the cache. Hence no process that computes compiles: a child does, and then every process loads
all kernels, in one order.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import subprocess
import sys
import threading
import warnings
from importlib.metadata import version
from pathlib import Path

import numba as nb
import numpy as np
from numba.core.registry import cpu_target

from disorder_landscape.physics.leads import fill_self_energies
from disorder_landscape.physics.parameters import TEMPERATURE, Nanowire

_turn = threading.RLock()
_begun = threading.Event()


def compile_kernels() -> None:
    """Compile what is not in the cache, and load all kernels; done once in a process.

    Every function that calls a kernel calls this first. Where the cache cannot be written, or the
    child fails, which is warned of, this process compiles for itself.
    """
    with _turn:  # other threads wait; the calls that `call_kernels` makes come back here
        if _begun.is_set() or nb.config.DISABLE_JIT:
            return
        done = mark()
        if not done.exists() and os.access(done.parent, os.W_OK):
            _start_child()
        _begun.set()
        call_kernels()


def _start_child() -> None:
    """Run `main` in a process that finds the same modules."""
    print("Compiling the solver for this machine, once: about two minutes.", file=sys.stderr)
    child = subprocess.run(
        [sys.executable, "-P", "-c", f"from {__name__} import main; main()"],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    if child.returncode:
        reason = child.stderr.strip().splitlines()[-1:] or [f"exit status {child.returncode}"]
        message = f"Compiling the solver in a process of its own failed ({reason[0]})"
        warnings.warn(f"{message}: the last digits of results may differ.", stacklevel=4)


def main() -> None:
    """Compile all kernels into the cache and leave a mark there, unless another process has."""
    _begun.set()
    done = mark()
    with open(done.with_name("compiling.lock"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if done.exists():
            return
        # Numba does not notice a change in a function of another file that a kernel holds a copy of
        if not any(done.parent.glob(f"{done.name.partition('-')[0]}-*.compiled")):
            for pattern in ("*.nbi", "*.nbc", "*.compiled"):
                for stale in done.parent.glob(pattern):
                    stale.unlink()
        call_kernels()
        done.touch()


def mark() -> Path:
    """Return the file in Numba's cache that is there if all kernels are: SOURCE-MACHINE.compiled.

    Like Numba, it takes a source file for another one if only its time has changed.
    """
    source, machine = hashlib.sha256(), hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        source.update(path.read_bytes())
        source.update(str(path.stat().st_mtime).encode())
    cpu = cpu_target.target_context.codegen().magic_tuple()  # by which Numba tells them apart
    machine.update(repr((cpu, version("numba"), version("llvmlite"), sys.version)).encode())
    name = f"{source.hexdigest()[:16]}-{machine.hexdigest()[:16]}.compiled"
    return Path(fill_self_energies.stats.cache_path, name)


def call_kernels() -> None:
    """Call every kernel on a short wire, with the types of arguments that it always gets."""
    from disorder_landscape.physics.finite_temperature import thermal_conductance

    wire, mu, B, bias = Nanowire(np.zeros(8)), np.zeros(1), np.zeros(1), np.zeros(1)
    thermal_conductance([wire], mu, B, bias, TEMPERATURE)
