"""The derivatives of the conductances with respect to every site's V, and to μ, B and α.

The same real elimination as `recursion`, from both sides, gives the columns of the Green's function
that the derivatives need (`columns`); what the ends and the leads contribute is in `responses`.
"""

from __future__ import annotations

from typing import NamedTuple

import numba as nb
import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from disorder_landscape.arguments import grid_in, require
from disorder_landscape.physics import columns
from disorder_landscape.physics.ends import end_green_functions
from disorder_landscape.physics.fast_solver import GROWTH_LIMIT
from disorder_landscape.physics.hamiltonian import ComplexArray, pairing_factors
from disorder_landscape.physics.labels import CONDUCTANCES, LABELS, labelled
from disorder_landscape.physics.leads import lead_self_energies
from disorder_landscape.physics.parameters import FloatArray, Nanowire
from disorder_landscape.physics.pivoted_gradient import pivoted_gradient
from disorder_landscape.physics.recursion import C_AT, D_AT, E_AT, LANES, STATE
from disorder_landscape.physics.responses import end_responses, lead_slopes

PARAMETERS = {"V": "meV", "mu": "meV", "B": "T", "alpha": "meV nm"}
"""What is varied, and its unit."""


class Problem(NamedTuple):
    """What the kernel needs, in units of the wire's t' = √(t² + (α/2a)²)."""

    hop: float  # t' in meV
    zeeman_per_tesla: float
    V: FloatArray  # (site,), with barriers
    angle: FloatArray  # (site,), φn
    log_hop_slope: float  # d ln t'/dα
    angle_slope: FloatArray  # (site,), d(φn)/dα
    zeeman: FloatArray  # (B,)
    kinetic: FloatArray  # (mu,), 2t − μ
    normal: FloatArray  # (bias,), ω + γω/√(Δ₀²−ω²) at ω = |bias|
    anomalous: FloatArray  # (bias,), γΔ₀/√(Δ₀²−ω²)
    hole: NDArray[np.int64]  # (bias,), 1 if the bias is negative
    sigma: ComplexArray  # (B, bias, lead, charge, 2, 2), in the rotated frame
    slopes: ComplexArray  # (B, bias, 2, lead, charge, 2, 2), d/dB and d/dα of sigma


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


@nb.njit(cache=True)
def _sweep(
    b: FloatArray, sites: FloatArray, V: FloatArray, x: FloatArray, z: FloatArray, s: FloatArray
) -> None:  # pragma: no cover
    """Fill the sites' records, and E, C and D of M' into s as `eliminate_inner_sites` does."""
    L, last = LANES, V.size - 1
    P = columns.P_AT * L
    columns.start(b, V[last - 1], x[last - 1], z[last - 1])
    for n in range(last - 1, 0, -1):
        columns.factor(b, sites[n], V[n - 1], x[n - 1], z[n - 1])
    for k in range(10 * L):
        s[E_AT * L + k] = b[columns.D_AT * L + k]
    columns.start(b, V[1], x[1], z[1])
    for k in range(16 * L):
        sites[0, P + k] = 1.0 if k // L % 5 == 0 else 0.0
    for n in range(1, last):
        columns.carry(sites[n], sites[n - 1, P:], sites[n, P:])
        columns.factor(b, sites[n], V[n + 1], x[n + 1], z[n + 1])
    for k in range(10 * L):
        s[D_AT * L + k] = b[columns.D_AT * L + k]
    for i in range(4):
        for j in range(4):
            for l in range(L):
                entry = sites[last - 1, P + (4 * j + i) * L + l]
                s[(C_AT + 4 * i + j) * L + l] = entry if j < 2 else -entry


