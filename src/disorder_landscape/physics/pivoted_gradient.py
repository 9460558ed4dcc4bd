"""The gradient of one (μ, B, bias) by complex banded elimination with partial pivoting.

Backward stable at every energy and far slower than `columns`: it takes the points at which real
elimination without pivoting has lost digits, as `pivoted` does for the conductance.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_banded

from disorder_landscape.physics import hamiltonian as h
from disorder_landscape.physics.gradient_kernel import Problem
from disorder_landscape.physics.parameters import FloatArray
from disorder_landscape.physics.responses import end_responses

BANDWIDTH = 4
"""Sub- and superdiagonals of M."""


def pivoted_gradient(
    p: Problem, field: int, pair: int, by_V: FloatArray, others: FloatArray
) -> None:
    """Write the derivatives at one point into by_V, shape (4, site), and others, shape (4, 3)."""
    mu, bias = divmod(pair, p.normal.size)
    sites, theta = p.V.size, 2 * p.angle[:, None, None]
    identity, sigma_z = np.eye(4), h.tau_sigma("0", "z").real
    tau_z, tau_x, sigma_x = h.TAU_Z.real, h.TAU_X.real, h.SIGMA_X.real
    along = np.cos(theta) * sigma_x + np.sin(theta) * sigma_z
    across = np.cos(theta) * sigma_z - np.sin(theta) * sigma_x
    onsite = p.normal[bias] * identity + p.anomalous[bias] * tau_x - p.zeeman[field] * along
    onsite = onsite - (p.kinetic[mu] + p.V[:, None, None]) * tau_z
    sigma, slopes = p.sigma[field, bias], p.slopes[field, bias]
    blocks = onsite.astype(complex)
    for lead, n in ((0, 0), (1, -1)):
        for charge in range(2):
            part = slice(2 * charge, 2 * charge + 2)
            blocks[n, part, part] -= sigma[lead, charge]
    bands = np.zeros((2 * BANDWIDTH + 1, 4 * sites), dtype=complex)
    for i in range(4):
        for j in range(4):
            bands[BANDWIDTH + i - j, j::4] = blocks[:, i, j]
    hopping = np.diag(tau_z)
    bands[BANDWIDTH - 4, 4:] = np.tile(hopping, sites - 1)
    bands[BANDWIDTH + 4, :-4] = np.tile(hopping, sites - 1)
    ends = np.zeros((4 * sites, 8))
    ends[:4, :4] = ends[-4:, 4:] = identity
    X = solve_banded((BANDWIDTH, BANDWIDTH), bands, ends).reshape(sites, 4, 8)
    G = np.concatenate([X[0], X[-1]])
    T, Y = np.empty((4, 2, 8), dtype=complex), np.empty((4, 8, 8), dtype=complex)
    answer = np.empty((4, 2))
    end_responses(G, sigma, slopes, p.hole[bias], T, Y, answer)
    turn = 2 * p.zeeman[field] * p.angle_slope[:, None, None] * across
    by_alpha = -p.log_hop_slope * onsite - turn
    for k in range(4):
        a = 2 * p.hole[bias] + (0 if k in (0, 3) else 4)
        responses = -2 * (X @ T[k].T @ X[:, :, a : a + 2].swapaxes(1, 2)).real
        by_V[k] = -np.einsum("nij,ji->n", responses, tau_z) / p.hop
        others[k, 0] = -by_V[k].sum()
        by_field = np.einsum("nij,nji->", responses, along)
        others[k, 1] = answer[k, 0] - p.zeeman_per_tesla * by_field
        others[k, 2] = answer[k, 1] + np.einsum("nij,nji->", responses, by_alpha)
