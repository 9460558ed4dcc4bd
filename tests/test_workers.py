"""Processes of a pool: what they return, and that none outlives whoever waits for it."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

from disorder_landscape.workers import each_result


def test_every_task_has_its_result():
    assert sorted(each_result(abs, [-3, 1, -2], 2)) == [1, 2, 3]


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="asks Linux for the children")
def test_workers_end_with_a_killed_parent():
    script = (
        "import time; from disorder_landscape.workers import each_result;"
        "list(each_result(time.sleep, [300], 1))"
    )
    parent = subprocess.Popen([sys.executable, "-c", script])
    listed = Path(f"/proc/{parent.pid}/task/{parent.pid}/children")

    def sleeps(process):
        """Whether it is the worker, which has imported what it needs, and not the tracker."""
        status = Path(f"/proc/{process}/status")
        return status.exists() and b"spawn_main" in Path(f"/proc/{process}/cmdline").read_bytes()

    try:
        workers = []
        for _ in range(300):
            workers = [child for child in listed.read_text().split() if sleeps(child)]
            if workers:
                break
            time.sleep(0.1)
        time.sleep(3)
    finally:
        parent.kill()
        parent.wait()
    assert workers
    for _ in range(100):
        if not any(map(sleeps, workers)):
            return
        time.sleep(0.1)
    pytest.fail("a worker goes on")
