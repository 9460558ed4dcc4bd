"""How pictures name a conductance, and in which colours they show it."""

from __future__ import annotations

from typing import Any

LOCAL = ("G_LL", "G_RR")
"""Conductances that are not negative, but for a little."""


def symbol(name: str) -> str:
    """Return the symbol of a conductance."""
    return rf"$G_\mathrm{{{name[2:]}}}$"


def colour_scale(name: str, largest: float) -> dict[str, Any]:
    """Return the colours of a conductance, and their limits: from 0 on, or about it."""
    if name in LOCAL:
        return {"cmap": "viridis", "vmin": 0, "vmax": largest}
    return {"cmap": "RdBu_r", "vmin": -largest, "vmax": largest}
