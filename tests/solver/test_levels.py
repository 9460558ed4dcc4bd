"""What the exact average is made of: vectors, small eigenproblems, the levels, the poles' start."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import eigh
from scipy.optimize import brentq

from disorder_landscape.model.hamiltonian import wire_hamiltonian
from disorder_landscape.model.parameters import BIAS, BOLTZMANN
from disorder_landscape.solver import compiled
from random_wires import random_wire

of_core = compiled.core.internals
SETS, COLUMNS = of_core.SETS, of_core.COLUMNS


def test_vectors():
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=COLUMNS), rng.normal(size=COLUMNS + 1)
    y = b[1:]
    out = of_core.lanes(a, y)
    assert_allclose(out[0], a + y * a - a / y, rtol=1e-14, atol=1e-14)
    assert_array_equal(out[1], np.where(a > y, np.sqrt(abs(a)), 2.0))


@pytest.mark.parametrize("n", [1, 2, 3, 17, 96])
def test_eigenvalues_of_pencils(n):
    rng = np.random.default_rng(n)
    root, K = rng.normal(size=(2, SETS, n, n))
    b = rng.normal(size=(SETS, n, 8))
    N, K = root @ root.swapaxes(1, 2) + np.eye(n), K + K.swapaxes(1, 2)
    over = np.linalg.inv(np.linalg.cholesky(N))
    A = over @ K @ over.swapaxes(1, 2)
    found, _, rows = of_core.diagonalise(*of_core.tridiagonalise(A, over @ b))
    for l in range(SETS):
        expected, vectors = eigh(K[l], N[l])
        by_size = np.argsort(found[l])
        assert_allclose(found[l, by_size], expected, atol=1e-11 * abs(expected).max())
        seen = vectors.T @ b[l]  # eigenvectors have no sign
        for mine, other in zip(rows[l, by_size], seen, strict=True):
            assert_allclose(np.outer(mine, mine), np.outer(other, other), atol=1e-9)


def test_nan_stays_with_its_set():
    rng = np.random.default_rng(3)
    d, e = rng.normal(size=(2, SETS, 9))
    alone = of_core.diagonalise(d, e, np.ones((SETS, 9, 8)))[0]
    d[4, 5] = np.nan
    with_nan = of_core.diagonalise(d, e, np.ones((SETS, 9, 8)))[0]
    others = np.arange(SETS) != 4
    assert_array_equal(with_nan[others], alone[others])
    assert np.isnan(with_nan[4]).any()


def test_dependent_directions_are_left_out():
    """Of wires with 3, 4 … levels, five nodes make pencils of just those levels."""
    rng = np.random.default_rng(0)
    omega, W = np.linspace(0.1, 1.0, 5), SETS
    shape = (W, omega.size, 8, 8)
    G, slope = np.zeros(shape), np.zeros(shape)
    energies, weights = [], []
    signs = np.where(np.arange(8)[:, None] // 4 == np.arange(8) // 4, 1, 0)
    for l in range(W):
        E, w = np.sort(rng.uniform(0.3, 2.0, 3 + l)), rng.normal(size=(3 + l, 8))
        energies.append(E)
        weights.append(w)
        for k, x in enumerate(omega):
            for e, a in zip(E, w, strict=True):
                even, odd = x / (x**2 - e**2), e / (x**2 - e**2)
                G[l, k] += np.outer(a, a) * np.where(signs, even, odd)
                even, odd = -(x**2 + e**2), -2 * x * e
                slope[l, k] += np.outer(a, a) * np.where(signs, even, odd) / (x**2 - e**2) ** 2
        # completeness: b bᵀ of all levels is 1, as ωG₋₋ − 1 is taken
        G[l, :, 4:, 4:] += (np.eye(4) - w[:, 4:].T @ w[:, 4:]) / omega[:, None, None]
        slope[l, :, 4:, 4:] -= (np.eye(4) - w[:, 4:].T @ w[:, 4:]) / omega[:, None, None] ** 2
    found = of_core.levels_from_ends(omega, G, slope)
    assert max(E.size for E, _ in found) == 3 + W - 1
    for l, (E, weight) in enumerate(found):
        seen = np.abs(weight).sum(axis=1) > 1e-9
        assert seen.sum() == 3 + l
        by_size = np.argsort(E[seen])
        assert_allclose(E[seen][by_size], energies[l], atol=1e-8)
        for mine, other in zip(weight[seen][by_size], weights[l], strict=True):
            assert_allclose(np.outer(mine, mine), np.outer(other, other), atol=1e-6)


RIGHT, LEFT = np.array([0.0, 0.0, 0.3, 0.1]), np.array([0.5, -0.2, 0.0, 0.0])
NOTHING = np.zeros(4)


@pytest.mark.parametrize(
    ("E", "found", "true"),
    [  # what is known of b of each level at first, and what it is
        # a level of rounding errors, and what Eb says wrongly of the other
        ([0.0, 1e-4], [(1e-6 * RIGHT, NOTHING), (RIGHT, 1.004 * LEFT)], [NOTHING, LEFT]),
        ([4e-5, 1e-4], [(1e-6 * RIGHT, 0.01 * LEFT), (RIGHT, 0.996 * LEFT)], [0.01 * LEFT, LEFT]),
        # a Majorana mode whose partner is out of sight
        ([0.0, 0.1], [(NOTHING, NOTHING), (RIGHT, LEFT)], [RIGHT, LEFT]),
        # … beside a low level that is seen
        ([0.0, 5e-4], [(NOTHING, NOTHING), (RIGHT, LEFT)], [RIGHT, LEFT]),
        ([0.0, 5e-4], [(NOTHING, NOTHING), (RIGHT, LEFT)], [LEFT, LEFT]),
        # the sign of b relative to a is kept
        ([2e-4, 0.1], [(LEFT, -0.9 * RIGHT), (RIGHT, LEFT)], [-RIGHT, LEFT]),
    ],
)
def test_low_levels_are_completed(E, found, true):
    omega, E, b = 0.03, np.array(E), np.array(true)
    weight = np.array([np.concatenate(pair) for pair in found])
    G = np.zeros((8, 8))
    G[4:, 4:] = np.einsum("ji,jk,j->ik", b, b, omega / (omega**2 - E**2))
    weight = of_core.complete_low_levels(omega, G, E, weight)
    assert_array_equal(weight[:, :4], [a for a, _ in found])
    assert_allclose(weight[:, 4:], b, atol=1e-7)


@pytest.mark.parametrize(("mu", "B"), [(0.3, 0.0), (0.2, 0.5), (0.5, 0.3)])
def test_the_levels_are_those_of_the_hamiltonian(mu, B):
    """Which depends on the energy: E is a level where H(E) has the eigenvalue E."""
    wire = random_wire(2, sites=60)
    bias, kT = np.array(BIAS), BOLTZMANN * 0.05
    window = abs(bias).max() + compiled.core.REACH * kT
    sets = of_core.levels_of_wire(*compiled.handed_over([wire]), mu, B, bias, kT, 12)
    E, weight = sets[0]
    for other, _ in sets[1:]:
        assert_array_equal(other, E)

    def eigenvalues(omega):
        return np.linalg.eigvalsh(wire_hamiltonian(wire, mu, B, omega))

    def above(omega, n):
        return eigenvalues(omega)[n] - omega

    at_zero, at_window = eigenvalues(0.0), eigenvalues(window) - window
    crossing = np.flatnonzero((at_zero > 0) & (at_window < 0))
    expected = [brentq(above, 0.0, window, (n,), xtol=1e-13) for n in crossing]
    assert len(expected) > 0
    seen = wire.rotated_hopping * (weight**2).sum(axis=1) > 1e-8  # the others are no levels
    found = E[seen & (E < window)]
    assert_allclose(np.sort(found), np.sort(expected), atol=1e-8)


@pytest.mark.parametrize("n", [1, 2, 6, 24])
def test_jacobi_rotations(n):
    rng = np.random.default_rng(n)
    H = np.diag(rng.uniform(-0.1, 0.1, n)) - 0.01j * np.diag(rng.uniform(0.1, 1, n))
    mixing = 1e-3 * (rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n)))
    H = H + mixing + mixing.T
    rotated, Q = of_core.diagonalise_nearly(H)
    assert_allclose(Q @ Q.T, np.eye(n), atol=1e-10)
    assert_allclose(Q @ H @ Q.T, rotated, atol=1e-12)
    distance = abs(np.diag(rotated)[:, None] - np.diag(rotated))
    assert (abs(rotated - np.diag(np.diag(rotated))) <= of_core.MIXING * distance + 1e-18).all()
    expected, found = np.linalg.eig(H)[0], np.linalg.eig(rotated)[0]
    assert_allclose(abs(found[:, None] - expected).min(axis=1), 0, atol=1e-10)
