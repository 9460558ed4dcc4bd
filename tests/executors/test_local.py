"""Processes of a pool: what they return, and that none outlives whoever waits for it."""

import os
import signal
import subprocess
import sys
import time
from multiprocessing import active_children, get_context
from pathlib import Path

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from disorder_landscape import ArgumentError
from disorder_landscape.executors.local import LocalProcesses


def test_every_task_has_its_result():
    assert sorted(LocalProcesses(2).each_result(abs, [-3, 1, -2])) == [1, 2, 3]


def threads_of_linear_algebra(_):
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}


def test_one_process_has_one_thread():
    with threadpool_limits(2, user_api="blas"):
        assert [*LocalProcesses(1).each_result(threads_of_linear_algebra, [0])] == [{1}]


def test_tasks_that_may_be_ended_do_not_keep_whoever_stops(tmp_path):
    others = get_context("spawn").Process(target=time.sleep, args=(600,))
    others.start()
    waited = time.monotonic()
    results = LocalProcesses(2).each_result(time.sleep, [0, 600, 600], may_be_ended=True)
    try:
        next(results)
        results.close()
        assert time.monotonic() - waited < 300
        assert active_children() == [others]
    finally:
        others.terminate()
        others.join()


@pytest.mark.skipif(not Path("/proc/self/cmdline").exists(), reason="asks Linux for processes")
def test_workers_end_with_a_killed_parent(tmp_path):
    """Waits for each condition, however busy the machine, and fails only after minutes."""
    started = tmp_path / "started"
    task = (
        "import os, pathlib, time;"
        f"new = pathlib.Path({str(tmp_path / 'new')!r});"
        f"new.write_text(str(os.getpid())); new.rename({str(started)!r}); time.sleep(600)"
    )
    script = (
        "from disorder_landscape.executors.local import LocalProcesses;"
        f"list(LocalProcesses(2).each_result(exec, [{task!r}]))"
    )
    parent = subprocess.Popen([sys.executable, "-c", script])

    def goes_on():
        """Whether the worker is there; of one that has ended nothing but its entry may be left."""
        try:
            return b"spawn_main" in Path(f"/proc/{started.read_text()}/cmdline").read_bytes()
        except FileNotFoundError:
            return False

    try:
        wait_for(started.exists)
        assert goes_on()
    finally:
        parent.kill()
        parent.wait()
    wait_for(lambda: not goes_on())


def killed_at_two(number):
    """Do what the system does to a process where memory runs out."""
    if number == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def test_a_killed_worker_is_one_sentence():
    with pytest.raises(ArgumentError, match="one of 2 was killed, as the system does where memory"):
        list(LocalProcesses(2).each_result(killed_at_two, [1, 2, 3]))


def wait_for(condition, seconds=180):
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.05)
