"""The parameters of a device that may be unknown, each in one line: how it enters the simulation.

A new one needs a line here, and a field of `Prior` of the same name.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from disorder_landscape.model.parameters import TEMPERATURE, FloatArray, Nanowire
from disorder_landscape.model.ranges import BARRIER_RANGE, COLDEST, HOTTEST, PARAMETER_RANGES


@dataclass
class Setup:
    """A wire but for its disorder, and the settings at which it is measured."""

    mu: FloatArray
    """In meV; before `lever_arm` has entered, as measured: a gate voltage, if that is the axis."""
    bias: FloatArray
    """In meV."""
    temperature: float = TEMPERATURE
    """In K."""
    barrier: list[float] = field(default_factory=lambda: list(Nanowire.barrier))
    """Left and right, in meV."""
    wire: dict[str, float] = field(default_factory=dict)
    """The other parameters of `Nanowire`."""


@dataclass(frozen=True)
class Parameter:
    """One parameter of a device."""

    name: str
    long_name: str
    unit: str
    usual: float
    """Its value where neither the prior nor the measurement says anything."""
    low: float
    high: float
    derivative: str
    """By what `conductance_gradient` differentiates, …"""
    enters: Callable[[Setup, float], None]
    """How a value changes the setup of the simulation."""
    alike: float
    """How much of it changes the conductances as 1 meV of V does, roughly."""
    of_measured_mu: bool = False
    """… times the μ that was measured."""


def _of_the_wire(name: str, long_name: str, alike: float) -> Parameter:
    def enters(setup: Setup, value: float) -> None:
        setup.wire[name] = value

    low, high, unit = PARAMETER_RANGES[name]
    usual = getattr(Nanowire, name)
    return Parameter(name, long_name, unit, usual, low, high, name, enters, alike)


def _barrier(side: int, name: str, long_name: str) -> Parameter:
    def enters(setup: Setup, value: float) -> None:
        setup.barrier[side] = value

    low, high, unit = BARRIER_RANGE
    usual = Nanowire.barrier[side]
    return Parameter(name, long_name, unit, usual, low, high, name, enters, 100.0)


def _temperature(setup: Setup, value: float) -> None:
    setup.temperature = max(value, COLDEST) if value > 0 else 0.0


def _bias_offset(setup: Setup, value: float) -> None:
    setup.bias = setup.bias + value


def _lever_arm(setup: Setup, value: float) -> None:
    setup.mu = value * setup.mu


def _mu_offset(setup: Setup, value: float) -> None:
    setup.mu = setup.mu + value


PARAMETERS = (
    _of_the_wire("alpha", "spin-orbit coupling", 50.0),
    _of_the_wire("g", "Landé g-factor", 50.0),
    _of_the_wire("gamma", "coupling to the parent superconductor", 1.0),
    _of_the_wire("delta0", "gap of the parent superconductor", 1.0),
    _of_the_wire("critical_field", "critical field of the parent superconductor", 10.0),
    _of_the_wire("dissipation", "broadening of the levels", 0.1),
    Parameter(
        *("temperature", "electron temperature", "K", TEMPERATURE, 0.0, HOTTEST),
        *("temperature", _temperature, 1.0),
    ),
    _barrier(0, "barrier_left", "left barrier"),
    _barrier(1, "barrier_right", "right barrier"),
    Parameter(
        *("bias_offset", "offset of the bias", "meV", 0.0, -0.1, 0.1),
        *("bias", _bias_offset, 1.0),
    ),
    Parameter(
        *("lever_arm", "lever arm", "meV per unit", 1.0, 1e-6, 1e6),
        *("mu", _lever_arm, 1.0),
        of_measured_mu=True,
    ),
    Parameter(
        *("mu_offset", "offset of the chemical potential", "meV", 0.0, -10.0, 10.0),
        *("mu", _mu_offset, 1.0),
    ),
)
"""In the order in which they enter: the lever arm before the offset."""
BY_NAME = {parameter.name: parameter for parameter in PARAMETERS}


def nanowire(V: FloatArray, setup: Setup, fixed: dict[str, Any]) -> Nanowire:
    """Return the wire with a potential (site,) that a setup describes."""
    left, right = setup.barrier
    return Nanowire(V, barrier=(left, right), **setup.wire, **fixed)
