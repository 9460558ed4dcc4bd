"""Checks of arguments, with messages of one form: "Argument … must …, but …"."""

from __future__ import annotations

from collections.abc import Callable, Collection
from contextlib import suppress

import numpy as np
from numpy.typing import ArrayLike, NDArray

SAME_UNITS = {"T": ("tesla",), "meV": ("mV",)}
"""Other names of units; a bias of 1 mV is 1 meV."""
SHOWN = 100
"""Characters of a value that a message shows."""


class ArgumentError(ValueError):
    """An argument, option or file that cannot be used; its message is one sentence."""

    def __init__(self, name: str, must: str, but: str) -> None:
        said = f"Argument {name} must {must}, but {but}."
        super().__init__(
            " ".join(said.splitlines())
        )  # names and words of files may have line breaks
        self.parts = name, must, but

    def __reduce__(self) -> tuple[type[ArgumentError], tuple[str, str, str]]:
        """Let it come back from a worker process."""
        return ArgumentError, self.parts


def require(condition: bool, name: str, must: str, but: str) -> None:
    """Raise an ArgumentError unless the condition holds."""
    if not condition:
        raise ArgumentError(name, must, but)


def shown(value: object) -> str:
    """Return a value in one short line."""
    try:
        plain = value.item() if isinstance(value, np.generic) else value
        text = " ".join(repr(plain).split())
    except ValueError:  # Python does not write numbers of so many digits
        return "a number of thousands of digits"
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}…"


def reals(name: str, values: ArrayLike, must: str) -> NDArray[np.float64]:
    """Return real numbers as a new array of floats; what is beyond their range is infinite.

    Raises
    ------
    ArgumentError
        If there is anything else: complex numbers, truth values, dates, masked numbers.
    """
    require(not _is_masked(values), name, must, "it holds a masked number")
    with suppress(TypeError, ValueError, OverflowError), np.errstate(over="ignore"):
        given = np.asarray(values)
        is_complex = given.dtype == object and any(np.iscomplexobj(one) for one in given.flat)
        if given.dtype.kind in "fiuOUS" and not is_complex:
            return np.array(given, dtype=np.float64, order="C")
    raise ArgumentError(name, must, "it holds something else")


def _is_masked(values: object) -> bool:
    """Return whether a number is masked, of those in a list of lists too."""
    if isinstance(values, list | tuple):
        return any(map(_is_masked, values))
    return isinstance(values, np.ma.MaskedArray) and bool(np.ma.is_masked(values))


def number_in(name: str, value: object, low: float, high: float, unit: str = "") -> float:
    """Return the value as a float within [low, high].

    Raises
    ------
    ArgumentError
        If the value is not a finite number of that range.
    """
    must = f"be a number from {low:g} to {high:g} {unit}".rstrip()
    try:
        # What is a float needs no array: wires are made by the thousand.
        one = np.float64(value) if type(value) is float else reals(name, value, must)  # type: ignore[arg-type]
    except ArgumentError:
        raise ArgumentError(name, must, f"it is {shown(value)}") from None
    require(one.ndim == 0, name, must, f"it is {shown(value)}")
    require(bool(low <= one <= high), name, must, f"it is {one:g}")
    return float(one)


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
    given = str(getattr(values, "attrs", {}).get("units", unit))  # of xarray
    require(given in (unit, *SAME_UNITS.get(unit, ())), name, must, f"its units are {given}")
    grid = np.atleast_1d(reals(name, values, must))  # contiguous: what the core takes
    require(grid.ndim == 1, name, must, f"it has shape {grid.shape}")
    require(grid.size > 0, name, must, "it is empty")
    require(bool(np.isfinite(grid).all()), name, must, "it holds NaN or infinity")
    twice = grid[1:][grid[1:] == grid[:-1]]
    unsorted = "it is not sorted in increasing order"
    but = f"{twice[0]:.9g} {unit} occurs twice" if twice.size else unsorted
    require(bool((grid[1:] > grid[:-1]).all()), name, must, but)
    for value in (grid[0], grid[-1]):
        within = f"lie between {low:.9g} and {high:.9g} {unit}"
        require(low <= value <= high, name, within, f"it reaches {value:.9g}")
    return grid


def names_in(name: str, given: object, known: Collection[str], must: str) -> list[str]:
    """Return one name, or several, as a list.

    Raises
    ------
    ArgumentError
        If there is none, or one that is not known.
    """
    try:
        asked = [given] if isinstance(given, str) else list(given)  # type: ignore[call-overload]
    except (TypeError, ValueError):  # what has no elements
        asked = [given]
    require(bool(asked), name, must, "there is none")
    for one in asked:
        require(isinstance(one, str) and one in known, name, must, f"one is {shown(one)}")
    return asked


def whether(name: str, value: object) -> bool:
    """Return a truth value, and refuse what may stand for one."""
    require(isinstance(value, bool | np.bool_), name, "be True or False", f"it is {shown(value)}")
    return bool(value)


def check_progress(progress: Callable[..., object] | None) -> None:
    """Raise an ArgumentError unless progress can be reported to this, or to nobody."""
    usable = progress is None or callable(progress)
    require(usable, "progress", "be a function", f"it is {shown(progress)}")
