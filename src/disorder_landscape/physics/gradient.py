"""The derivatives of the conductances with respect to every site's V, and to μ, B and α.

The same real elimination as `recursion`, from both sides, gives the columns of the Green's function
that the derivatives need (`columns`); `contraction` sums them; what the ends and the leads
contribute is in `responses`. As for the conductance, +ω and −ω share all but S: they are sums of
the same six probabilities.

Measured on one AVX-512 core with 300 sites (64 μ × 4 B, one thread, medians of runs interleaved
with `conductance`): 9.5 µs per bias for the paper's five, four of which share their sweeps with
their negative, 3.6 to 4.0 times `conductance` at the same points; 12.5 µs for eight biases of one
sign, 5.0 to 5.4 times `fast_solver.bare_conductance`. Of the latter the contraction takes 6.9 µs,
the sweeps with P 2.2, the ends 0.5, writing 0.3, what is done once for all points about 1.

What bounds it: for one sign 616 multiply-adds and 8 divisions per site and pair (the sweeps 72 and
the divisions, P and Q 128, the turn to the field 64, the forms of V 144, their traces 144, the form
of α 64), where the conductance takes 281 operations in all. The contraction runs at three quarters
of the 28 per ns of the core: waves, α and traces at its limit, the forms of V held up by stores.
"""

from __future__ import annotations

import numba as nb
import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import grid_in, require
from disorder_landscape.physics.columns import Problem
from disorder_landscape.physics.compilation import compile_kernels
from disorder_landscape.physics.fast_solver import GROWTH_LIMIT
from disorder_landscape.physics.gradient_kernel import gradient_kernel
from disorder_landscape.physics.hamiltonian import pairing_factors
from disorder_landscape.physics.labels import CONDUCTANCES, LABELS, labelled
from disorder_landscape.physics.lead_slopes import lead_slopes
from disorder_landscape.physics.leads import lead_self_energies
from disorder_landscape.physics.parameters import FloatArray, Nanowire
from disorder_landscape.physics.pivoted_gradient import pivoted_gradient

PARAMETERS = {"V": "meV", "mu": "meV", "B": "T", "alpha": "meV nm"}
"""What is varied, and its unit."""


def _prepare(wire: Nanowire, mu: FloatArray, B: FloatArray, bias: FloatArray) -> Problem:
    t, s, ds = wire.hopping, wire.spin_orbit_hopping, 1 / (2 * wire.lattice)
    hop, phi = np.hypot(t, s), np.arctan2(s, t)
    omega, which = np.unique(abs(bias), return_inverse=True)
    biases = np.full((omega.size, 2), -1)
    biases[which, (bias < 0).astype(int)] = np.arange(bias.size)
    sites = np.arange(wire.sites)
    log_hop_slope, phi_slope = s * ds / hop**2, t * ds / hop**2
    normal, anomalous = pairing_factors(wire, omega)
    sigma = np.array([lead_self_energies(wire, field, omega) for field in B])
    slopes = lead_slopes(wire, B, omega, sigma)
    end, i_sigma_y = phi * sites[-1], np.array([[0.0, 1.0], [-1.0, 0.0]])
    U = np.cos(end) * np.eye(2) - np.sin(end) * i_sigma_y
    sigma[:, :, 1] = U.T @ sigma[:, :, 1] @ U
    slopes[:, :, :, 1] = U.T @ slopes[:, :, :, 1] @ U
    turned = i_sigma_y @ sigma[:, :, 1] - sigma[:, :, 1] @ i_sigma_y
    slopes[:, :, 1, 1] += phi_slope * sites[-1] * turned
    slopes[:, :, 1] -= log_hop_slope * sigma
    turn = (np.pi / 4 - phi * sites + np.pi / 2) % np.pi - np.pi / 2
    return Problem(
        hop=hop,
        zeeman_per_tesla=wire.zeeman_per_tesla / hop,
        V=wire.potential_with_barriers / hop,
        along=np.stack([np.cos(2 * phi * sites), np.sin(2 * phi * sites)], axis=1),
        turns=np.stack([np.tan(turn / 2), np.sin(turn)], axis=1),
        log_hop_slope=log_hop_slope,
        angle_slope=phi_slope * sites,
        zeeman=wire.zeeman_per_tesla * B / hop,
        kinetic=(2 * t - mu) / hop,
        normal=(omega + normal) / hop,
        anomalous=anomalous / hop,
        biases=biases,
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
        If the wire is not one or has dissipation, or a grid is empty, unsorted or out of range.
    """
    require(isinstance(wire, Nanowire), "wire", "be a Nanowire", f"it is {wire!r}")
    require(wire.dissipation == 0, "wire", "have no dissipation for slopes", "it has")
    edge = wire.delta0 * (1 - 1e-6)
    grids = {
        "mu": grid_in("mu", mu, -1e3, 1e3, "meV"),
        "B": grid_in("B", B, -100.0, 100.0, "T"),
        "bias": grid_in("bias", bias, -edge, edge, "meV"),
    }
    compile_kernels()
    p = _prepare(wire, *grids.values())
    shape = grids["B"].size, grids["mu"].size, grids["bias"].size
    rows = 1 + np.prod(shape)  # the last is for lanes that have no bias of the sign at hand
    all_V, all_others = np.empty((4, rows * wire.sites)), np.empty((4, rows * 3))
    growth = np.empty((shape[0], shape[1] * p.normal.size))
    gradient_kernel(p, nb.get_num_threads(), all_V, all_others, growth)
    by_V = all_V[:, : -wire.sites].reshape(4, *shape, wire.sites)
    others = all_others[:, :-3].reshape(4, *shape, 3)
    for field, pair in np.argwhere(~(growth < growth_limit)):  # so that NaN pivots too
        m, energy = divmod(pair, p.normal.size)
        pivoted_gradient(p, field, m, energy, by_V[:, field, m], others[:, field, m])
    data: dict[str, object] = {}
    for k, name in enumerate(CONDUCTANCES):
        for i, parameter in enumerate(PARAMETERS):
            values = (by_V[k] if i == 0 else others[k, ..., i - 1]).swapaxes(0, 1)
            dims = (*grids, "site") if i == 0 else tuple(grids)
            attrs = {
                "long_name": f"derivative of the {LABELS[name][0]} with respect to {parameter}",
                "units": f"e^2/h/({PARAMETERS[parameter]})",
            }
            data[f"d{name}_d{parameter}"] = (dims, values, attrs)
    coordinates = {**grids, "site": np.arange(wire.sites)}
    return labelled(xr.Dataset(data, coords=coordinates, attrs={"temperature": 0.0}))
