"""How large the gap of a wire is: of its levels, and of what it conducts from end to end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import grid_in, number_in, require
from disorder_landscape.model.hamiltonian import FULL_TURN
from disorder_landscape.model.parameters import BOLTZMANN, FloatArray, Nanowire, checked_temperature
from disorder_landscape.model.quantities import with_units
from disorder_landscape.observables.conductance import conductance
from disorder_landscape.observables.visibility import topological_visibility
from disorder_landscape.solver import compiled, routes

TEMPERATURE = 0.02
"""At which the nonlocal conductance is looked at by default, in K."""
THRESHOLD = 0.05
"""Share of its largest value from which an antisymmetric nonlocal conductance counts, by default,
as in the topological gap protocol (Pikulin et al., arXiv:2103.12217)."""
BIASES = 81
"""Biases from zero to the largest at which it is looked for."""


def gap(
    wire: Nanowire | Sequence[Nanowire],
    mu: ArrayLike,
    B: ArrayLike,
    temperature: float = TEMPERATURE,
    threshold: float = THRESHOLD,
    theta: float = 0.0,
) -> xr.Dataset:
    """Return the gap of a wire, or of several of equal length.

    Parameters
    ----------
    wire : Nanowire or sequence of them
        Without dissipation.
    mu, B : float or array
        Chemical potentials in meV and fields in T; increasing.
    temperature : float
        Of the nonlocal conductance, in K, above 0.
    threshold : float
        Share of its largest value from which it counts, between 0 and 1.
    theta : float
        Angle of the field relative to the wire in radians.

    Returns
    -------
    xarray.Dataset
        Dims (mu, B), with a leading dim realization for several wires, in meV:

        - E_1, E_2: the lowest levels E ≥ 0 without leads; NaN where there is none below Δ₀.
        - excitation_gap: E_2 where det r < 0 at the left end without barriers, because E_1 is then
          the Majorana pair; E_1 elsewhere.
        - transport_gap: the lowest bias at which the antisymmetric part of G_LR or G_RL exceeds the
          threshold; NaN where none does, up to the largest bias whose thermal window is below Δ₀.

    Raises
    ------
    ArgumentError
        As in `conductance`; and if a wire has dissipation, or a number is out of range.
    """
    wires = routes.wires_of(wire)
    without = all(w.dissipation == 0 for w in wires)
    require(without, "wire", "have no dissipation for its gap", "it has")
    grids = {"mu": grid_in("mu", mu, -1e3, 1e3, "meV"), "B": grid_in("B", B, -100.0, 100.0, "T")}
    theta = number_in("theta", theta, -FULL_TURN, FULL_TURN, "radians")
    threshold = number_in("threshold", threshold, 0.0, 1.0)
    temperature = checked_temperature(temperature)
    highest = abs(grids["B"]).max()
    edge = min(w.in_field(highest).delta0 for w in wires) * routes.BELOW_GAP
    window = edge - compiled.core.REACH * BOLTZMANN * temperature
    must = "be above 0, and leave room between its thermal window and the gap"
    require(0 < window < edge, "temperature", must, f"it is {temperature:g} K")
    levels = routes.levels(wires, grids["mu"], grids["B"], 2, theta)
    bare = [replace(w, barrier=(0.0, 0.0)) for w in wires]
    topological = (
        topological_visibility(bare, grids["mu"], grids["B"], theta=theta).sel(lead="L") < 0
    )
    bias = np.linspace(0, window, BIASES)
    found = {
        "E_1": levels[..., 0],
        "E_2": levels[..., 1],
        "excitation_gap": np.where(topological, levels[..., 1], levels[..., 0]),
        "transport_gap": _transport_gap(wires, grids, bias, temperature, threshold, theta),
    }
    data = {name: (("realization", *grids), values) for name, values in found.items()}
    attrs = {"temperature": temperature, "threshold": threshold, "theta": theta}
    dataset = with_units(xr.Dataset(data, coords=grids, attrs=attrs))
    return dataset.isel(realization=0) if isinstance(wire, Nanowire) else dataset


def _transport_gap(
    wires: Sequence[Nanowire],
    grids: dict[str, FloatArray],
    bias: FloatArray,
    temperature: float,
    threshold: float,
    theta: float,
) -> FloatArray:
    """Return the lowest bias with a nonlocal conductance, shape (wire, mu, B)."""
    both = np.concatenate([-bias[:0:-1], bias])
    G = conductance(wires, grids["mu"], grids["B"], both, temperature, theta=theta)
    nonlocal_G = np.stack([G.G_LR, G.G_RL])
    antisymmetric = abs(nonlocal_G - nonlocal_G[..., ::-1])[..., bias.size - 1 :].max(axis=0)
    largest = antisymmetric.max(axis=-1, keepdims=True)
    counts = (antisymmetric >= threshold * largest) & (antisymmetric > 0)
    return np.where(counts.any(axis=-1), bias[counts.argmax(axis=-1)], np.nan)
