"""How pictures name quantities, and in which colours they show them."""

from __future__ import annotations

from typing import Any

from disorder_landscape.model.quantities import QUANTITIES

LOCAL = ("G_LL", "G_RR")
"""Conductances that are not negative, but for a little."""
AXIS_SYMBOLS = {"mu": r"$\mu$", "B": "$B$", "bias": r"$V_\mathrm{bias}$"}
T_IV_SYMBOL = r"$T_\mathrm{IV}$"
LOCAL_COLOURS, NONLOCAL_COLOURS, T_IV_COLOURS = "viridis", "RdBu_r", "PuOr"
"""Maps of colours. Where T_IV is negative, topological, it is orange."""
TOPOLOGICAL_COLOURS = "Oranges"
"""Of the probability that it is."""


def symbol(name: str) -> str:
    """Return the symbol of a conductance."""
    return rf"$G_\mathrm{{{name[2:]}}}$"


def axis_label(axis: str, gate_unit: str = "") -> str:
    """Return the label of an axis with its unit, which of a gate voltage may be stated."""
    words, unit = _symbol_and_unit(axis, gate_unit)
    return f"{words} [{unit}]" if unit else words


def axis_value(axis: str, value: str, gate_unit: str = "") -> str:
    """Return the words for one value of an axis, which is a text already."""
    words, unit = _symbol_and_unit(axis, gate_unit)
    return f"{words} = {value} {unit}".rstrip()


def _symbol_and_unit(axis: str, gate_unit: str) -> tuple[str, str]:
    return (AXIS_SYMBOLS[axis], QUANTITIES[axis][1]) if axis in AXIS_SYMBOLS else (axis, gate_unit)


def colour_scale(name: str, largest: float) -> dict[str, Any]:
    """Return the colours of a conductance, and their limits: from 0 on, or about it."""
    largest = largest or 1.0  # of conductances that are all zero
    if name in LOCAL:
        return {"cmap": LOCAL_COLOURS, "vmin": 0, "vmax": largest}
    return {"cmap": NONLOCAL_COLOURS, "vmin": -largest, "vmax": largest}
