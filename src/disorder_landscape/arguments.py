"""Checks of arguments, with messages of one form: "Argument … must …, but …"."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


class ArgumentError(ValueError):
    """An argument, option or file that cannot be used; its message is one sentence."""

    def __init__(self, name: str, must: str, but: str) -> None:
        super().__init__(f"Argument {name} must {must}, but {but}.")
        self.parts = name, must, but

    def __reduce__(self) -> tuple[type[ArgumentError], tuple[str, str, str]]:
        """Let it come back from a worker process."""
        return ArgumentError, self.parts


def require(condition: bool, name: str, must: str, but: str) -> None:
    """Raise an ArgumentError unless the condition holds."""
    if not condition:
        raise ArgumentError(name, must, but)


def number_in(name: str, value: object, low: float, high: float, unit: str = "") -> float:
    """Return the value as a float within [low, high].

    Raises
    ------
    ArgumentError
        If the value is not a finite number of that range.
    """
    must = f"be a number from {low:g} to {high:g} {unit}".rstrip()
    require(not isinstance(value, bool | np.bool_), name, must, f"it is {value}")
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(name, must, f"it is {value!r}") from None
    require(low <= number <= high, name, must, f"it is {number:g}")
    return number


def whole_number_in(name: str, value: object, low: int, high: int) -> int:
    """Return the value as an int within [low, high].

    Raises
    ------
    ArgumentError
        If the value is not a whole number of that range.
    """
    number = number_in(name, value, low, high)
    require(number.is_integer(), name, "be a whole number", f"it is {number:g}")
    return int(number)


def numbers_of(name: str, text: str, counts: tuple[int, ...], must: str) -> list[float]:
    """Return the numbers that a text like "15,12" lists.

    Raises
    ------
    ArgumentError
        If it lists something else, or none of these counts of numbers.
    """
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    require(len(values) in counts, name, must, f"it is '{text}'")
    return values


def grid_in(
    name: str, values: ArrayLike, low: float, high: float, unit: str
) -> NDArray[np.float64]:
    """Return a scalar or a vector as a strictly increasing vector within [low, high].

    Raises
    ------
    ArgumentError
        If the grid is empty, not one-dimensional, not numeric, unsorted or out of range.
    """
    must = f"be a number or an increasing list of numbers in {unit}"
    try:
        # a copy, contiguous: what the core takes
        grid = np.array(values, dtype=np.float64, order="C", ndmin=1)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(name, must, "it holds something else") from None
    require(grid.ndim == 1, name, must, f"it has shape {grid.shape}")
    require(grid.size > 0, name, must, "it is empty")
    require(bool(np.isfinite(grid).all()), name, must, "it holds NaN or infinity")
    require(bool((np.diff(grid) > 0).all()), name, must, "it is not sorted in increasing order")
    for value in (grid[0], grid[-1]):
        within = f"lie between {low:.6g} and {high:.6g} {unit}"
        require(low <= value <= high, name, within, f"it reaches {value:.6g}")
    return grid
