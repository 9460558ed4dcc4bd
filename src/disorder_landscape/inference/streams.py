"""The parts of an inversion that draw random numbers of their own."""

from __future__ import annotations

from enum import IntEnum


class Stream(IntEnum):
    """The second number of a seed, which for attempts is 0, 1 and so on."""

    GUESS = 2**31
    """Wires on which the network's error is measured."""
    SAMPLES = 2**31 + 1
    """Of a result."""
    IMPORTANCE_SAMPLES = 2**31 + 2
    SEARCH = 2**31 + 3
    """Which data come first; ways to a whole landscape."""
    DISCREPANCY = 2**31 + 4
    """Importance samples of the best effort."""
    MORE_STARTS = 2**31 + 5
