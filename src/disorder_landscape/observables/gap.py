"""How large the gap of a wire is: of its levels, and of what it conducts from end to end."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import number_in, require
from disorder_landscape.model.hamiltonian import FULL_TURN
from disorder_landscape.model.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.model.quantities import with_units
from disorder_landscape.model.ranges import checked_temperature
from disorder_landscape.observables.conductance import conductance
from disorder_landscape.observables.grids import checked_mu_and_B
from disorder_landscape.observables.modes import lowest_components, separation
from disorder_landscape.solver import compiled, routes

TEMPERATURE = 0.02
"""At which the nonlocal conductance is looked at by default, in K."""
THRESHOLD = 0.05
"""Share of its largest value from which an antisymmetric nonlocal conductance counts, by default,
as in the topological gap protocol (Pikulin et al., arXiv:2103.12217)."""
SEPARATE = 0.25
"""Share of the wire from which the components of a level count as zero modes, apart. (det r of a
short wire changes its sign with their splitting.)"""
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
        - excitation_gap: E_2 where the components of E_1 are zero modes, their centres more
          than a quarter of the wire apart (SEPARATE); E_1 elsewhere.
        - transport_gap: the lowest of 81 biases at which what is odd in the bias of G_LR or G_RL
          reaches the threshold; they go from zero to the largest one whose thermal window is below
          this wire's gap in this field. NaN where it stays within 1e-4 e²/h, and where there is no
          such bias.

    Raises
    ------
    ArgumentError
        As in `conductance`; and if a wire has dissipation, or a number is out of range.
    """
    wires = routes.wires_of(wire)
    without = all(w.lossless for w in wires)
    require(without, "wire", "have no dissipation for its gap", "it has")
    grids = checked_mu_and_B(mu, B)
    theta = number_in("theta", theta, -FULL_TURN, FULL_TURN, "radians")
    threshold = number_in("threshold", threshold, 0.0, 1.0)
    temperature = checked_temperature(temperature)
    require(temperature > 0, "temperature", "be above 0", "it is 0")
    levels = routes.levels(wires, grids["mu"], grids["B"], 2, theta)
    shape = levels.shape[:-1]
    apart, transport = np.zeros(shape, dtype=bool), np.full(shape, np.nan)
    for w, of_wire in enumerate(wires):
        for f, field in enumerate(grids["B"].tolist()):
            there = of_wire.in_field(field)
            transport[w, :, f] = _transport_gap(
                there, grids["mu"], field, temperature, threshold, theta
            )
            for m in np.flatnonzero(np.isfinite(levels[w, :, f, 1])):
                at = there, float(grids["mu"][m]), field, theta
                apart[w, m, f] = separation(*lowest_components(*at, levels[w, m, f])) > SEPARATE
    found = {
        "E_1": levels[..., 0],
        "E_2": levels[..., 1],
        "excitation_gap": np.where(apart, levels[..., 1], levels[..., 0]),
        "transport_gap": transport,
    }
    data = {name: (("realization", *grids), values) for name, values in found.items()}
    attrs = {"temperature": temperature, "threshold": threshold, "theta": theta}
    dataset = with_units(xr.Dataset(data, coords=grids, attrs=attrs))
    return dataset.isel(realization=0) if isinstance(wire, Nanowire) else dataset


def _transport_gap(
    wire: Nanowire, mu: FloatArray, B: float, temperature: float, threshold: float, theta: float
) -> FloatArray:
    """Return the lowest bias with a nonlocal conductance, shape (mu,)."""
    window = routes.BELOW_GAP * wire.delta0 - compiled.core.REACH * BOLTZMANN * temperature
    if window <= 0:
        return np.full(mu.size, np.nan)
    bias = np.linspace(0, window, BIASES)
    both = np.concatenate([-bias[:0:-1], bias])
    G = conductance(wire, mu, B, both, temperature, theta=theta).isel(B=0)
    nonlocal_G = np.stack([G.G_LR, G.G_RL])
    odd = abs(nonlocal_G - nonlocal_G[..., ::-1])[..., bias.size - 1 :].max(axis=0) / 2
    counts = odd >= np.maximum(threshold * odd.max(axis=-1, keepdims=True), compiled.core.TOLERANCE)
    return np.where(counts.any(axis=-1), bias[counts.argmax(axis=-1)], np.nan)
