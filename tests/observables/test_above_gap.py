"""Conductances above the gap, against dense matrices, Kwant, and the real recursion below it."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import arithmetics
from disorder_landscape import Nanowire
from disorder_landscape.model import hamiltonian as h
from disorder_landscape.solver import compiled, compiled_green, kwant_reference
from random_wires import fields, mus, random_wire, seeds

hot_energies = st.floats(0.1200001, 0.6)


def solve(wire, mu, B, omega, **options):
    omega = np.atleast_1d(omega)
    return arithmetics.complex_conductance([wire], np.array([mu]), np.array([B]), omega, **options)[
        0, 0, 0
    ]


def uniform_onsite(wire, mu, B, omega):
    """The onsite matrix without V, with √(Δ₀²−ω²) just above the real axis in ω."""
    root = np.sqrt(wire.delta0 - omega - 1e-300j) * np.sqrt(wire.delta0 + omega + 1e-300j)
    parent = -wire.gamma / root * (omega * np.eye(4) + wire.delta0 * h.TAU_X)
    kinetic = (2 * wire.hopping - mu) * h.TAU_Z
    return kinetic + wire.zeeman_per_tesla * B * h.SIGMA_X + parent


def dense_conductance(wire, mu, B, omega):
    """LL, RR, LR, RL at ω from r and t, with the whole matrix and the roots of Γ."""
    H = h.wire_hamiltonian(wire, mu, B, 0.0)
    n = wire.sites
    uniform = uniform_onsite(wire, mu, B, omega)
    for site, V in enumerate(wire.potential_with_barriers):
        block = slice(4 * site, 4 * site + 4)
        H[block, block] = uniform + V * h.TAU_Z
    sigma = compiled_green.lead_self_energies(wire, B, np.array([omega]))[0]
    roots = []
    for lead, site in ((0, 0), (1, n - 1)):
        for charge in (0, 1):
            at = slice(4 * site + 2 * charge, 4 * site + 2 * charge + 2)
            H[at, at] += sigma[lead, charge]
            value, vector = np.linalg.eigh(-2 * sigma[lead, charge].imag)
            open_ = value > 1e-9
            roots.append((at, vector[:, open_] * np.sqrt(value[open_])))
    G = np.linalg.inv(omega * np.eye(4 * n) - H)

    def probability(out, into):
        (a, left), (b, right) = roots[out], roots[into]
        S = 1j * left.T @ G[a, b] @ right - (np.eye(left.shape[1]) if out == into else 0)
        return (abs(S) ** 2).sum()

    LE, LH, RE, RH = range(4)
    local = [roots[e][1].shape[1] - probability(e, e) + probability(e + 1, e) for e in (LE, RE)]
    into_left = probability(LE, RE) - probability(LH, RE)
    into_right = probability(RE, LE) - probability(RH, LE)
    return np.array([*local, into_left, into_right])


@settings(max_examples=10)
@given(seeds, mus, fields, hot_energies)
@example(3, 0.3, 0.5, 0.1200001)
def test_dense_matrices_give_the_same_at_both_signs(seed, mu, B, omega):
    wire = random_wire(seed, sites=60)
    G = solve(wire, mu, B, omega)[0]
    assert_allclose(G[0], dense_conductance(wire, mu, B, omega), atol=1e-10)
    assert_allclose(G[1], dense_conductance(wire, mu, B, -omega), atol=1e-10)


@settings(max_examples=10)
@given(seeds, mus, fields, hot_energies)
def test_particle_hole_symmetry_holds_on_the_retarded_branch(seed, mu, B, omega):
    wire = random_wire(seed)
    G = solve(wire, mu, B, [omega, -omega])
    assert_allclose(G[1, ::-1], G[0], atol=1e-10)


@settings(max_examples=10)
@given(seeds, mus, fields, hot_energies)
def test_kwant_gives_the_same(seed, mu, B, omega):
    wire = random_wire(seed)
    params = {"B": B, "uniform": uniform_onsite(wire, mu, B, omega)}
    system = kwant_reference.build_system(wire)
    smatrix = kwant_reference.kwant.smatrix(system, omega, params=params, check_hermiticity=False)
    assert_allclose(solve(wire, mu, B, omega)[0], kwant_reference.conductances(smatrix), atol=1e-9)


@settings(max_examples=30)
@given(seeds, mus, fields, st.one_of(st.floats(0.0, 0.1199), st.just(0.12 - 1e-9)))
@example(29, 0.0, 0.0, 0.119999999)
def test_below_the_gap_it_is_the_real_recursion(seed, mu, B, omega):
    wire = random_wire(seed)
    beside = np.array([np.nextafter(omega, -1.0), omega])
    moved, real = compiled.bare_conductance([wire], np.array([mu]), np.array([B]), beside)[0, 0, 0]
    rounding = abs(moved - real).max()  # of ω, next to the gap
    found = solve(wire, mu, B, omega)
    atol = 1e-8 if omega < 0.11999 else 1e-7 + 10 * rounding
    assert_allclose(found.reshape(real.shape), real, atol=atol)


def test_at_the_gap_edge_both_branches_reflect_electrons_as_holes():
    """Σ(ω) is infinite there, so that both channels of either end are perfectly reflected."""
    G = solve(random_wire(1), 0.2, 0.3, [0.12 - 1e-14, 0.12 + 1e-14])
    assert_allclose(G, np.tile([4.0, 4.0, 0.0, 0.0], (2, 2, 1)), atol=2e-3)


@settings(max_examples=10)
@given(seeds, mus, fields, st.floats(0.13, 0.6))
def test_pivoting_changes_nothing(seed, mu, B, omega):
    wire = random_wire(seed)
    pivoted = solve(wire, mu, B, omega, growth_limit=0.0)
    assert_allclose(solve(wire, mu, B, omega), pivoted, atol=1e-10)


def test_without_a_parent_nothing_is_absorbed():
    """γ = 0: a normal wire, at ω > Δ₀ the one below a larger gap; no Andreev reflection."""
    V = np.random.default_rng(5).normal(0, 0.3, 60)
    omega = np.linspace(0.125, 0.4, 40)
    hot = solve(Nanowire(V, gamma=0.0), 0.3, 0.4, omega)
    arguments = [Nanowire(V, gamma=0.0, delta0=1.0)], np.array([0.3]), np.array([0.4]), omega
    assert_allclose(hot, compiled.bare_conductance(*arguments)[0, 0, 0], atol=1e-9)
    assert_allclose(hot[..., 0], hot[..., 3], atol=1e-9)
    almost = solve(Nanowire(V, gamma=1e-9), 0.3, 0.4, omega)
    assert_allclose(hot, almost, atol=1e-3)


@pytest.mark.parametrize("wire", [Nanowire(np.zeros(2)), Nanowire(np.zeros(3), barrier=(0, 0))])
def test_the_shortest_wires(wire):
    for omega in (0.05, 0.13, 0.3):
        dense = dense_conductance(wire, 0.2, 0.5, omega)
        assert_allclose(solve(wire, 0.2, 0.5, omega)[0, 0], dense, atol=1e-12)


def test_lanes_leave_no_trace():
    wires = [random_wire(i, sites=20) for i in range(2)]
    mu, B, omega = np.linspace(0, 0.6, 3), np.array([0.1, 0.7]), np.linspace(0.121, 0.5, 7)
    grid = arithmetics.complex_conductance(wires, mu, B, omega)
    for w, i, j, k in np.ndindex(2, 3, 2, 7):
        np.testing.assert_array_equal(grid[w, i, j, k], solve(wires[w], mu[i], B[j], omega[k])[0])
