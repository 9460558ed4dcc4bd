"""How long a command will take on this machine, and how far it is."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import count

from tqdm import tqdm

SECOND = 1.0
"""So long a pace is measured, in seconds, …"""
WORTH_SAYING = 5.0
"""… and what takes less than this is not announced."""


def duration(seconds: float) -> str:
    """Return a duration as one says it: "40 seconds", "5 minutes", "2.5 hours"."""
    if seconds < 90:
        return f"{round(seconds)} seconds"
    if seconds < 90 * 60:
        return f"{round(seconds / 60)} minutes"
    return f"{seconds / 3600:.1f} hours"


def announce(what: str, seconds: float, say: Callable[[str], object] = print) -> None:
    """Say how long something will take, unless that is soon over."""
    if seconds >= WORTH_SAYING:
        say(f"{what}: about {duration(seconds)} on this machine")


def announce_repeated(
    what: str,
    action: Callable[[int], object],
    times: float,
    say: Callable[[str], object] = print,
) -> None:
    """Say how long an action will take that is done so many times.

    It is done with 0, which does not count, since it may load what the others need, and then with
    1, 2, … for a second; or with 0 alone, if all of it is soon over.
    """
    begun = time.perf_counter()
    pace = Pace(what, times, say, warm_up=1)
    action(0)
    if (time.perf_counter() - begun) * times < WORTH_SAYING:
        return
    pace.step()
    for done in count(1):
        action(done)
        pace.step()
        if pace.is_known:
            return


@contextmanager
def settings_bar(what: str) -> Iterator[Callable[[int, int], None]]:
    """Show how many of all settings are simulated, if that takes more than a second.

    What is yielded is to be called with the number of those just done, and that of all.
    """
    with tqdm(unit=" settings", delay=1, desc=what) as bar:

        def progress(done: int, in_all: int) -> None:
            bar.total = in_all
            bar.update(done)

        yield progress


class Pace:
    """Announces how long a loop will take, once its first steps have told.

    Parameters
    ----------
    what : str
    total : float
        Of the amounts of all steps.
    say : callable
    warm_up : int
        Steps that do not count: the first compile.
    at_a_time : int
        Steps that are taken side by side. As many must be over, since none tells the rate of all.
    """

    def __init__(
        self,
        what: str,
        total: float,
        say: Callable[[str], object] = print,
        warm_up: int = 2,
        at_a_time: int = 1,
    ) -> None:
        self.what, self.total, self.say = what, total, say
        self.warm_up, self.at_a_time = warm_up, at_a_time
        self._steps, self._done, self.is_known = 0, 0.0, False
        self._begun = time.perf_counter()

    def step(self, amount: float = 1.0) -> None:
        """Count a step that is done."""
        if self.is_known:
            return
        self._steps += 1
        now = time.perf_counter()
        if self._steps <= self.warm_up:
            self._begun = now
            return
        self._done += amount
        if now - self._begun >= SECOND and self._steps >= self.warm_up + self.at_a_time:
            announce(self.what, (now - self._begun) * self.total / self._done, self.say)
            self.is_known = True
