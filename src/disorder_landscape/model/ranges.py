"""The ranges within which parameters and settings are accepted."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from disorder_landscape.arguments import number_in, reals, require, shown

PARAMETER_RANGES = {
    "alpha": (0.0, 100.0, "meV nm"),
    "mass": (1e-3, 10.0, "electron masses"),
    "lattice": (0.1, 100.0, "nm"),
    "g": (0.0, 100.0, ""),
    "gamma": (0.0, 10.0, "meV"),
    "delta0": (1e-3, 10.0, "meV"),
    "lead_mu": (-1e3, 1e3, "meV"),
    "lead_alpha": (0.0, 100.0, "meV nm"),
    "lead_g": (0.0, 100.0, ""),
    "critical_field": (1e-3, np.inf, "T"),
    "dissipation": (0.0, 10.0, "meV"),
    "parent_dissipation": (0.0, 10.0, "meV"),
}
"""Range and unit within which each parameter of a wire is accepted that is one number."""
FOLLOWING = ("lead_alpha", "lead_g", "parent_dissipation")
"""Parameters that may be None: then they follow another one."""
STATED = tuple(name for name in PARAMETER_RANGES if name not in FOLLOWING)
"""Parameters that a file states of the wire in it, besides the barriers."""
COLDEST, HOTTEST = 1e-6, 10.0
"""Range of temperatures above zero in K."""
BARRIER_RANGE = (-1e3, 1e3, "meV")
"""The same of the barriers, …"""
MU_RANGE = (-1e3, 1e3, "meV")
"""… of chemical potentials, …"""
B_RANGE = (-100.0, 100.0, "T")
"""… and of fields."""


def checked_temperature(temperature: object) -> float:
    """Return a temperature in K: zero, or one at which kT is not lost in rounding.

    Raises
    ------
    ArgumentError
        If it is another number, or none.
    """
    T = number_in("temperature", temperature, 0.0, HOTTEST, "K")
    must = f"be 0 or from {COLDEST:g} to {HOTTEST:g} K"
    require(T == 0 or T >= COLDEST, "temperature", must, f"it is {T:g}")
    return T


def checked_barrier(barrier: ArrayLike) -> tuple[float, float]:
    """Return the barriers on both ends in meV.

    Raises
    ------
    ArgumentError
        If they are not two numbers within their range.
    """
    must = "be two numbers in meV, left and right"
    both = reals("barrier", barrier, must)
    require(both.shape == (2,), "barrier", must, f"it is {shown(barrier)}")
    left, right = (number_in("barrier", one, *BARRIER_RANGE) for one in both)
    return left, right


def checked_potential(potential: ArrayLike) -> NDArray[np.float64]:
    """Return a potential as a read-only vector of floats.

    Raises
    ------
    ArgumentError
        If it is not a finite vector of at least two sites.
    """
    must = "be a vector of one number in meV per site, at least two"
    V = reals("potential", potential, must)
    require(V.ndim == 1 and V.size >= 2, "potential", must, f"it has shape {V.shape}")
    require(bool(np.isfinite(V).all()), "potential", "be finite", "it holds NaN or infinity")
    must = "stay within ±1000 meV"
    require(bool((abs(V) <= 1e3).all()), "potential", must, f"it reaches {abs(V).max():g} meV")
    V.setflags(write=False)
    return V
