"""The derivatives of the conductances with respect to every site's V, and to μ, B and α.

The compiled core does it (core/derivatives): real elimination from both ends gives the columns of
the Green's function that the derivatives need, and a contraction sums them over the sites. As for
the conductance, +ω and −ω share all but the last sums, those of the same six probabilities.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import grid_in, number_in, require, shown
from disorder_landscape.model.parameters import Nanowire
from disorder_landscape.model.quantities import CONDUCTANCES, QUANTITIES, with_units
from disorder_landscape.solver import compiled
from disorder_landscape.solver.compiled import GROWTH_LIMIT
from disorder_landscape.solver.lead_slopes import rotated_lead_slopes

PARAMETERS = {"V": "meV", "mu": "meV", "B": "T", "alpha": "meV nm"}
"""What is varied, and its unit."""


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
        If the wire is not one, has dissipation or a critical field, or a grid is empty, unsorted
        or out of range.
    """
    require(isinstance(wire, Nanowire), "wire", "be a Nanowire", f"it is {shown(wire)}")
    require(wire.dissipation == 0, "wire", "have no dissipation for slopes", "it has")
    without = np.isinf(wire.critical_field)
    require(bool(without), "wire", "have no critical field for slopes", "it has")
    growth_limit = number_in("growth_limit", growth_limit, 0.0, np.inf)
    edge = wire.delta0 * (1 - 1e-6)
    grids = {
        "mu": grid_in("mu", mu, -1e3, 1e3, "meV"),
        "B": grid_in("B", B, -100.0, 100.0, "T"),
        "bias": grid_in("bias", bias, -edge, edge, "meV"),
    }
    omega, which = np.unique(abs(grids["bias"]), return_inverse=True)
    biases = np.full((omega.size, 2), -1)
    biases[which, (grids["bias"] < 0).astype(int)] = np.arange(grids["bias"].size)
    slopes = rotated_lead_slopes(wire, grids["B"], omega)
    by_V, others = compiled.conductance_gradient(
        wire, grids["mu"], grids["B"], omega, biases, slopes, growth_limit
    )
    data: dict[str, object] = {}
    for k, name in enumerate(CONDUCTANCES):
        for i, parameter in enumerate(PARAMETERS):
            values = by_V[k] if i == 0 else others[k, i - 1]
            dims = (*grids, "site") if i == 0 else tuple(grids)
            attrs = {
                "long_name": f"derivative of the {QUANTITIES[name][0]} with respect to {parameter}",
                "units": f"e^2/h/({PARAMETERS[parameter]})",
            }
            data[f"d{name}_d{parameter}"] = (dims, values, attrs)
    coordinates = {**grids, "site": np.arange(wire.sites)}
    return with_units(xr.Dataset(data, coords=coordinates, attrs={"temperature": 0.0}))
