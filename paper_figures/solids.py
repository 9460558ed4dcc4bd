"""Boxes in oblique projection, for the sketches of the network and of the device."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.colors import to_rgb

DEPTH = (0.45, 0.32)
"""Shift on paper of a unit of depth, to the right and up."""


def draw_box(
    axes: Axes,
    corner: tuple[float, float],
    size: tuple[float, float, float],
    colour: str,
    alpha: float = 1.0,
    zorder: float = 2.0,
) -> None:
    """Draw a box seen from the front, right and above.

    Parameters
    ----------
    axes : Axes
        With equal units along x and y.
    corner : (x, y)
        Lower left corner of the front.
    size : (width, height, depth)
    colour : str
        Of the front; the top is lighter and the side darker.
    alpha, zorder : float
        As for patches.
    """
    (x, y), (w, h, d) = corner, size
    dx, dy = DEPTH[0] * d, DEPTH[1] * d
    front = [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
    top = [(x, y + h), (x + w, y + h), (x + w + dx, y + h + dy), (x + dx, y + h + dy)]
    side = [(x + w, y), (x + w, y + h), (x + w + dx, y + h + dy), (x + w + dx, y + dy)]
    for face, light in ((front, 0.0), (top, 0.45), (side, -0.22)):
        axes.fill(
            *zip(*face, strict=True),
            facecolor=_shaded(colour, light),
            edgecolor="k",
            lw=0.5,
            alpha=alpha,
            zorder=zorder,
            joinstyle="round",
        )


def _shaded(colour: str, light: float) -> tuple[float, ...]:
    """Mix a colour with white (light > 0) or with black (light < 0)."""
    target = 1.0 if light > 0 else 0.0
    return tuple(c + (target - c) * abs(light) for c in to_rgb(colour))
