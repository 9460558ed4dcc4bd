"""The conductance matrix on grids of μ, B and V_bias, at any temperature, through either solver."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import grid_in, number_in
from disorder_landscape.physics.labels import CONDUCTANCES, labelled
from disorder_landscape.physics.parameters import BOLTZMANN, TEMPERATURE, FloatArray, Nanowire
from disorder_landscape.physics.solvers import solver_functions, wires_of
from disorder_landscape.physics.thermal import ENERGY_SPACING, thermal_grid

BLOCK_ENERGIES = {"fast": 2**18, "kwant": 2**8}
"""Energies that each solver is given at a time: about 16 MB and one second."""

Progress = Callable[[int, int], None]


def conductance(
    wire: Nanowire | Sequence[Nanowire],
    mu: ArrayLike,
    B: ArrayLike,
    bias: ArrayLike = 0.0,
    temperature: float = TEMPERATURE,
    solver: str = "fast",
    energy_spacing: float = ENERGY_SPACING,
    progress: Progress | None = None,
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
    energy_spacing : float
        Largest spacing in meV, at most kT, of the energies that a finite temperature averages over.
    progress : callable, optional
        Told how many energies have just been solved, and how many there are in all.

    Returns
    -------
    xarray.Dataset
        G_LL, G_RR, G_LR, G_RL in e²/h, dims (mu, B, bias), with a leading dim realization for
        several wires.

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
    if temperature > 0:
        kT = BOLTZMANN * temperature  # a coarser grid would miss the kernel altogether
        energy_spacing = number_in("energy_spacing", energy_spacing, 1e-7, kT, "meV")
        omega, weights = thermal_grid(grids["bias"], temperature, delta0, energy_spacing)
    else:
        omega, weights = _bare_grid(grids["bias"])
    bare = solver_functions(solver)[0]
    G = np.empty((len(wires), grids["mu"].size, grids["B"].size, grids["bias"].size, 4))
    shape = (len(wires), grids["mu"].size, grids["B"].size)
    for some, points, fields in _blocks(shape, BLOCK_ENERGIES[solver] // omega.size):
        G0 = bare(wires[some], grids["mu"][points], grids["B"][fields], omega)
        G[some, points, fields] = np.einsum("wmbkse,vks->wmbve", G0, weights)
        if progress is not None:
            progress(G0[..., 0, 0].size, np.prod(shape, dtype=int) * omega.size)
    data = {name: (("realization", *grids), G[..., i]) for i, name in enumerate(CONDUCTANCES)}
    attrs = {"temperature": temperature, "solver": solver}
    dataset = labelled(xr.Dataset(data, coords=grids, attrs=attrs))
    return dataset.isel(realization=0) if isinstance(wire, Nanowire) else dataset


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
