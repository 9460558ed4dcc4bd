"""The gradients against finite differences, symmetries and each other."""

from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from test_agreement import level_of_the_inner_sites

from disorder_landscape import ArgumentError, Nanowire, conductance
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.observables.gradient import conductance_gradient
from random_wires import fields, mus, random_wire, seeds

PARAMETERS = ("V", "mu", "B", "alpha")
bare_gradient = partial(conductance_gradient, temperature=0.0)
biases = st.floats(-0.11, 0.11)


def values(wire, mu, B, bias, solver="fast"):
    G = conductance(wire, mu, B, bias, temperature=0, solver=solver)
    return np.array([G[name].item() for name in CONDUCTANCES])


def slope(function, at, step):
    """Central differences, extrapolated three times; and an estimate of their error."""
    steps = step / 2.0 ** np.arange(4)
    table = [(function(at + h) - function(at - h)) / (2 * h) for h in steps]
    previous = table
    for order in range(1, 4):
        previous = table
        table = [(4**order * b - a) / (4**order - 1) for a, b in pairwise(table)]
    rounding = 1e-12 / steps[-1]
    return table[0], abs(table[0] - previous[1]).max() + rounding


def differences(wire, mu, B, bias, site, solver="fast", scale=1.0):
    """Return the four derivatives and their errors, by parameter."""

    def with_potential(value):
        V = wire.potential.copy()
        V[site] = value
        return values(replace(wire, potential=V), mu, B, bias, solver)

    return {
        "V": slope(with_potential, wire.potential[site], 1e-3 * scale),
        "mu": slope(lambda x: values(wire, x, B, bias, solver), mu, 1e-4 * scale),
        "B": slope(lambda x: values(wire, mu, x, bias, solver), B, 1e-4 * scale),
        "alpha": slope(
            lambda x: values(replace(wire, alpha=x), mu, B, bias, solver), wire.alpha, 1e-3 * scale
        ),
    }


def gradient(wire, mu, B, bias, site):
    D = bare_gradient(wire, mu, B, bias).isel(mu=0, B=0, bias=0)
    D = D.isel(site=site)
    return {p: np.array([D[f"d{name}_d{p}"].item() for name in CONDUCTANCES]) for p in PARAMETERS}


def assert_is_the_slope(wire, mu, B, bias, site, **options):
    ours, expected = (
        gradient(wire, mu, B, bias, site),
        differences(wire, mu, B, bias, site, **options),
    )
    for name, (derivative, error) in expected.items():
        size = abs(derivative).max()
        assert_allclose(ours[name], derivative, rtol=0, atol=1e-6 * size + 3 * error)


@settings(max_examples=25)
@given(seeds, mus, fields, biases)
@example(3, 0.2, 0.5, 0.0)
@example(7, 0.1, 0.4, -0.02)
def test_gradients_are_those_of_finite_differences(seed, mu, B, bias):
    wire = random_wire(seed, sites=60)
    assert_is_the_slope(wire, mu, B, bias, site=seed % 60)


@settings(max_examples=25)
@given(seeds, mus, fields, biases)
def test_leads_and_wires_of_other_parameters_agree_too(seed, mu, B, bias):
    rng = np.random.default_rng(seed)
    sites = int(rng.integers(2, 12))
    wire = Nanowire(
        rng.normal(0, 0.5, sites),
        alpha=rng.uniform(1, 30),
        g=rng.uniform(0, 50),
        mass=rng.uniform(0.01, 0.1),
        gamma=rng.uniform(0.0, 0.3),
        barrier=tuple(rng.uniform(-5, 30, 2)),
        lead_mu=rng.uniform(1, 40),
        lead_alpha=rng.choice([None, rng.uniform(0, 30)]),
        lead_g=rng.choice([None, rng.uniform(0, 50)]),
    )
    assert_is_the_slope(wire, mu, B, bias, site=seed % sites, scale=10.0)


@pytest.mark.parametrize("bias", [-0.03, 0.0, 0.05])
@pytest.mark.parametrize("site", [0, 17, 39])
def test_the_finite_differences_resolve_what_they_are_to_check(bias, site):
    """Here the differences themselves are good to 1e-6, so nothing hides behind their error."""
    wire = Nanowire(np.random.default_rng(3).normal(0, 0.5, 40))
    ours = gradient(wire, 0.2, 0.5, bias, site)
    expected = differences(wire, 0.2, 0.5, bias, site, scale=20.0)
    for name, (derivative, error) in expected.items():
        size = abs(derivative).max()
        assert error < 1e-6 * size
        assert_allclose(ours[name], derivative, rtol=0, atol=1e-6 * size)


