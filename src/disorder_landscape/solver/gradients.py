"""The derivatives of conductances with respect to all that a wire and a measurement are made of.

At T = 0 and at a temperature the compiled core finds them (core/derivatives), at a cost that does
not depend on how many there are. Above 1 K, where the wire leaks without its parent, and for the
rare set without a closed form they are differences of exact averages.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.model.parameters import BOHR_MAGNETON, BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.solver import compiled, compiled_gradients, routes
from disorder_landscape.solver.difference_gradient import difference
from disorder_landscape.solver.lead_slopes import rotated_lead_slopes
from disorder_landscape.solver.quadrature import thermal_quadrature

AT_ZERO = {
    "V": "meV",
    "mu": "meV",
    "B": "T",
    "alpha": "meV nm",
    "barrier_left": "meV",
    "barrier_right": "meV",
}
"""With respect to what there are derivatives at T = 0, and its unit."""
AT_A_TEMPERATURE = AT_ZERO | {
    "g": "1",
    "gamma": "meV",
    "delta0": "meV",
    "critical_field": "T",
    "bias": "meV",
    "temperature": "K",
}
"""The same at a temperature; bias is an offset of all of them."""
UNITS = AT_A_TEMPERATURE | {"dissipation": "meV"}
"""All of these. The derivative by the dissipation is a difference where there is none, and where
the parent has its own."""
CORE_ORDER = (
    *("mu", "V_Z", "alpha", "gamma", "delta0", "lead_V_Z"),
    *("dissipation", "energy", "bias", "kT"),
)
"""What the core differentiates by, as core/derivatives/shifted_averages.hpp has it."""
HOTTEST = 1.0
"""Up to this temperature in K derivatives have a closed form. At 1 K they are within 4e-3 of the
largest for three wires, at 2 K within 6e-3, at 8 K within 0.1."""
SAFETY = 10.0
"""Estimated error over the difference of the two ways to what a shift of all energies does. Of 318
random derivatives the largest error was 9 times the difference, one in a hundred more than 5."""
SAFETY_TO_GAP = 3.0
"""The same where the thermal window reaches the gap. Of 140 derivatives of 18 wires at 300 mK, with
errors of 5e-5 to 3e-3 of the largest, the largest was 1.3 times the difference."""
THROUGH_GAP = ("B", "g", "delta0")
"""Where V_Z is a little less than Δ₀, levels of one spin next to the gap move much with these, and
levels of the other hardly."""
SAFETY_AT_GAP = 3.0
"""Their estimated error over that of the core, which takes all of these levels for those that move
most. (Of 24 wires at 0.2 to 1 K, V_Z from 0.5 to 1.1 Δ₀, the error was twice that at most.)"""
RESORT = 1e-2
"""Where this is larger, they are differences."""
LEAST = 1e-5
"""Estimated error that no comparison sees, as a share: of the contour's step and of its ends."""


@dataclass(frozen=True)
class Gradient:
    """Conductances and their derivatives on a grid of one wire."""

    conductance: FloatArray
    """Shape (mu, B, bias, 4): G_LL, G_RR, G_LR, G_RL in e²/h."""
    by: dict[str, FloatArray]
    """Of each parameter, shape (mu, B, bias, 4), by V with a last axis site."""
    error: FloatArray
    """Estimated error of the conductances, shape (mu, B), in e²/h."""
    energies: NDArray[np.int64]
    """Energies solved, shape (mu, B)."""
    gradient_error: FloatArray
    """Estimated error of the derivatives as a share of the largest by an energy, shape (mu, B)."""


def joined(parts: Sequence[Gradient], axis: int) -> Gradient:
    """Return the gradients of parts of a grid as one, along the axis of μ or of B."""

    def whole(arrays: Iterable[NDArray[Any]]) -> NDArray[Any]:
        return np.concatenate(list(arrays), axis=axis)

    return Gradient(
        whole(part.conductance for part in parts),
        {name: whole(part.by[name] for part in parts) for name in parts[0].by},
        whole(part.error for part in parts),
        whole(part.energies for part in parts),
        whole(part.gradient_error for part in parts),
    )


