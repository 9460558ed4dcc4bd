"""The derivatives of the conductances with respect to every site's V, and to μ, B and α.

The same real elimination as `recursion`, from both sides, gives the columns of the Green's function
that the derivatives need (`columns`); what the ends and the leads contribute is in `responses`.

Measured on one AVX-512 core with 300 sites (64 μ × 4 B × 8 biases, one thread, medians of runs
interleaved with `fast_solver.bare_conductance`): 18 µs per point, 7.7 times the conductance. The
products of `contraction` take over half of it, the two sweeps and the waves about a quarter.
"""

from __future__ import annotations

import numba as nb
import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import grid_in, require
from disorder_landscape.physics.compilation import compile_kernels
from disorder_landscape.physics.fast_solver import GROWTH_LIMIT
from disorder_landscape.physics.gradient_kernel import Problem, gradient_kernel
from disorder_landscape.physics.hamiltonian import pairing_factors
from disorder_landscape.physics.labels import CONDUCTANCES, LABELS, labelled
from disorder_landscape.physics.leads import lead_self_energies
from disorder_landscape.physics.parameters import FloatArray, Nanowire
from disorder_landscape.physics.pivoted_gradient import pivoted_gradient
from disorder_landscape.physics.responses import lead_slopes

PARAMETERS = {"V": "meV", "mu": "meV", "B": "T", "alpha": "meV nm"}
"""What is varied, and its unit."""


def _prepare(wire: Nanowire, mu: FloatArray, B: FloatArray, bias: FloatArray) -> Problem:
    t, s, ds = wire.hopping, wire.spin_orbit_hopping, 1 / (2 * wire.lattice)
    hop, phi, omega = np.hypot(t, s), np.arctan2(s, t), abs(bias)
    sites = np.arange(wire.sites)
    log_hop_slope, phi_slope = s * ds / hop**2, t * ds / hop**2
    normal, anomalous = pairing_factors(wire, omega)
    sigma = np.array([lead_self_energies(wire, field, omega) for field in B])
    slopes = np.array(
        [lead_slopes(wire, field, omega, of) for field, of in zip(B, sigma, strict=True)]
    )
    end, i_sigma_y = phi * sites[-1], np.array([[0.0, 1.0], [-1.0, 0.0]])
    U = np.cos(end) * np.eye(2) - np.sin(end) * i_sigma_y
    sigma[:, :, 1] = U.T @ sigma[:, :, 1] @ U
    slopes[:, :, :, 1] = U.T @ slopes[:, :, :, 1] @ U
    turned = i_sigma_y @ sigma[:, :, 1] - sigma[:, :, 1] @ i_sigma_y
    slopes[:, :, 1, 1] += phi_slope * sites[-1] * turned
    slopes[:, :, 1] -= log_hop_slope * sigma
    return Problem(
        hop=hop,
        zeeman_per_tesla=wire.zeeman_per_tesla / hop,
        V=wire.potential_with_barriers / hop,
        angle=phi * sites,
        log_hop_slope=log_hop_slope,
        angle_slope=phi_slope * sites,
        zeeman=wire.zeeman_per_tesla * B / hop,
        kinetic=(2 * t - mu) / hop,
        normal=(omega + normal) / hop,
        anomalous=anomalous / hop,
        hole=(bias < 0).astype(np.int64),
        sigma=sigma / hop,
        slopes=slopes / hop,
    )


def conductance_gradient(
    wire: Nanowire,
    mu: ArrayLike,
    B: ArrayLike,
    bias: ArrayLike = 0.0,
    growth_limit: float = GROWTH_LIMIT,
) -> xr.Dataset:
    """Return the derivatives of the bare conductances of a wire, at T = 0 and ω = bias.

    Parameters
    ----------
    wire : Nanowire
    mu, B, bias : float or array
        Chemical potentials in meV, fields in T, biases in meV within the gap; increasing.
    growth_limit : float
        Points at which real elimination grows beyond it are solved by pivoting.

    Returns
    -------
    xarray.Dataset
        For each of G_LL, G_RR, G_LR, G_RL: dG_LL_dV, dims (mu, B, bias, site), in e²/h per meV, and
        dG_LL_dmu, dG_LL_dB, dG_LL_dalpha, dims (mu, B, bias), in e²/h per meV, T and meV nm. The
        leads' field follows B, their spin–orbit coupling follows α unless `lead_alpha` is given;
        their chemical potential does not follow μ.

    Raises
    ------
    ArgumentError
        If the wire is not one, or a grid is empty, unsorted or out of range.
    """
    require(isinstance(wire, Nanowire), "wire", "be a Nanowire", f"it is {wire!r}")
    edge = wire.delta0 * (1 - 1e-6)
    grids = {
        "mu": grid_in("mu", mu, -1e3, 1e3, "meV"),
        "B": grid_in("B", B, -100.0, 100.0, "T"),
        "bias": grid_in("bias", bias, -edge, edge, "meV"),
    }
    compile_kernels()
    p = _prepare(wire, *grids.values())
    B_size, pairs = grids["B"].size, grids["mu"].size * grids["bias"].size
    by_V, growth = np.empty((4, B_size, pairs, wire.sites)), np.empty((B_size, pairs))
    others = np.empty((B_size, pairs, 4, 3))
    gradient_kernel(p, nb.get_num_threads(), by_V, others, growth)
    for field, pair in np.argwhere(~(growth < growth_limit)):  # so that NaN pivots too
        pivoted_gradient(p, field, pair, by_V[:, field, pair], others[field, pair])
    shape = B_size, grids["mu"].size, grids["bias"].size
    data: dict[str, object] = {}
    for k, name in enumerate(CONDUCTANCES):
        for i, parameter in enumerate(PARAMETERS):
            values = by_V[k] if i == 0 else others[:, :, k, i - 1, None]
            values = values.reshape(*shape, -1).swapaxes(0, 1)
            dims = (*grids, "site") if i == 0 else tuple(grids)
            attrs = {
                "long_name": f"derivative of the {LABELS[name][0]} with respect to {parameter}",
                "units": f"e^2/h/({PARAMETERS[parameter]})",
            }
            data[f"d{name}_d{parameter}"] = (dims, values if i == 0 else values[..., 0], attrs)
    coordinates = {**grids, "site": np.arange(wire.sites)}
    return labelled(xr.Dataset(data, coords=coordinates, attrs={"temperature": 0.0}))
