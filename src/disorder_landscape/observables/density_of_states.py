"""Where in a wire electrons and holes of an energy are: the local density of states.

It is −Im Tr G/π on each site, G the Green's function of the wire with its leads. What is thermally
broadened, convolved with −df/dω, is a line integral above the real axis: there G has no poles, so
that two energies for each kT are enough, however narrow its peaks are.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import grid_in, number_in, require, shown
from disorder_landscape.model.hamiltonian import FULL_TURN, ComplexArray
from disorder_landscape.model.parameters import BOLTZMANN, FloatArray, Nanowire
from disorder_landscape.model.quantities import with_units
from disorder_landscape.model.ranges import checked_temperature
from disorder_landscape.observables.grids import checked_mu_and_B
from disorder_landscape.solver import compiled_green
from disorder_landscape.solver.compiled import GROWTH_LIMIT
from disorder_landscape.solver.lead_continuation import continued_self_energies

LIMIT = 100.0
"""Largest |energy| that is accepted, in meV."""
NEAREST = 1e-9
"""An energy nearer to ±Δ₀ than this part of it is taken that far below it: there Σ is infinite."""
HEIGHT = np.pi / 2
"""How far in kT the line of integration is above the real axis: halfway to the kernel's pole."""
SPACING = 0.5
"""Distance in kT of the energies on it; the rule's error is exp(−2π HEIGHT/SPACING) = 3e-9."""
REACH = 20.0
"""The line reaches this many kT beyond the energies, where 2e-9 of the kernel is cut."""
NARROWEST = 1e-9
"""Width in meV that a peak has where a part of the wire has a level at an energy: 1e-6 of G is lost
then, and all of it without."""
SIZE = 2**22
"""Numbers (B, energy, site) that are calculated at a time."""


def local_density_of_states(
    wire: Nanowire,
    mu: ArrayLike,
    B: ArrayLike,
    energy: ArrayLike,
    temperature: float = 0.0,
    theta: float = 0.0,
) -> xr.Dataset:
    """Return the local density of states of a wire with its leads attached.

    Parameters
    ----------
    wire : Nanowire
    mu, B, energy : float or array
        Chemical potentials in meV, fields in T, energies in meV from the Fermi level; increasing.
        Energies above the gap are allowed.
    temperature : float
        In K. 0 gives what is at these very energies, where a peak may be too narrow for any grid;
        else it is broadened by −df/dω, as a tunnelling probe sees it.
    theta : float
        Angle of the field relative to the wire in radians.

    Returns
    -------
    xarray.Dataset
        LDOS_electron and LDOS_hole, dims (mu, B, energy, site), in 1/meV per site, summed over the
        spin. The hole part at an energy is the electron part at minus the energy.

    Raises
    ------
    ArgumentError
        If the wire is not one, a grid is empty, unsorted or out of range, or the temperature is.
    """
    require(isinstance(wire, Nanowire), "wire", "be a Nanowire", f"it is {shown(wire)}")
    grids = {
        **checked_mu_and_B(mu, B),
        "energy": grid_in("energy", energy, -LIMIT, LIMIT, "meV"),
    }
    temperature = checked_temperature(temperature)
    theta = number_in("theta", theta, -FULL_TURN, FULL_TURN, "radians")
    density = np.empty((*(grid.size for grid in grids.values()), wire.sites, 2))
    for f, field in enumerate(grids["B"].tolist()):
        there = wire.in_field(field)
        if temperature > 0:
            z, weights = _line(grids["energy"], BOLTZMANN * temperature)
        else:
            z, weights = _off_the_edge(grids["energy"], there.delta0).astype(complex), None
        sigma = _leads(there, field, z, theta)
        at_once = max(1, SIZE // (z.size * wire.sites))
        for first in range(0, grids["mu"].size, at_once):
            some = slice(first, first + at_once)
            G = _green(there, grids["mu"][some], field, z, sigma, theta)
            averaged = G if weights is None else np.moveaxis(np.tensordot(weights, G, (1, 1)), 1, 0)
            density[some, f] = -averaged.imag / np.pi
    dims = (*grids, "site")
    data = {f"LDOS_{name}": (dims, density[..., k]) for k, name in enumerate(("electron", "hole"))}
    attrs = {"temperature": temperature, "theta": theta}
    coordinates = {**grids, "site": np.arange(wire.sites)}
    return with_units(xr.Dataset(data, coords=coordinates, attrs=attrs))


def _line(energy: FloatArray, kT: float) -> tuple[ComplexArray, ComplexArray]:
    """Return energies above the real axis, shape (z,), and weights of G there, (energy, z)."""
    step = SPACING * kT
    reach = int(np.ceil(REACH / SPACING))
    nearest = np.round((energy - energy[0]) / step)
    about = nearest[:, None] + np.arange(-reach, reach + 1)  # nothing where no energy is near
    z = energy[0] + step * np.unique(about) + 1j * HEIGHT * kT
    kernel = (
        step
        / (4 * kT)
        / np.cosh(np.clip((z - energy[:, None]).real / (2 * kT), -300, 300) + 1j * HEIGHT / 2) ** 2
    )
    return z, kernel


def _off_the_edge(energy: FloatArray, delta0: float) -> FloatArray:
    """Return the energies, those at ±Δ₀ moved a little below."""
    at_edge = abs(abs(energy) - delta0) < NEAREST * delta0
    return np.where(at_edge, np.copysign(delta0 * (1 - NEAREST), energy), energy)


def _leads(wire: Nanowire, B: float, z: ComplexArray, theta: float) -> ComplexArray:
    """Return Σ of the leads, shape (z, lead, charge, 2, 2)."""
    if z[0].imag > 0:
        return continued_self_energies(wire, B, z, theta)
    return compiled_green.lead_self_energies(wire, B, np.ascontiguousarray(z.real), theta)


def _green(
    wire: Nanowire,
    mu: FloatArray,
    B: float,
    z: ComplexArray,
    sigma: ComplexArray,
    theta: float,
) -> ComplexArray:
    """Return G summed over the spin, shape (mu, z, site, 2); NARROWEST above where digits fail."""
    G, growth = compiled_green.local_green(wire, mu, np.array([B]), z, sigma[None], theta)
    for m, e in np.argwhere(~(growth[:, 0] < GROWTH_LIMIT)):
        above, some = z[[e]] + 1j * NARROWEST, slice(m, m + 1)
        G[some, 0, e] = compiled_green.local_green(
            wire, mu[some], np.array([B]), above, sigma[None, [e]], theta
        )[0][:, 0, 0]
    return G[:, 0]