def at_zero(
    wire: Nanowire, mu: FloatArray, B: FloatArray, bias: FloatArray, growth_limit: float
) -> Gradient:
    """Return the derivatives at T = 0 of a wire without dissipation or critical field."""
    omega, which = np.unique(abs(bias), return_inverse=True)
    sign = (bias < 0).astype(int)
    biases = np.full((omega.size, 2), -1)
    biases[which, sign] = np.arange(bias.size)
    slopes = rotated_lead_slopes(wire, B, omega)
    slopes[:, :, 0] *= wire.lead_zeeman_per_tesla
    by_V, others = compiled_gradients.conductance_gradient(
        wire, mu, B, omega, biases, slopes, growth_limit
    )
    by = {"V": np.moveaxis(by_V, 0, 3)}
    by |= {name: np.moveaxis(others[:, k], 0, 3) for k, name in enumerate(("mu", "B", "alpha"))}
    G = compiled.bare_conductance([wire], mu, B, omega)[0][:, :, which, sign]
    exact = np.zeros((mu.size, B.size))
    energies = np.full(exact.shape, omega.size)
    return Gradient(G, _with_barriers(by), exact, energies, exact)


def at_a_temperature(
    wire: Nanowire,
    mu: FloatArray,
    B: FloatArray,
    bias: FloatArray,
    temperature: float,
    names: Sequence[str],
    complete: bool = True,
) -> Gradient:
    """Return the derivatives at a temperature with respect to what is named.

    Incomplete ones are NaN where a set has no closed form, instead of differences of quadratures.
    """
    if np.isinf(wire.critical_field):
        found = _at_one_gap(wire, mu, B, bias, temperature, names, complete)
    else:
        each = [_in_field(wire, mu, float(b), bias, temperature, names, complete) for b in B]
        found = joined(each, axis=1)
    return replace(found, by={name: found.by[name] for name in names})


