"""The exact thermal average: against the adaptive integral, and against itself."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import disorder_landscape as dl
from disorder_landscape.arguments import ArgumentError
from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.model.disorder import disorder_realization, potential_from_components
from disorder_landscape.model.parameters import BIAS
from disorder_landscape.solver import compiled
from disorder_landscape.solver.quadrature import thermal_quadrature
from disorder_landscape.solver.routes import thermal_average
from random_wires import random_wire


def point(seed):
    """Return μ, B, five biases and a temperature, drawn from the seed."""
    rng = np.random.default_rng([7, seed])
    mu = rng.uniform(0, 0.6)
    B = 0.0 if seed % 10 == 0 else rng.uniform(0, 0.8)
    bias = np.sort(rng.uniform(-0.05, 0.05, 5))
    return np.array([mu]), np.array([B]), bias, rng.choice([0.02, 0.05, 0.06])


@pytest.mark.brute_force
@pytest.mark.parametrize("seed", [318, 508, 265, 551, 36, 39, 10, 11, 12])
def test_the_estimate_bounds_the_error(seed):
    """Up to a tenth of it. Of the first six, earlier ones were up to 27 times below; 10: B = 0."""
    wire, arguments = random_wire(seed), point(seed)
    found, estimate, _ = thermal_average([wire], *arguments)
    exact = thermal_quadrature([wire], *arguments, panel=0.02, tolerance=1e-9, reach=20.0)
    error = abs(found - exact.conductance).max()
    assert error < 1e-4
    assert error <= 1.1 * estimate.item() + exact.error.item()


@pytest.mark.parametrize("seed", [728, 804])
def test_poles_that_all_but_meet(seed):
    """At ±0.94 − 1433.0i neV, where Rayleigh quotients stand still; at −0.633i and −0.639i µeV."""
    rng = np.random.default_rng([99, seed])
    V = disorder_realization(rng, 5, 300)[1]
    wire = dl.Nanowire(V, alpha=rng.uniform(6.4, 9.6))
    arguments = rng.uniform(0, 0.6, 1), rng.uniform(0, 0.8, 1), np.array(BIAS), 0.05
    found, estimate, energies = thermal_average([wire], *arguments)
    exact = thermal_quadrature([wire], *arguments, panel=0.05, tolerance=1e-8)
    assert abs(found - exact.conductance).max() <= estimate.item() + exact.error.item()
    assert energies.item() == compiled.core.NODES[0] + compiled.core.COMPARED


def test_conductances_are_smooth_where_two_poles_meet_and_part():
    """At −1.666i µeV, of levels at 43 neV whose widths differ by as much: jumps of 0.005 e²/h."""
    components = np.array(
        [
            -0.18085913123333866,
            -0.6884162858499306,
            1.1460079879236569,
            0.08884115133619248,
            -0.9298999588140491,
        ]
    )
    V = potential_from_components(components, 300, 0.0018564955644745748)
    wire = dl.Nanowire(V, alpha=7.849524852248008)
    u = np.linspace(-1, 1, 21)
    mu, B, bias = np.array([0.6 * 2 / 14]), 0.8 * 9 / 14 + 1e-5 * u, np.array(BIAS)
    found, estimate, _ = thermal_average([wire], mu, B, bias, 0.05)
    exact = thermal_quadrature([wire], mu, B[::10], bias, 0.05)
    assert abs(found[:, :, ::10] - exact.conductance).max() <= exact.error.max() < 1e-5
    along_B = found.reshape(u.size, -1)
    smooth = np.polynomial.polynomial.polyfit(u, along_B, 3)
    assert_allclose(along_B, np.polynomial.polynomial.polyval(u, smooth).T, rtol=0, atol=1e-6)
    assert estimate.max() < compiled.core.TOLERANCE


@pytest.mark.slow
def test_conductances_do_not_jump():
    """Of 120,000 sets, at fields so near that they differ by no more than 10⁻⁶ e²/h."""
    B = np.linspace(0.02, 0.8, 20)
    twice, jumps = np.sort(np.concatenate([B, B + 1e-7])), []
    for components in (5, 10):
        config = DatasetConfig(realizations=1, components=components)
        for first in range(900_000, 900_150, 10):
            wires = [realization(config, index).wire for index in range(first, first + 10)]
            G = thermal_average(wires, np.linspace(0, 0.6, 20), twice, np.array(BIAS), 0.05)[0]
            jumps.append(abs(G[:, :, 1::2] - G[:, :, ::2]).max(axis=(-1, -2)).ravel())
    jump = np.concatenate(jumps)
    shares = ", ".join(f"{(jump > limit).sum()} by more than {limit}" for limit in (1e-5, 1e-4))
    print(f"\nof {jump.size} sets {shares}, by {jump.max():.1e} at most")
    assert np.median(jump) < 1e-6
    assert (jump > 1e-4).mean() < 1e-4
    assert jump.max() < 5e-4


def test_two_poles_that_have_just_left_the_imaginary_axis():
    """At ±0.25 − 10.77i µeV; Rayleigh quotients that start on the axis stay there."""
    arguments = np.array([0.15]), np.array([0.7]), np.array(BIAS), 0.05
    found, estimate, _ = thermal_average([random_wire(5, sites=100)], *arguments)
    exact = thermal_quadrature([random_wire(5, sites=100)], *arguments)
    assert abs(found - exact.conductance).max() <= estimate.item() + exact.error.item()


def test_a_level_of_rounding_errors_takes_nothing_from_a_low_one():
    """With 16 nodes there is one at zero beside that at 105 neV; G_LL was 0.08 e²/h too large."""
    components = np.array(
        [
            0.6471930371977946,
            -1.815392761441577,
            1.2266385600725525,
            -2.440481260733323,
            0.7198932178411692,
            -1.1309145405780494,
            -2.3986393420615864,
            0.6979691328109064,
            -1.4962140088667506,
            -1.288146933342429,
        ]
    )
    wire = dl.Nanowire(potential_from_components(components, 300, 0.006685090660780135))
    arguments = np.array([0.6 * 3 / 19]), np.array([0.8 * 8 / 19]), np.array(BIAS), 0.05
    found, estimate, _ = thermal_average([wire], *arguments)
    exact = thermal_quadrature([wire], *arguments)
    assert abs(found - exact.conductance).max() <= estimate.item() + exact.error.item()


@pytest.mark.parametrize("seed", [1, 4, 10])
def test_the_mirror_image_of_a_wire_swaps_left_and_right(seed):
    wire, (mu, B, bias, temperature) = random_wire(seed, sites=150), point(seed)
    mirrored = dl.Nanowire(wire.potential[::-1], alpha=wire.alpha)
    G, error, _ = thermal_average([wire], mu, B, bias, temperature)
    other, other_error, _ = thermal_average([mirrored], mu, B, bias, temperature)
    assert_allclose(G, other[..., [1, 0, 3, 2]], atol=(error + other_error).item(), rtol=0)


@pytest.fixture(scope="module")
def grid():
    wires = [random_wire(seed, sites=100) for seed in (1, 2, 6)]
    return wires, np.linspace(0.05, 0.55, 6), np.array([0.0, 0.3, 0.7]), np.array(BIAS), 0.05


@pytest.fixture(scope="module")
def whole(grid):
    return thermal_average(*grid)


def same(found, expected):
    for a, b in zip(found, expected, strict=True):
        assert_array_equal(a, b)


def test_the_splitting_of_a_grid_leaves_no_trace(grid, whole):
    wires, mu, B, bias, temperature = grid
    for w, m, f in np.ndindex(len(wires), mu.size, B.size):
        alone = thermal_average([wires[w]], mu[m : m + 1], B[f : f + 1], bias, temperature)
        same([part[0, 0, 0] for part in alone], [part[w, m, f] for part in whole])


def test_the_order_of_wires_potentials_and_fields_leaves_no_trace(grid, whole):
    wires, mu, B, bias, temperature = grid
    found = thermal_average(wires[::-1], mu[::-1], B[::-1], bias, temperature)
    same([part[::-1, ::-1, ::-1] for part in found], whole)


def test_the_number_of_threads_leaves_no_trace(grid, whole):
    before = compiled.core.set_threads(1)
    try:
        for threads in (1, 2):
            compiled.core.set_threads(threads)
            same(thermal_average(*grid), whole)
    finally:
        compiled.core.set_threads(before)


def test_what_memory_held_before_leaves_no_trace():
    """Nor what an earlier set of many nodes left in the arrays that a thread keeps."""
    rng = np.random.default_rng(5)
    wires = [dl.Nanowire(disorder_realization(rng, 5, 300)[1], alpha=a) for a in (6.0, 7.0, 9.0)]
    grid = wires, np.linspace(0, 0.6, 5), np.array([0.3, 0.5]), np.array(BIAS), 0.05
    first, junk = thermal_average(*grid), []
    for _ in range(8):
        junk.append(rng.random(rng.integers(1, 30_000)))
        same(thermal_average(*grid), first)


def test_the_number_of_biases_costs_no_accuracy(grid, whole):
    wires, mu, B, bias, temperature = grid
    for k in range(bias.size):
        G, error, _ = thermal_average(wires, mu, B, bias[k : k + 1], temperature)
        apart = abs(G[..., 0, :] - whole[0][..., k, :]).max(axis=-1)
        assert (apart <= 3 * (error + whole[1])).all()
        assert (apart < 1e-4).all()


@pytest.mark.parametrize("temperature", [0.001, 0.05, 0.3])
@pytest.mark.parametrize("sites", [2, 3, 40])
def test_short_wires_cold_and_hot(sites, temperature):
    wire = random_wire(1, sites=sites)
    G = dl.conductance(wire, 0.2, 0.4, 0.01, temperature=temperature)
    expected = thermal_quadrature(
        [wire], np.array([0.2]), np.array([0.4]), np.array([0.01]), temperature
    )
    found = np.stack([G[name] for name in ("G_LL", "G_RR", "G_LR", "G_RL")], axis=-1)
    within = G.error.item() + expected.error.item()
    assert_allclose(found, expected.conductance[0], atol=within, rtol=0)
    assert within < 3e-4


@pytest.mark.parametrize("temperature", [0.001, 0.3])
def test_long_wires_cold_and_hot(temperature):
    G = dl.conductance(random_wire(6), [0.1, 0.4], [0.0, 0.5], BIAS, temperature=temperature)
    for name in G.data_vars:
        assert np.isfinite(G[name]).all()
    assert (G.error < 1e-3).all()


def test_what_an_thermal_average_tells_of_itself():
    wires = [random_wire(seed, sites=60) for seed in (1, 2)]
    G = dl.conductance(wires, [0.1, 0.4], [0.0, 0.3, 0.6], BIAS)
    for name in ("error", "energies"):
        assert G[name].dims == ("realization", "mu", "B")
    assert (G.error > 0).all()
    assert (G.error <= compiled.core.TOLERANCE).all()
    fewest = compiled.core.NODES[0] + compiled.core.COMPARED
    assert G.energies.dtype.kind == "i"
    assert G.energies.min() == fewest
    for other in ({"temperature": 0}, {"energy_spacing": 4e-3}):
        assert "error" not in dl.conductance(wires, 0.1, 0.3, 0.0, **other)


@pytest.mark.parametrize(
    ("name", "changed"),
    [
        ("temperature", {"temperature": -0.01}),
        ("temperature", {"temperature": np.nan}),
        ("bias", {"bias": 0.12}),
        ("bias", {"bias": [-0.2, 0.0]}),
    ],
)
def test_what_cannot_be_averaged_is_refused(name, changed):
    with pytest.raises(ArgumentError, match=f"Argument {name} must"):
        dl.conductance(random_wire(1, sites=20), 0.1, 0.3, **changed)


def bump(sites, first, last, height):
    V = np.zeros(sites)
    V[first : last + 1] = height
    return V


DENSE = {
    "a bump": (
        dl.Nanowire(bump(300, 148, 152, 1.0), alpha=2.0, gamma=0.5, barrier=(0.0, 0.0)),
        (0.23167145204816972, 0.5181107132581361, [-0.010423, 0.013682, 0.032136], 0.05),
    ),
    "563 sites": (
        dl.Nanowire(np.zeros(563), gamma=0.5, barrier=(0.0, 0.0)),
        (
            0.17471124,
            0.68460366,
            [-0.004647167052925838, 0.02018580629113692, 0.04018128370686602],
            0.05,
        ),
    ),
    "451 sites": (
        dl.Nanowire(np.zeros(451), gamma=0.5, barrier=(0.0, 15.0)),
        (
            0.39793785,
            0.53388615,
            [-0.037410997992175156, -0.029618776777063767, -0.010758496213636712],
            0.06,
        ),
    ),
    "weak spin-orbit": (
        dl.Nanowire(np.zeros(300), alpha=2.0, gamma=0.33434667155572795, barrier=(0.0, 0.0)),
        (
            0.15030493,
            0.69020789,
            [-0.03166899533531449, 0.025225023571023963, 0.03481321669501712],
            0.05,
        ),
    ),
}
"""Wires and points at which levels are denser than nodes, and all of four checks elsewhere."""


@pytest.mark.parametrize("name", DENSE)
def test_levels_denser_than_the_nodes_are_seen(name):
    """The error was 8e-4 to 0.01 e²/h, 140 to 940 times the estimate."""
    wire, (mu, B, bias, temperature) = DENSE[name]
    arguments = [wire], np.array([mu]), np.array([B]), np.array(bias), temperature
    found, estimate, _ = compiled.thermal_conductance(*arguments)
    exact = thermal_quadrature(*arguments)
    assert abs(found - exact.conductance).max() <= 3 * estimate.item() + exact.error.item()


def test_the_sets_own_checks_lie_in_the_gaps_of_its_densest_levels():
    window, E = 0.08, 0.08 * np.array([0.1, 0.5, 0.51, 0.53, 0.54, 0.55, 0.9, 1.2])
    weight, of_core = np.ones((E.size, 8)), compiled.core.internals
    out = of_core.dense_energies(E[::-1].copy(), weight, 12.7, window)
    assert 0.51 < out[0] / window < 0.53
    assert out[1] == window * np.sin(of_core.ELSEWHERE[1] * np.pi / 2)
    weight[2:4] = 0.0  # unseen levels do not count
    out = of_core.dense_energies(E, weight, 12.7, window)
    assert 0.55 < out[0] / window < 0.9
