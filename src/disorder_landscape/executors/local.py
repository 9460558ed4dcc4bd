"""Many tasks over a few processes, one thread each."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import active_children, get_context, parent_process

from threadpoolctl import threadpool_limits

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.executors.executor import Result, Task
from disorder_landscape.machine import cores
from disorder_landscape.solver.compiled import core, threads_at_work

THREADS = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "TF_NUM_INTRAOP_THREADS",
    "TF_NUM_INTEROP_THREADS",
)
"""What tells libraries that are not imported yet how many threads they may have."""


@contextmanager
def in_one_thread() -> Iterator[None]:
    """Keep the core and linear algebra to one thread, as all tasks are."""
    with threads_at_work(1), threadpool_limits(1, user_api="blas"):
        yield


@dataclass(frozen=True)
class LocalProcesses:
    """An executor: processes of this machine, one thread each; a single one is this process.

    Parameters
    ----------
    workers : int
    """

    workers: int = 1

    @property
    def at_a_time(self) -> int:
        """How many tasks are carried out at a time."""
        return min(self.workers, cores())

    def each_result(
        self,
        function: Callable[[Task], Result],
        tasks: Iterable[Task],
        may_be_ended: bool = False,
    ) -> Iterator[Result]:
        """Yield what a function returns for each task (`Executor.each_result`).

        Raises
        ------
        ArgumentError
            If a worker was killed: all others end with it.
        """
        if self.workers == 1:
            with in_one_thread():
                yield from map(function, tasks)
            return
        before = set(active_children())
        with ProcessPoolExecutor(self.workers, get_context("spawn"), _start_worker) as pool:
            futures = [pool.submit(function, task) for task in tasks]
            try:
                for future in as_completed(futures):
                    yield future.result()
            except BrokenProcessPool:
                must = "be so many that their memory suffices"
                but = f"one of {self.workers} was killed, as the system does where memory runs out"
                raise ArgumentError("workers", must, but) from None
            except BaseException:
                if may_be_ended:
                    for worker in set(active_children()) - before:
                        worker.terminate()
                pool.shutdown(cancel_futures=True)
                raise


IN_THIS_PROCESS = LocalProcesses(1)


def _start_worker() -> None:
    """Keep a worker to one thread, and leave Ctrl-C to the process that waits for it."""
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
