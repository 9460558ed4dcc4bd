"""The gradient of one (μ, B, bias) by complex banded elimination with partial pivoting.

Backward stable at every energy and far slower than `columns`: it takes the points at which real
elimination without pivoting has lost digits, as `pivoted` does for the conductance.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_banded

from disorder_landscape.physics import hamiltonian as h
from disorder_landscape.physics.columns import Problem
from disorder_landscape.physics.ends import CHANNELS, CONDUCTANCE_WEIGHTS
from disorder_landscape.physics.parameters import FloatArray

BANDWIDTH = 4
"""Sub- and superdiagonals of M."""


def pivoted_gradient(
    p: Problem, field: int, mu: int, energy: int, by_V: FloatArray, others: FloatArray
) -> None:
    """Write the derivatives at ±ω into by_V, shape (4, bias, site), and others, (4, bias, 3)."""
    sites, (cosine, sine) = p.V.size, p.along.T[:, :, None, None]
    identity, sigma_z = np.eye(4), h.tau_sigma("0", "z").real
    tau_z, tau_x, sigma_x = h.TAU_Z.real, h.TAU_X.real, h.SIGMA_X.real
    along, across = cosine * sigma_x + sine * sigma_z, cosine * sigma_z - sine * sigma_x
    onsite = p.normal[energy] * identity + p.anomalous[energy] * tau_x - p.zeeman[field] * along
    onsite = onsite - (p.kinetic[mu] + p.V[:, None, None]) * tau_z
    sigma, slopes = p.sigma[field, energy], p.slopes[field, energy]
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
    turn = 2 * p.zeeman[field] * p.angle_slope[:, None, None] * across
    by_alpha = -p.log_hop_slope * onsite - turn
    gamma, gamma_slopes = -2 * sigma.reshape(4, 2, 2).imag, -2 * slopes.reshape(2, 4, 2, 2).imag
    of_V, of_others = np.empty((6, sites)), np.empty((6, 3))
    for q, (a, b) in enumerate(CHANNELS):
        rows, columns = slice(2 * a, 2 * a + 2), slice(2 * b, 2 * b + 2)
        G_ab = G[rows, columns]
        m = gamma[b] @ G_ab.conj().T @ gamma[a]
        Y = (G[:, columns] @ m @ G[rows]).reshape(4, 2, 4, 2)
        answer = 2 * np.einsum("cicj,xcji->x", Y, slopes.reshape(2, 4, 2, 2)).real
        answer += np.trace(gamma_slopes[:, a] @ G_ab @ gamma[b] @ G_ab.conj().T, 0, 1, 2).real
        answer += np.trace(gamma_slopes[:, b] @ G_ab.conj().T @ gamma[a] @ G_ab, 0, 1, 2).real
        responses = -2 * (X[:, :, columns] @ m @ X[:, :, rows].swapaxes(1, 2)).real
        of_V[q] = -np.einsum("nij,ji->n", responses, tau_z) / p.hop
        by_field = np.einsum("nij,nji->", responses, along)
        of_others[q, 0] = -of_V[q].sum()
        of_others[q, 1] = answer[0] - p.zeeman_per_tesla * by_field
        of_others[q, 2] = answer[1] + np.einsum("nij,nji->", responses, by_alpha)
    for weights, bias in zip(CONDUCTANCE_WEIGHTS, p.biases[energy], strict=True):
        if bias >= 0:
            by_V[:, bias], others[:, bias] = weights @ of_V, weights @ of_others