def _with_barriers(by: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Add the derivatives by the barriers, which stand on the end sites."""
    return by | {"barrier_left": by["V"][..., 0], "barrier_right": by["V"][..., -1]}


def _in_field(
    wire: Nanowire,
    mu: FloatArray,
    B: float,
    bias: FloatArray,
    temperature: float,
    names: Sequence[str],
    complete: bool,
) -> Gradient:
    """Return the derivatives of a wire whose gap Δ₀(B) = Δ₀√(1 − (B/B_c)²) depends on the field."""
    through_gap = {"B", "delta0", "critical_field"}
    wanted = set(names) | ({"delta0"} if through_gap & set(names) else set())
    at = mu, np.array([B]), bias, temperature
    found = _at_one_gap(wire.in_field(B), *at, sorted(wanted), complete)
    if "delta0" not in wanted:
        return found
    share = B / wire.critical_field
    root, by_gap = np.sqrt(1 - share**2), found.by["delta0"]
    slope = wire.delta0 * share / wire.critical_field / root
    by = found.by | {"delta0": by_gap * root, "critical_field": by_gap * slope * share}
    if "B" in by:
        by["B"] = by["B"] - by_gap * slope
    return replace(found, by=by)


def _at_one_gap(
    wire: Nanowire,
    mu: FloatArray,
    B: FloatArray,
    bias: FloatArray,
    temperature: float,
    names: Sequence[str],
    complete: bool,
) -> Gradient:
    """Return the derivatives of a wire without a critical field."""
    if has_closed_form(wire, bias, temperature):
        found, at_gap = _of_the_core(wire, mu, B, bias, temperature)
        missing = [name for name in names if name not in found.by]
        moved = [name for name in THROUGH_GAP if name in names]
        if complete:
            point = wire, mu, B, bias, temperature
            _complete(found, point, names)
            for m, f in np.argwhere(at_gap > RESORT) if moved else ():
                at_gap[m, f] = 0.0
                _resort(found, point, moved, (m, f))
        else:
            for values in found.by.values():
                values[~np.isfinite(found.gradient_error)] = np.nan
        if moved:
            found = replace(found, gradient_error=np.maximum(found.gradient_error, at_gap))
    else:
        G, error, energies = (
            part[0] for part in routes.thermal_average([wire], mu, B, bias, temperature)
        )
        found = Gradient(
            G, {"critical_field": np.zeros_like(G)}, error, energies, np.zeros(error.shape)
        )
        missing = [name for name in names if name != "critical_field"]
    by, worst = dict(found.by), found.gradient_error
    for name in missing:
        by[name], share = difference(wire, mu, B, bias, temperature, name)
        worst = np.maximum(worst, share)
    return replace(found, by=by, gradient_error=worst)


def has_closed_form(wire: Nanowire, bias: FloatArray, temperature: float) -> bool:
    """Return whether derivatives of a wire are in closed form."""
    reaches = routes.closed_form_reaches([wire], bias, temperature, theta=0.0)
    return reaches and 0 < temperature <= HOTTEST


def energies_of_leads(bias: FloatArray, temperature: float) -> FloatArray:
    """Return the four energies at which the core is told of the leads, in meV."""
    window = routes.thermal_window(bias, temperature)
    return np.asarray(window * np.sin(np.pi * (np.arange(4) + 0.5) / 8))


_Point = tuple[Nanowire, FloatArray, FloatArray, FloatArray, float]


def _complete(found: Gradient, point: _Point, names: Sequence[str]) -> None:
    """Take conductances that have no good model from the quadrature, and what has none at all."""
    wire, mu, B, bias, temperature = point
    for m, f in np.argwhere(~(found.error <= compiled.core.TOLERANCE)):
        average = thermal_quadrature([wire], mu[m : m + 1], B[f : f + 1], bias, temperature)
        found.conductance[m, f], found.error[m, f] = (
            average.conductance[0, 0, 0],
            average.error.item(),
        )
        found.energies[m, f] += average.energies.item()
        if np.isfinite(found.gradient_error[m, f]):
            continue
        found.gradient_error[m, f] = LEAST
        asked = sorted(set(names) & set(found.by) - {"critical_field"})
        _resort(found, point, asked, (m, f))


def _resort(found: Gradient, point: _Point, names: Sequence[str], at: tuple[int, int]) -> None:
    """Take the derivatives of one set with respect to what is named from differences."""
    (wire, mu, B, bias, temperature), (m, f) = point, at
    for name in names:
        one, share = difference(wire, mu[m : m + 1], B[f : f + 1], bias, temperature, name)
        found.by[name][m, f] = one[0, 0]
        found.gradient_error[m, f] = max(found.gradient_error[m, f], share.item())


def _of_the_core(
    wire: Nanowire, mu: FloatArray, B: FloatArray, bias: FloatArray, temperature: float
) -> tuple[Gradient, FloatArray]:
    """Return the derivatives that the closed form has, and an estimated error of some, (mu, B).

    Those of THROUGH_GAP, as a share of the largest by an energy; zero where there is no model.
    """
    energies = energies_of_leads(bias, temperature)
    slopes = np.ascontiguousarray(rotated_lead_slopes(wire, B, energies))
    raw = compiled_gradients.thermal_gradient(wire, mu, B, bias, temperature, energies, slopes)
    of = dict(zip(CORE_ORDER, np.moveaxis(raw.others, -1, 0), strict=True))
    follows = 1.0 if wire.lead_g is None else 0.0
    field = B[:, None, None]
    by = {
        "V": raw.by_V,
        "mu": of["mu"],
        "B": wire.zeeman_per_tesla * of["V_Z"] + wire.lead_zeeman_per_tesla * of["lead_V_Z"],
        "alpha": of["alpha"],
        "g": 0.5 * BOHR_MAGNETON * field * (of["V_Z"] + follows * of["lead_V_Z"]),
        "gamma": of["gamma"],
        "delta0": of["delta0"],
        "critical_field": np.zeros_like(of["delta0"]),
        "bias": of["bias"],
        "temperature": BOLTZMANN * of["kT"],
    }
    if wire.dissipation > 0 and wire.parent_dissipation is None:  # else the parent's stays
        by["dissipation"] = of["dissipation"]
    by_energies = (by["mu"], by["gamma"], by["delta0"], by["bias"], abs(by["V"]).max(axis=-1))
    largest = BOLTZMANN * temperature * np.max([abs(of) for of in by_energies], axis=(0, 3, 4))
    safety = SAFETY if routes.stays_below_gap([wire], bias, temperature) else SAFETY_TO_GAP
    largest = np.maximum(largest, np.finfo(float).tiny)
    share = safety * raw.difference / largest + LEAST
    at_gap = np.where(np.isfinite(raw.at_gap), SAFETY_AT_GAP * raw.at_gap / largest, 0.0)
    return Gradient(raw.conductance, _with_barriers(by), raw.error, raw.energies, share), at_gap
