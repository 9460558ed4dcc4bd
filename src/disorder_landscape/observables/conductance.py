"""The conductance matrix on grids of μ, B and V_bias, at any temperature, through either solver."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from disorder_landscape.arguments import check_progress, number_in, require
from disorder_landscape.model.hamiltonian import FULL_TURN
from disorder_landscape.model.parameters import BOLTZMANN, TEMPERATURE, FloatArray, Nanowire
from disorder_landscape.model.quantities import CONDUCTANCES, with_units
from disorder_landscape.model.ranges import checked_temperature
from disorder_landscape.model.stated import stated
from disorder_landscape.observables.grids import Progress, checked_grids, least_gap
from disorder_landscape.solver import routes
from disorder_landscape.solver.energy_grid import ENERGY_SPACING, thermal_grid


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
        Our own recursion, or Kwant, the reference, thousands of times slower.
    energy_spacing : float, optional
        Average over a grid of energies within 10 kT of at most this spacing in meV, at most kT, as
        the paper does, instead of exactly. What is farther away, 10⁻⁴ of the thermal weight, is
        left out. Kwant always does so, by default at 0.5 µeV.
    progress : callable, optional
        Called with the number of points (wire, μ, B) that have just been done, and that of all.
    theta : float
        Angle of the field relative to the wire in radians, θ of Eq. S1. All but 0, the paper's,
        take a slower route.

    Returns
    -------
    xarray.Dataset
        G_LL, G_RR, G_LR, G_RL in e²/h, dims (mu, B, bias), with a leading dim realization for
        several wires; solver, temperature, theta, and whatever parameters all wires have in common
        as attributes. An exact average also has `error`, the estimated error in e²/h, and
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
    grids = checked_grids(wires, mu, B, bias)
    temperature = checked_temperature(temperature)
    theta = number_in("theta", theta, -FULL_TURN, FULL_TURN, "radians")
    must = "not be given at T = 0, where nothing is averaged"
    averaged = temperature > 0 or energy_spacing is None
    require(averaged, "energy_spacing", must, f"it is {energy_spacing}")
    report = progress if progress is not None else lambda done, total: None
    if temperature > 0 and solver == "fast" and energy_spacing is None:
        G, of_average = _exact(wires, grids, temperature, theta, report)
    else:
        delta0 = least_gap(wires, grids["B"])
        omega, combined = _at_energies(grids["bias"], temperature, delta0, energy_spacing)
        G, of_average = _combined(wires, grids, omega, combined, theta, solver, report), {}
    missing = np.isnan(G).any(axis=(3, 4))
    if missing.any():
        message = f"At {missing.sum()} of {missing.size} points (wire, μ, B) a conductance is no"
        warnings.warn(f"{message} number: there the solver failed.", RuntimeWarning, stacklevel=2)
    data = {name: (("realization", *grids), G[..., i]) for i, name in enumerate(CONDUCTANCES)}
    data |= {name: (("realization", "mu", "B"), values) for name, values in of_average.items()}
    attrs = {**stated(wires), "temperature": temperature, "solver": solver, "theta": theta}
    dataset = with_units(xr.Dataset(data, coords=grids, attrs=attrs))
    return dataset.isel(realization=0) if isinstance(wire, Nanowire) else dataset


Grids = Mapping[str, FloatArray]


def _shape(wires: Sequence[Nanowire], grids: Grids) -> tuple[int, int, int]:
    return len(wires), grids["mu"].size, grids["B"].size


def _exact(
    wires: Sequence[Nanowire], grids: Grids, temperature: float, theta: float, report: Progress
) -> tuple[FloatArray, dict[str, NDArray[Any]]]:
    """Return exact averages (wire, mu, B, bias, 4), their errors, and how many energies they took.

    The latter, shape (wire, mu, B), by name.
    """
    shape = _shape(wires, grids)
    G = np.empty((*shape, grids["bias"].size, 4))
    error, energies = np.zeros(shape), np.zeros(shape, dtype=np.int64)
    for at in _blocks(shape, routes.sets_at_once(theta)):
        some, points, fields = at
        G[at], error[at], energies[at] = routes.thermal_average(
            wires[some],
            grids["mu"][points],
            grids["B"][fields],
            grids["bias"],
            temperature,
            theta,
        )
        report(error[at].size, error.size)
    return G, {"error": error, "energies": energies}


def _at_energies(
    bias: FloatArray, temperature: float, delta0: float, energy_spacing: float | None
) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
    """Return energies ω ≥ 0 at which wires are to be solved, and what makes conductances of that.

    From (wire, mu, B, omega, 2, 4), as of `routes.bare_conductance`, to (wire, mu, B, bias, 4).
    """
    if temperature == 0:
        omega, of_bias = np.unique(abs(bias), return_inverse=True)
        side = (bias < 0).astype(int)
        return omega, lambda G: G[:, :, :, of_bias, side]
    kT = BOLTZMANN * temperature  # a coarser grid would miss the kernel altogether
    spacing = min(ENERGY_SPACING, kT) if energy_spacing is None else energy_spacing
    spacing = number_in("energy_spacing", spacing, 1e-7, kT, "meV")
    omega, weights = thermal_grid(bias, temperature, delta0, spacing)
    return omega, lambda G: np.einsum("wmbkse,vks->wmbve", G, weights)


def _combined(
    wires: Sequence[Nanowire],
    grids: Grids,
    omega: FloatArray,
    combined: Callable[[FloatArray], FloatArray],
    theta: float,
    solver: str,
    report: Progress,
) -> FloatArray:
    """Return what is made of conductances at energies ω, shape (wire, mu, B, bias, 4)."""
    shape = _shape(wires, grids)
    G = np.empty((*shape, grids["bias"].size, 4))
    for at in _blocks(shape, routes.energies_at_once(solver, theta) // omega.size):
        some, points, fields = at
        places = wires[some], grids["mu"][points], grids["B"][fields]
        G[at] = combined(routes.bare_conductance(*places, omega, theta, solver))
        report(G[at][..., 0, 0].size, int(np.prod(shape)))
    return G


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
