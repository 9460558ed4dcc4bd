"""The derivatives of the conductances, all of them, in one direction, or of a weighted sum."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import (
    check_progress,
    names_in,
    number_in,
    reals,
    require,
    shown,
)
from disorder_landscape.model.parameters import TEMPERATURE, FloatArray, Nanowire
from disorder_landscape.model.quantities import AXES, CONDUCTANCES, QUANTITIES, with_units
from disorder_landscape.model.ranges import checked_temperature
from disorder_landscape.observables.grids import Progress, checked_grids
from disorder_landscape.solver import gradients
from disorder_landscape.solver.compiled import GROWTH_LIMIT

SETS_AT_ONCE = 64
"""Sets (μ, B) that are differentiated at a time: a fraction of a second."""


def conductance_gradient(
    wire: Nanowire,
    mu: ArrayLike,
    B: ArrayLike,
    bias: ArrayLike = 0.0,
    temperature: float = TEMPERATURE,
    *,
    parameters: Sequence[str] | None = None,
    direction: Mapping[str, ArrayLike] | None = None,
    weights: xr.Dataset | None = None,
    growth_limit: float = GROWTH_LIMIT,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Return the derivatives of the conductances of a wire (core/derivatives).

    Parameters
    ----------
    wire : Nanowire
    mu, B, bias : float or array
        Chemical potentials in meV, fields in T, biases in meV; increasing.
    temperature : float
        In K, 0 or from 1e-6 to 10.
    parameters : sequence of str, optional
        With respect to what: "V" (of every site), "mu", "B", "alpha", "barrier_left" and
        "barrier_right", at a temperature also "g", "gamma", "delta0", "critical_field", "bias" (an
        offset of all biases) and "temperature"; by default all of these. "dissipation" is there if
        named; it is slow where there is none, or the parent has its own.
    direction : mapping, optional
        How much each of these changes, one number, or one for each site for "V": then the result is
        the change of each conductance per unit of the direction (forward mode).
    weights : Dataset, optional
        Weights w of G_LL, G_RR, G_LR, G_RL, dims (mu, B, bias): then the result is the gradient of
        the sum of all wG (backward mode).
    growth_limit : float
        At T = 0, points at which real elimination grows beyond it are solved by pivoting.
    progress : callable, optional
        Called with the number of pairs (μ, B) that have just been done, and that of all pairs.

    Returns
    -------
    xarray.Dataset
        dG_LL_dV, dims (mu, B, bias, site), in e²/h per meV, dG_LL_dmu and so on, dims (mu, B,
        bias); with a direction dG_LL and so on, with weights one variable for each parameter.
        Beside them, but for weights, G_LL and so on; at a temperature their `error` and `energies`,
        and `gradient_error`, the estimated error of the derivatives by energies as a share of the
        largest at this (mu, B), with weights the worst of all. The leads' field follows B, their g
        and spin–orbit coupling follow the wire's unless `lead_g` or `lead_alpha` is given; their
        chemical potential does not follow μ.

    Raises
    ------
    ArgumentError
        If the wire is not one, a grid is empty, unsorted or out of range, a parameter is unknown, a
        direction or weights do not fit, or at T = 0 the wire has dissipation or a critical field.
    """
    require(isinstance(wire, Nanowire), "wire", "be a Nanowire", f"it is {shown(wire)}")
    temperature = checked_temperature(temperature)
    growth_limit = number_in("growth_limit", growth_limit, 0.0, np.inf)
    check_progress(progress)
    if temperature == 0:
        require(wire.lossless, "wire", "have no dissipation for slopes at T = 0", "it has")
        without = bool(np.isinf(wire.critical_field))
        require(without, "wire", "have no critical field for slopes at T = 0", "it has")
    grids = checked_grids([wire], mu, B, bias)
    fields = grids["B"]
    maps = direction is None or isinstance(direction, Mapping)
    require(
        maps, "direction", "say by how much each parameter changes", f"it is {shown(direction)}"
    )
    names = _known(parameters if direction is None else direction, temperature)
    alone = direction is None or (weights is None and parameters is None)
    require(alone, "direction", "come without parameters or weights", "it does not")
    along = {} if direction is None else _checked_direction(direction, wire)
    w = None if weights is None else _checked_weights(weights, grids)
    parts = []
    for points in _pieces(grids["mu"].size, fields.size):
        block = grids["mu"][points], fields, grids["bias"]
        if temperature == 0:
            found = gradients.at_zero(wire, *block, growth_limit)
        else:
            found = gradients.at_a_temperature(wire, *block, temperature, names)
        by = {name: found.by[name] for name in names}
        if along:
            by = {"": sum(np.dot(by[name], along[name]) for name in names)}
        elif w is not None:
            by = {name: np.tensordot(w[points], by[name], axes=4)[None] for name in names}
        parts.append(replace(found, by=by))
        if progress is not None:
            progress(found.error.size, grids["mu"].size * fields.size)
    whole = gradients.joined(parts, axis=0)
    data = _weighted_sum(whole) if w is not None else _derivatives(whole)
    data |= _of_sets(whole, w is not None, temperature)
    coordinates: dict[str, Any] = dict(grids) if w is None else {}
    if "V" in names and not along:
        coordinates["site"] = np.arange(wire.sites)
    return with_units(xr.Dataset(data, coords=coordinates, attrs={"temperature": temperature}))


