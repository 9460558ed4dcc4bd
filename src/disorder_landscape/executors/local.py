"""Many tasks over a few processes, one thread each."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import active_children, get_context, parent_process
from typing import TypeVar

Task = TypeVar("Task")
Result = TypeVar("Result")
THREADS = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "TF_NUM_INTRAOP_THREADS",
    "TF_NUM_INTEROP_THREADS",
)
"""What tells libraries that are not imported yet how many threads they may have."""


def each_result(
    function: Callable[[Task], Result],
    tasks: Iterable[Task],
    workers: int,
    may_be_ended: bool = False,
) -> Iterator[Result]:
    """Yield what a function returns for each task, as soon as it is there, in any order.

    Whoever stops listening, or is interrupted, waits only for the tasks that are in hand; not even
    for those where they may be ended at any moment, since they go on later from where they were.
    """
    before = set(active_children())
    with ProcessPoolExecutor(workers, get_context("spawn"), _start_worker) as pool:
        futures = [pool.submit(function, task) for task in tasks]
        try:
            for future in as_completed(futures):
                yield future.result()
        except BaseException:
            if may_be_ended:
                for worker in set(active_children()) - before:
                    worker.terminate()
            pool.shutdown(cancel_futures=True)
            raise


def _start_worker() -> None:
    """Keep a worker to one thread, and leave Ctrl-C to the process that waits for it."""
    from disorder_landscape.solver.compiled import core

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    core.set_threads(1)
    os.environ.update(dict.fromkeys(THREADS, "1"))
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """End this worker if the process that waits for it has been killed."""
    parent = parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)
