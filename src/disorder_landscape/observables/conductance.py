"""The conductance matrix on grids of μ, B and V_bias, at any temperature, through either solver."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from disorder_landscape.arguments import grid_in, number_in
from disorder_landscape.model.hamiltonian import FULL_TURN
from disorder_landscape.model.parameters import BOLTZMANN, TEMPERATURE, FloatArray, Nanowire
from disorder_landscape.model.quantities import CONDUCTANCES, labelled
from disorder_landscape.solver import compiled, tilted_average
from disorder_landscape.solver.energy_grid import ENERGY_SPACING, thermal_grid
from disorder_landscape.solver.quadrature import thermal_quadrature
from disorder_landscape.solver.routes import solver_functions, wires_of

BLOCK_ENERGIES = {"fast": 2**18, "kwant": 2**8, "tilted": 2**14}
"""Energies that each solver is given at a time: about 16 MB and one second."""
BLOCK_SETS = {"fast": 2**12, "tilted": 2**5}
"""Sets (wire, μ, B) that are averaged exactly at a time: one or two seconds."""
BELOW_GAP = 0.98
"""Part of the gap up to which the thermal window is taken as rational in energy."""

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
        In K; 0 gives the bare conductance at ω = bias.
    solver : {"fast", "kwant"}
        The real recursion, or Kwant, the reference, thousands of times slower.
    energy_spacing : float, optional
        Average over a grid of energies of at most this spacing in meV, at most kT, as the paper
        does, instead of exactly. Kwant always does, by default at 0.5 µeV.
    progress : callable, optional
        Told how many pairs (μ, B) have just been done, and how many there are in all.
    theta : float
        Angle of the field relative to the wire in radians, θ of Eq. S1. All but 0, the paper's,
        take a route that is some fifty times slower.

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
        If a grid is empty, unsorted or out of range, the temperature negative, the bias or its
        thermal window beyond the gap, the solver unknown, or the wires of unequal length.
    """
    wires = wires_of(wire)
    delta0 = min(w.delta0 for w in wires)
    grids = {
        "mu": grid_in("mu", mu, -1e3, 1e3, "meV"),
        "B": grid_in("B", B, -100.0, 100.0, "T"),
        "bias": grid_in("bias", bias, -delta0 * (1 - 1e-6), delta0 * (1 - 1e-6), "meV"),
    }
    temperature = number_in("temperature", temperature, 0.0, 10.0, "K")
    theta = number_in("theta", theta, -FULL_TURN, FULL_TURN, "radians")
    dissipative = any(w.dissipation > 0 for w in wires)
    bare = solver_functions(solver, theta, dissipative)[0]
    route = "tilted" if solver == "fast" and theta != 0 else solver
    shape = (len(wires), grids["mu"].size, grids["B"].size)
    told = progress if progress is not None else lambda done, total: None
    exact = temperature > 0 and solver == "fast" and energy_spacing is None
    G = np.empty((*shape, grids["bias"].size, 4))
    error, energies = np.zeros(shape), np.zeros(shape, dtype=np.int64)
    if exact:
        for some, points, fields in _blocks(shape, BLOCK_SETS[route]):
            at = some, points, fields
            G[at], error[at], energies[at] = exact_average(
                wires[some],
                grids["mu"][points],
                grids["B"][fields],
                grids["bias"],
                temperature,
                theta,
            )
            told(error[at].size, error.size)
    else:
        if temperature > 0:
            kT = BOLTZMANN * temperature  # a coarser grid would miss the kernel altogether
            spacing = min(ENERGY_SPACING, kT) if energy_spacing is None else energy_spacing
            spacing = number_in("energy_spacing", spacing, 1e-7, kT, "meV")
            omega, weights = thermal_grid(grids["bias"], temperature, delta0, spacing)
        else:
            omega, weights = _bare_grid(grids["bias"])
        for some, points, fields in _blocks(shape, BLOCK_ENERGIES[route] // omega.size):
            G0 = bare(wires[some], grids["mu"][points], grids["B"][fields], omega)
            G[some, points, fields] = np.einsum("wmbkse,vks->wmbve", G0, weights)
            told(G0[..., 0, 0, 0].size, error.size)
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
    dataset = labelled(xr.Dataset(data, coords=grids, attrs=attrs))
    return dataset.isel(realization=0) if isinstance(wire, Nanowire) else dataset


def exact_average(
    wires: Sequence[Nanowire],
    mu: FloatArray,
    B: FloatArray,
    bias: FloatArray,
    temperature: float,
    theta: float = 0.0,
) -> tuple[FloatArray, FloatArray, NDArray[np.int64]]:
    """Return the thermal average, its estimated error and the number of energies it took.

    Rational in energy and in closed form where the thermal window stays below the gap
    (`compiled`, `tilted_average`); by adaptive quadrature (`quadrature`) where it does
    not or the wire has dissipation, and for the rare set of which no rational model within the
    tolerance is found.

    Returns
    -------
    G : array, shape (wire, mu, B, bias, 4)
        G_LL, G_RR, G_LR, G_RL in e²/h.
    error, energies : array, shape (wire, mu, B)
    """
    window = abs(bias).max() + compiled.core.REACH * BOLTZMANN * temperature
    dissipative = any(w.dissipation > 0 for w in wires)
    if dissipative or window > BELOW_GAP * min(w.delta0 for w in wires):
        return thermal_quadrature(wires, mu, B, bias, temperature, theta=theta)
    if theta == 0:
        G, error, energies = compiled.thermal_conductance(wires, mu, B, bias, temperature)
    else:
        G, error, energies = tilted_average.thermal_conductance(
            wires, mu, B, bias, temperature, theta
        )
    for w, m, f in np.argwhere(~(error <= compiled.core.TOLERANCE)):
        one = thermal_quadrature(
            [wires[w]], mu[m : m + 1], B[f : f + 1], bias, temperature, theta=theta
        )
        G[w, m, f], error[w, m, f] = one.conductance[0, 0, 0], one.error[0, 0, 0]
        energies[w, m, f] += one.energies[0, 0, 0]
    return G, error, energies


def _bare_grid(bias: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the energies |V| and the weights that pick G₀(V), shape (bias, omega, 2)."""
    omega, index = np.unique(abs(bias), return_inverse=True)
    weights = np.zeros((bias.size, omega.size, 2))
    weights[np.arange(bias.size), index, (bias < 0).astype(int)] = 1.0
    return omega, weights


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