@nb.njit(cache=True)
def _weigh(b: FloatArray, Y: ComplexArray, l: int) -> None:  # pragma: no cover
    """Write S, the symmetric part of −2 Re Y, into lane l's tiles; clear the forms beside it."""
    L = LANES
    for column in range(4):
        for row in range(column + 1):
            for entry in range(4):
                i, j = 2 * row + entry // 2, 2 * column + entry % 2
                at = columns.FORMS + 24 * (column * (column + 1) // 2 + row) + 6 * entry
                b[at * L + l], b[(at + 1) * L + l] = 0.0, 0.0
                for k in range(4):
                    S = -(Y[k, i, j] + Y[k, j, i]).real * (1 if i == j else 2)
                    b[(at + 2 + k) * L + l] = S if i <= j else 0.0


@nb.njit(cache=True)
def _collect(
    b: FloatArray, p: Problem, field: int, l: int, ends: FloatArray, out: FloatArray
) -> None:  # pragma: no cover
    """Write the derivatives with respect to μ, B and α into out, shape (4, 3)."""
    L = LANES
    for k in range(4):
        by_field, by_turn = 0.0, 0.0
        for entry in range(40):
            at = (columns.FORMS + 6 * entry) * L + l
            by_field += b[at] * b[at + (2 + k) * L]
            by_turn += b[at + L] * b[at + (2 + k) * L]
        total, weighted = b[(columns.SUM + k) * L + l], b[(columns.V_SUM + k) * L + l]
        scaled = b[columns.KINETIC * L + l] * total + weighted + p.zeeman[field] * by_field
        out[k, 0] = total / p.hop
        out[k, 1] = ends[k, 0] - p.zeeman_per_tesla * by_field
        out[k, 2] = ends[k, 1] + by_turn + p.log_hop_slope * scaled


@nb.njit(cache=True, parallel=True)
def _gradient_kernel(
    p: Problem, by_V: FloatArray, others: FloatArray, growth: FloatArray
) -> None:  # pragma: no cover
    """Fill by_V (B, mu·bias, 4, site), others (B, mu·bias, 4, 3) and the growth (B, mu·bias)."""
    L, biases = LANES, p.normal.size
    fields, pairs, _, sites = by_V.shape
    per_hop = 1.0 / p.hop
    pieces = (pairs + L - 1) // L
    for task in nb.prange(fields * pieces):
        field, first = task // pieces, task % pieces * L
        b, s = np.zeros(columns.ENTRIES * L), np.empty(STATE * L)
        records, Q = np.empty((sites, columns.RECORD * L)), np.zeros((3, 16 * L))
        re, im, energy = np.empty(64 * L), np.empty(64 * L), np.empty(L, dtype=np.int64)
        for l in range(L):
            pair = min(first + l, pairs - 1)
            energy[l] = pair % biases
            w, a = p.normal[energy[l]], p.anomalous[energy[l]]
            b[columns.KINETIC * L + l] = p.kinetic[pair // biases]
            b[columns.NORMAL * L + l], b[columns.ANOMALOUS * L + l] = w, a
            b[columns.SCALED * L + l] = -p.log_hop_slope * w
            b[(columns.SCALED + 1) * L + l] = -p.log_hop_slope * a
        x, z = p.zeeman[field] * np.cos(2 * p.angle), p.zeeman[field] * np.sin(2 * p.angle)
        _sweep(b, records, p.V, x, z, s)
        end_green_functions(s, p.sigma[field], energy, re, im)
        G, Y = np.empty((8, 8), dtype=np.complex128), np.empty((4, 8, 8), dtype=np.complex128)
        T, ends = np.empty((4, 2, 8), dtype=np.complex128), np.empty((L, 4, 2))
        for l in range(L):
            for i in range(8):
                for j in range(8):
                    at = (8 * min(i, j) + max(i, j)) * L + l
                    G[i, j] = -complex(re[at], im[at])
            e = energy[l]
            end_responses(G, p.sigma[field, e], p.slopes[field, e], p.hole[e], T, Y, ends[l])
            _weigh(b, Y, l)
        zero, now, after = Q[0], Q[1], Q[2]
        for k in range(16 * L):
            now[k] = 1.0 if k // L % 5 == 0 else 0.0
        for n in range(sites - 1, -1, -1):
            P = records[n, columns.P_AT * L :] if n < sites - 1 else zero
            if 0 < n < sites - 1:
                columns.carry(records[n], now, after)
                now, after = after, now
            turn = 2 * p.zeeman[field] * p.angle_slope[n]
            c, d = np.cos(np.pi / 4 - p.angle[n]), np.sin(np.pi / 4 - p.angle[n])
            columns.contract(b, P, now if n > 0 else zero, p.V[n], c, d, turn)
            for k in range(4 * L):
                records[n, k] = b[columns.SITE_SUM * L + k]  # the record is no longer needed
        for l in range(min(L, pairs - first)):
            growth[field, first + l] = b[columns.GROWTH * L + l]
            _collect(b, p, field, l, ends[l], others[field, first + l])
            for k in range(4):
                for n in range(sites):
                    by_V[field, first + l, k, n] = -records[n, k * L + l] * per_hop


def conductance_gradient(
    wire: Nanowire, mu: ArrayLike, B: ArrayLike, bias: ArrayLike = 0.0
) -> xr.Dataset:
    """Return the derivatives of the bare conductances of a wire, at T = 0 and ω = bias.

    Parameters
    ----------
    wire : Nanowire
    mu, B, bias : float or array
        Chemical potentials in meV, fields in T, biases in meV within the gap; increasing.

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
    return gradient_with_limit(wire, mu, B, bias, GROWTH_LIMIT)


def gradient_with_limit(
    wire: Nanowire, mu: ArrayLike, B: ArrayLike, bias: ArrayLike, growth_limit: float
) -> xr.Dataset:
    """Return `conductance_gradient`; lanes that grow beyond the limit are solved by pivoting."""
    require(isinstance(wire, Nanowire), "wire", "be a Nanowire", f"it is {wire!r}")
    edge = wire.delta0 * (1 - 1e-6)
    grids = {
        "mu": grid_in("mu", mu, -1e3, 1e3, "meV"),
        "B": grid_in("B", B, -100.0, 100.0, "T"),
        "bias": grid_in("bias", bias, -edge, edge, "meV"),
    }
    p = _prepare(wire, *grids.values())
    pairs = grids["mu"].size * grids["bias"].size
    by_V = np.empty((grids["B"].size, pairs, 4, wire.sites))
    others, growth = np.empty((*by_V.shape[:3], 3)), np.empty(by_V.shape[:2])
    _gradient_kernel(p, by_V, others, growth)
    for field, pair in np.argwhere(~(growth < growth_limit)):  # so that NaN pivots too
        pivoted_gradient(p, field, pair, by_V[field, pair], others[field, pair])
    shape = grids["B"].size, grids["mu"].size, grids["bias"].size
    data: dict[str, object] = {}
    for k, name in enumerate(CONDUCTANCES):
        for i, parameter in enumerate(PARAMETERS):
            values = by_V[:, :, k] if i == 0 else others[:, :, k, i - 1, None]
            values = values.reshape(*shape, -1).swapaxes(0, 1)
            dims = (*grids, "site") if i == 0 else tuple(grids)
            attrs = {
                "long_name": f"derivative of the {LABELS[name][0]} with respect to {parameter}",
                "units": f"e^2/h/({PARAMETERS[parameter]})",
            }
            data[f"d{name}_d{parameter}"] = (dims, values if i == 0 else values[..., 0], attrs)
    coordinates = {**grids, "site": np.arange(wire.sites)}
    return labelled(xr.Dataset(data, coords=coordinates, attrs={"temperature": 0.0}))
