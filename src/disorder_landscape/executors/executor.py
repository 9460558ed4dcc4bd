"""What an executor must offer, and the share of the tasks that one job of many takes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

from disorder_landscape.arguments import ArgumentError, require

Task = TypeVar("Task")
Result = TypeVar("Result")


class Executor(Protocol):
    """Carries tasks out, several at a time."""

    @property
    def at_a_time(self) -> int:
        """How many tasks are carried out at a time."""

    def each_result(
        self,
        function: Callable[[Task], Result],
        tasks: Iterable[Task],
        may_be_ended: bool = False,
    ) -> Iterator[Result]:
        """Yield what a function returns for each task, as soon as it is there, in any order.

        Whoever stops listening, or is interrupted, waits only for the tasks that are in hand; not
        even for those where they may be ended at any moment, since they go on later from where they
        were.
        """


@dataclass(frozen=True)
class Share:
    """Every so many-th task, for one of several jobs that share all of them out.

    It depends on nothing but the order of all tasks, whichever are done: jobs need not know of each
    other.

    Parameters
    ----------
    number : int
        From 1.
    count : int
        How many shares there are.
    """

    number: int = 1
    count: int = 1

    def of(self, tasks: Sequence[Task]) -> Sequence[Task]:
        """Return the tasks of this share."""
        return tasks[self.number - 1 :: self.count]

    @property
    def is_whole(self) -> bool:
        """Whether it is all tasks."""
        return self.count == 1


WHOLE = Share()


def parse_share(text: str) -> Share:
    """Return the share that "3/8" describes.

    Raises
    ------
    ArgumentError
        If the text is something else.
    """
    must = "be like 3/8, the third of eight shares"
    found = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text)
    if found is None:
        raise ArgumentError("share", must, f"it is '{text}'")
    number, count = map(int, found.groups())
    require(1 <= number <= count, "share", must, f"it is '{text}'")
    return Share(number, count)
