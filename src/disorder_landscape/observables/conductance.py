"""The conductance matrix on grids of μ, B and V_bias, at any temperature, through either solver."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import check_progress, grid_in, number_in
from disorder_landscape.model.hamiltonian import FULL_TURN
from disorder_landscape.model.parameters import BOLTZMANN, TEMPERATURE, Nanowire
from disorder_landscape.model.quantities import CONDUCTANCES, with_units
from disorder_landscape.model.ranges import checked_temperature
from disorder_landscape.solver import routes
from disorder_landscape.solver.energy_grid import ENERGY_SPACING, thermal_grid

Progress = Callable[[int, int], None]


def conductance(
    wire: Nanowire | Sequence[Nanowire],
    mu: ArrayLike,
    B: ArrayLike,
    bias: ArrayLike = 0.0,
    temperature: float = TEMPERATURE,
    solver: str = "fast",
    energy_spacing: float | None = None,
    progress: Progress | None = None,
    theta: float = 0.0,
) -> xr.Dataset:
    """Return the conductance matrix of a wire, or of several of equal length (S-I).

    Parameters
    ----------
    wire : Nanowire or sequence of them
    mu, B, bias : float or array
        Chemical potentials in meV, fields in T, biases in meV; increasing.
    temperature : float
        In K, 0 or from 1e-6 to 10; 0 gives the bare conductance at ω = bias.
    solver : {"fast", "kwant"}
        The real recursion, or Kwant, the reference, thousands of times slower.
    energy_spacing : float, optional
        Average over a grid of energies within 10 kT of at most this spacing in meV, at most kT, as
        the paper does, instead of exactly. What is farther away, 10⁻⁴ of the thermal weight, is
        left out. Kwant always does so, by default at 0.5 µeV.
    progress : callable, optional
        Called with the number of pairs (μ, B) that have just been done, and that of all pairs.
    theta : float
        Angle of the field relative to the wire in radians, θ of Eq. S1. All but 0, the paper's,
        take a slower route.

    Returns
    -------
    xarray.Dataset
        G_LL, G_RR, G_LR, G_RL in e²/h, dims (mu, B, bias), with a leading dim realization for
        several wires; solver, temperature, theta and, if the wires have the same, barrier as
        attributes. An exact average also has `error`, the estimated error in e²/h, and
        `energies`, how many the solver was asked for, dims (mu, B).

    Raises
    ------
    ArgumentError
        If a grid is empty, unsorted or out of range, the temperature negative, the bias beyond the
        gap (or its thermal window, with a grid of energies), the solver unknown, or the wires of
        unequal length.
    """
    wires, solver = routes.wires_of(wire), routes.known_solver(solver)
    check_progress(progress)
    fields = grid_in("B", B, -100.0, 100.0, "T")
    delta0 = min(w.in_field(abs(fields).max()).delta0 for w in wires)
    grids = {
        "mu": grid_in("mu", mu, -1e3, 1e3, "meV"),
        "B": fields,
        "bias": grid_in("bias", bias, -delta0 * (1 - 1e-6), delta0 * (1 - 1e-6), "meV"),
    }
    temperature = checked_temperature(temperature)
    theta = number_in("theta", theta, -FULL_TURN, FULL_TURN, "radians")
    shape = (len(wires), grids["mu"].size, grids["B"].size)
    report = progress if progress is not None else lambda done, total: None
    exact = temperature > 0 and solver == "fast" and energy_spacing is None
    G = np.empty((*shape, grids["bias"].size, 4))
    error, energies = np.zeros(shape), np.zeros(shape, dtype=np.int64)
    if exact:
        for some, points, some_fields in _blocks(shape, routes.sets_at_once(theta)):
            at = some, points, some_fields
            G[at], error[at], energies[at] = routes.thermal_average(
                wires[some],
                grids["mu"][points],
                fields[some_fields],
                grids["bias"],
                temperature,
                theta,
            )
            report(error[at].size, error.size)
    else:
        if temperature > 0:
            kT = BOLTZMANN * temperature  # a coarser grid would miss the kernel altogether
            spacing = min(ENERGY_SPACING, kT) if energy_spacing is None else energy_spacing
            spacing = number_in("energy_spacing", spacing, 1e-7, kT, "meV")
            omega, weights = thermal_grid(grids["bias"], temperature, delta0, spacing)
        else:
            omega, of_bias = np.unique(abs(grids["bias"]), return_inverse=True)
            side = (grids["bias"] < 0).astype(int)
        most = routes.energies_at_once(solver, theta) // omega.size
        for some, points, some_fields in _blocks(shape, most):
            some_wires, mus, fs = wires[some], grids["mu"][points], fields[some_fields]
            G0 = routes.bare_conductance(some_wires, mus, fs, omega, theta, solver)
            if temperature > 0:
                G[some, points, some_fields] = np.einsum("wmbkse,vks->wmbve", G0, weights)
            else:
                G[some, points, some_fields] = G0[:, :, :, of_bias, side]
            report(G0[..., 0, 0, 0].size, error.size)
    missing = np.isnan(G).any(axis=(3, 4)).sum()
    if missing:
        message = f"At {missing} of {error.size} points (wire, μ, B) a conductance is no number"
        warnings.warn(f"{message}: there the solver failed.", RuntimeWarning, stacklevel=2)
    data: dict[str, Any]
    data = {name: (("realization", *grids), G[..., i]) for i, name in enumerate(CONDUCTANCES)}
    if exact:
        data["error"] = (("realization", "mu", "B"), error)
        data["energies"] = (("realization", "mu", "B"), energies)
    attrs = {"temperature": temperature, "solver": solver, "theta": theta}
    if len({w.barrier for w in wires}) == 1:
        attrs["barrier"] = wires[0].barrier
    dataset = with_units(xr.Dataset(data, coords=grids, attrs=attrs))
    return dataset.isel(realization=0) if isinstance(wire, Nanowire) else dataset


def _blocks(shape: tuple[int, int, int], most: int) -> Iterator[tuple[slice, slice, slice]]:
    """Cut an array (wire, mu, B) into blocks of at most `most` entries, or single ones."""
    wires, points, fields = shape
    points_at_once = max(1, min(points, most))
    fields_at_once = max(1, min(fields, most // points_at_once))
    wires_at_once = max(1, most // (points * fields))
    for w in range(0, wires, wires_at_once):
        for p in range(0, points, points_at_once):
            for f in range(0, fields, fields_at_once):
                yield (
                    slice(w, w + wires_at_once),
                    slice(p, p + points_at_once),
                    slice(f, f + fields_at_once),
                )
