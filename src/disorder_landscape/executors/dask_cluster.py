"""A Dask cluster that runs already, under whatever scheduler: its address is all that is needed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.executors.executor import Result, Task
from disorder_landscape.executors.local import in_one_thread
from disorder_landscape.parts import needs

ANSWERS_WITHIN = 30
"""Seconds in which the scheduler must answer."""


@dataclass(frozen=True)
class DaskCluster:
    """An executor: the workers of a Dask cluster, which see the same files.

    A task whose worker is lost is given to another one. Dask's own protocol carries Python objects
    (pickles): the cluster must be closed to strangers, or use TLS (docs/cluster.md).

    Parameters
    ----------
    address : str
        Of the scheduler, as in tcp://10.0.0.1:8786.
    """

    address: str

    @property
    def at_a_time(self) -> int:
        """How many tasks are carried out at a time."""
        with self._client() as client:
            return max(1, sum(map(int, client.nthreads().values())))

    def require_answer(self) -> None:
        """Raise an ArgumentError if no scheduler answers at the address."""
        with self._client():
            pass

    def each_result(
        self,
        function: Callable[[Task], Result],
        tasks: Iterable[Task],
        may_be_ended: bool = False,
    ) -> Iterator[Result]:
        """Yield what a function returns for each task (`Executor.each_result`)."""
        with self._client() as client:
            from distributed import as_completed

            futures = client.map(partial(_by_itself, function), list(tasks), pure=False)
            try:
                for future in as_completed(futures, loop=client.loop):
                    yield future.result()
            finally:
                client.cancel(futures)

    def _client(self) -> Any:
        """Return a new connection to the scheduler, a context manager."""
        with needs("cluster"):
            from distributed import Client
        try:
            return Client(self.address, timeout=ANSWERS_WITHIN, set_as_default=False)
        except (OSError, ValueError) as error:
            must = "be the address of a Dask scheduler that answers"
            reason = str(error).splitlines()[0]
            raise ArgumentError("scheduler", must, f"'{self.address}': {reason}") from None


def _by_itself(function: Callable[[Task], Result], task: Task) -> Result:
    """Carry a task out on a worker as anywhere else, in one thread.

    Otherwise each of the workers, of which there is one for each core, takes all cores; and xarray,
    which notices where it is, asks the scheduler for a lock on every file.
    """
    import dask

    with dask.config.set(scheduler="synchronous"), in_one_thread():
        return function(task)