Variable = tuple[tuple[str, ...], Any, dict[str, str]]


def _known(names: object, temperature: float) -> list[str]:
    """Return what is differentiated by, in the order of the registry."""
    at_hand = gradients.AT_ZERO if temperature == 0 else gradients.AT_A_TEMPERATURE
    if names is None:
        return list(at_hand)
    known = at_hand if temperature == 0 else gradients.UNITS
    at = "at T = 0 " if temperature == 0 else ""
    must = f"be names of what there are derivatives by, {at}{', '.join(known)}"
    asked = names_in("parameters", names, known, must)
    return [name for name in known if name in asked]


def _checked_direction(direction: Mapping[str, ArrayLike], wire: Nanowire) -> dict[str, FloatArray]:
    """Return the direction's change of each parameter, of V that of each site."""
    along = {}
    for name, change in direction.items():
        must = f"be {'one number for each site' if name == 'V' else 'a number'}"
        along[name] = reals(f"direction[{name!r}]", change, must)
        shape = (wire.sites,) if name == "V" else ()
        fits = along[name].shape == shape and bool(np.isfinite(along[name]).all())
        require(fits, f"direction[{name!r}]", must, f"it is {shown(change)}")
    return along


def _checked_weights(weights: xr.Dataset, grids: Mapping[str, FloatArray]) -> FloatArray:
    """Return the weights, shape (mu, B, bias, 4)."""
    shape = tuple(grid.size for grid in grids.values())
    must = f"be a Dataset of {', '.join(CONDUCTANCES)} with dims {AXES} of sizes {shape}"
    ok = isinstance(weights, xr.Dataset) and all(
        name in weights and set(weights[name].dims) == set(AXES) for name in CONDUCTANCES
    )
    require(ok, "weights", must, f"it is {shown(weights)}")
    each = [weights[name].transpose(*AXES).to_numpy() for name in CONDUCTANCES]
    require(all(of.shape == shape for of in each), "weights", must, f"they have {each[0].shape}")
    w = reals("weights", np.stack(each, axis=-1), must)
    require(bool(np.isfinite(w).all()), "weights", "be finite", "they hold NaN or infinity")
    return w


def _pieces(points: int, fields: int) -> Iterator[slice]:
    """Cut the chemical potentials so that each piece is done in a fraction of a second."""
    at_once = max(1, SETS_AT_ONCE // fields)
    for first in range(0, points, at_once):
        yield slice(first, first + at_once)


def _attributes(of: str, parameter: str) -> dict[str, str]:
    """Return long_name and units of a derivative; of no parameter it is that in the direction."""
    if not parameter:
        return {"long_name": f"change of the {of} in the direction", "units": "e^2/h"}
    units = f"e^2/h/({gradients.UNITS[parameter]})"
    return {"long_name": f"derivative of the {of} with respect to {parameter}", "units": units}


def _derivatives(of: gradients.Gradient) -> dict[str, Variable]:
    """Return the variables of all derivatives."""
    data: dict[str, Variable] = {}
    for k, name in enumerate(CONDUCTANCES):
        for parameter, values in of.by.items():
            variable = f"d{name}_d{parameter}" if parameter else f"d{name}"
            dims = (*AXES, "site") if parameter == "V" else AXES
            attributes = _attributes(QUANTITIES[name][0], parameter)
            data[variable] = (dims, values[:, :, :, k], attributes)
    return data


def _weighted_sum(of: gradients.Gradient) -> dict[str, Variable]:
    """Return the variables of the gradient of a weighted sum, of which each piece has a part."""
    return {
        name: (("site",) if name == "V" else (), parts.sum(axis=0), _attributes("sum", name))
        for name, parts in of.by.items()
    }


def _of_sets(of: gradients.Gradient, summed: bool, temperature: float) -> dict[str, Variable]:
    """Return what there is beside the derivatives; of a sum the largest errors."""
    of_sets = {"error": of.error, "energies": of.energies, "gradient_error": of.gradient_error}
    if temperature == 0:
        of_sets = {}
    if summed:
        return {name: ((), values.max(), {}) for name, values in of_sets.items()}
    data: dict[str, Variable] = {name: (AXES[:2], values, {}) for name, values in of_sets.items()}
    conductances = np.moveaxis(of.conductance, -1, 0)
    return data | {name: (AXES, G, {}) for name, G in zip(CONDUCTANCES, conductances, strict=True)}
