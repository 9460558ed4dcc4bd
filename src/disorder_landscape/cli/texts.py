"""What the texts of options mean: grids, barriers, angles."""

from __future__ import annotations

import math

import numpy as np

from disorder_landscape.arguments import ArgumentError, number_in, numbers_of
from disorder_landscape.model.parameters import FloatArray


def parse_grid(name: str, text: str) -> FloatArray:
    """Return the grid that "0.3", "0,0.1,0.4" or "start:stop:points" describes.

    Raises
    ------
    ArgumentError
        If the text is something else.
    """
    try:
        if ":" in text:
            start, stop, points = text.split(":")
            with np.errstate(over="ignore", invalid="ignore"):
                return np.linspace(float(start), float(stop), int(points))
        return np.array([float(part) for part in text.split(",")])
    except ValueError:
        must = "be a number, a list like 0,0.1 or a range like start:stop:points"
        raise ArgumentError(name, must, f"it is '{text}'") from None


def parse_barrier(text: str) -> tuple[float, float]:
    """Return the left and the right barrier that "15" or "15,12" describes.

    Raises
    ------
    ArgumentError
        If the text is something else.
    """
    values = numbers_of("barrier", text, (1, 2), "be a number in meV, or two like 15,12")
    return values[0], values[-1]


def radians(theta: float) -> float:
    """Return the angle θ of the field, which is in degrees.

    Raises
    ------
    ArgumentError
        If it is more than a full turn.
    """
    return math.radians(number_in("theta", theta, -360.0, 360.0, "degrees"))
