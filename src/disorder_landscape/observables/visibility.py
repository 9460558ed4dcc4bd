"""Where a wire is topological: the visibility T_IV of its ends, and the bulk transition."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import number_in, require, whether
from disorder_landscape.model.hamiltonian import FULL_TURN
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.model.quantities import with_units
from disorder_landscape.observables.grids import checked_mu_and_B
from disorder_landscape.solver import routes


def topological_visibility(
    wire: Nanowire | Sequence[Nanowire],
    mu: ArrayLike,
    B: ArrayLike,
    barrier: bool = True,
    solver: str = "fast",
    theta: float = 0.0,
) -> xr.DataArray:
    """Return T_IV = det r at ω = 0 of both ends of a wire, or of several of equal length (S-I).

    Parameters
    ----------
    wire : Nanowire or sequence of them
    mu, B : float or array
        Chemical potentials in meV and fields in T; increasing.
    barrier : bool
        Whether with the device's barriers, or without any.
    solver : {"fast", "kwant"}
    theta : float
        Angle of the field relative to the wire in radians.

    Returns
    -------
    xarray.DataArray
        T_IV in [−1, 1], dims (lead, mu, B), lead = L, R, with a leading dim realization for several
        wires; negative where the wire is topological.

    Raises
    ------
    ArgumentError
        As in `conductance`.
    """
    wires, solver = routes.wires_of(wire), routes.known_solver(solver)
    grids = checked_mu_and_B(mu, B)
    without = all(w.lossless for w in wires)
    must = "have no dissipation for T_IV"
    require(without, "wire", must, "it has, and nothing is reflected in full")
    if not whether("barrier", barrier):
        wires = [replace(w, barrier=(0.0, 0.0)) for w in wires]
    theta = number_in("theta", theta, -FULL_TURN, FULL_TURN, "radians")
    determinant = routes.reflection_determinant(wires, grids["mu"], grids["B"], theta, solver)
    missing = np.isnan(determinant).any(axis=1).sum()
    if missing:
        message = f"At {missing} of {determinant[:, 0].size} points (wire, μ, B) T_IV is no number"
        warnings.warn(f"{message}: there the solver failed.", RuntimeWarning, stacklevel=2)
    coords = {"lead": ["L", "R"], **grids}
    data = {"T_IV": (("realization", *coords), determinant)}
    T: xr.DataArray = with_units(xr.Dataset(data, coords=coords))["T_IV"]
    return T.isel(realization=0) if isinstance(wire, Nanowire) else T


def transition_field(wire: Nanowire, mu: ArrayLike) -> FloatArray:
    """Return the field in T at which a pristine infinite wire closes its gap, shape as mu (meV).

    V_Z² = μ² + γ² (Lutchyn, Sau and Das Sarma 2010, with the pairing γ that Σ(0) induces).
    """
    return np.asarray(np.hypot(mu, wire.gamma) / wire.zeeman_per_tesla)