def test_gradients_are_those_of_kwant():
    wire = Nanowire(np.random.default_rng(4).normal(0, 0.5, 20))
    ours = gradient(wire, 0.2, 0.5, 0.03, 8)
    expected = differences(wire, 0.2, 0.5, 0.03, 8, solver="kwant", scale=20.0)
    for name, (derivative, _) in expected.items():
        assert_allclose(ours[name], derivative, rtol=0, atol=1e-6 * abs(derivative).max())


@settings(max_examples=15)
@given(seeds, mus, fields, biases)
def test_the_gradient_of_the_mirror_image_is_the_mirror_image_of_the_gradient(seed, mu, B, bias):
    wire = random_wire(seed, sites=80)
    D = bare_gradient(wire, mu, B, bias)
    mirrored = bare_gradient(Nanowire(wire.potential[::-1], alpha=wire.alpha), mu, B, bias)
    for name, other in [("G_LL", "G_RR"), ("G_LR", "G_RL"), ("G_RR", "G_LL"), ("G_RL", "G_LR")]:
        for p in PARAMETERS:
            ours, theirs = D[f"d{name}_d{p}"].to_numpy(), mirrored[f"d{other}_d{p}"].to_numpy()
            if p == "V":
                theirs = theirs[..., ::-1]
            assert_allclose(ours, theirs, rtol=0, atol=1e-8 * (1 + abs(ours).max()))


@pytest.mark.parametrize(
    ("bias", "tolerance"), [(np.linspace(0, 0.1, 3), 0), (np.linspace(-0.1, 0.1, 5), 1e-10)]
)
def test_the_grid_gives_what_its_points_give(bias, tolerance):
    """Where both signs of a bias are asked for, they are two sums of the same probabilities."""
    wire = random_wire(5, sites=30)
    mu, B = np.linspace(0, 0.6, 5), np.array([0.1, 0.7])
    D = bare_gradient(wire, mu, B, bias)
    assert D.dG_LR_dV.dims == ("mu", "B", "bias", "site")
    assert D.dG_LR_dB.attrs["units"] == "e^2/h/(T)"
    for i, j, k in np.ndindex(5, 2, bias.size):
        point = bare_gradient(wire, mu[i], B[j], bias[k]).isel(mu=0, B=0, bias=0)
        for p in PARAMETERS:
            ours, theirs = (
                np.array([of[f"d{name}_d{p}"] for name in CONDUCTANCES])
                for of in (D.isel(mu=i, B=j, bias=k), point)
            )
            assert_allclose(ours, theirs, rtol=0, atol=tolerance * abs(theirs).max())


@pytest.mark.parametrize("bias", [-0.03, 0.0, 0.05])
def test_pivoted_gradients_agree(bias):
    wire = random_wire(11, sites=50)
    trusted = bare_gradient(wire, 0.2, 0.5, bias)
    pivoted = bare_gradient(wire, 0.2, 0.5, bias, growth_limit=0.0)
    for name in trusted.data_vars:
        size = abs(trusted[name]).max().item()
        assert_allclose(pivoted[name], trusted[name], rtol=0, atol=1e-8 * size)


def test_a_level_at_the_energy_does_no_harm():
    """Where real elimination fails, at a level of the inner sites, pivoting takes over."""
    wire = Nanowire(np.random.default_rng(5).normal(0, 0.5, 40))
    mu, B = 0.1, 0.5
    level = level_of_the_inner_sites(wire, mu, B)
    for shift in (0.0, 1e-12, 1e-9, 1e-6):
        ours = bare_gradient(wire, mu, B, level + shift)
        pivoted = bare_gradient(wire, mu, B, level + shift, growth_limit=0.0)
        for name in ours.data_vars:
            size = abs(pivoted[name]).max().item()
            assert_allclose(ours[name], pivoted[name], rtol=0, atol=1e-6 * size)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"wire": [1.0, 2.0]}, "wire"),
        ({"mu": [0.2, 0.1]}, "mu"),
        ({"B": np.nan}, "B"),
        ({"bias": 0.12}, "bias"),
        ({"bias": []}, "bias"),
    ],
)
def test_bad_input_is_refused(arguments, name):
    with pytest.raises(ArgumentError, match=f"Argument {name} must"):
        conductance_gradient(**{"wire": Nanowire(np.zeros(5)), "mu": 0.0, "B": 0.1} | arguments)
