"""The derivatives at a temperature, against differences of the quadrature and each other."""

from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from itertools import pairwise
from multiprocessing import get_context

import numpy as np
import pytest
import xarray as xr
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from disorder_landscape import ArgumentError, Nanowire, conductance, conductance_gradient
from disorder_landscape.inference.problem.observation import TRUSTED
from disorder_landscape.model.disorder import disorder_realization
from disorder_landscape.model.parameters import BOLTZMANN
from disorder_landscape.model.quantities import AXES, CONDUCTANCES
from disorder_landscape.solver import compiled, compiled_gradients, gradients
from disorder_landscape.solver.quadrature import thermal_quadrature
from random_wires import fields, mus, random_wire, seeds

BIAS = np.array([-0.04, -0.01, 0.0, 0.02])
STEPS = {
    "mu": 2e-4,
    "B": 3e-4,
    "alpha": 4e-3,
    "g": 1e-2,
    "gamma": 2e-4,
    "delta0": 2e-4,
    "critical_field": 1e-2,
    "barrier_left": 1e-2,
    "barrier_right": 1e-2,
    "bias": 1e-4,
    "temperature": 5e-4,
    "V": 4e-4,
    "dissipation": 2e-4,
}


FINE = 1e-10
"""The quadrature's tolerance. With the usual one it misses a resonance now and then, by some
1e-7 e²/h: two thousandths of a derivative, by differences."""

SMALL = 1e-5
"""Such a derivative is zero: in e²/h per meV, tesla and so on. (Those by energies are about 1.)"""


def averages(wire, mu, B, temperature, bias=BIAS):
    """By the quadrature, shape (bias, 4)."""
    point = [wire.in_field(B)], np.array([mu]), np.array([B]), bias, temperature
    return thermal_quadrature(*point, tolerance=FINE).conductance[0, 0, 0]


def changed(name, change, wire, mu, B, temperature, along):
    at = {"mu": mu, "B": B, "temperature": temperature, "bias": BIAS}
    if name in at:
        at[name] = at[name] + change
    elif name == "V":
        wire = replace(wire, potential=wire.potential + change * along)
    elif name.startswith("barrier"):
        left, right = wire.barrier
        both = (left + change, right) if name == "barrier_left" else (left, right + change)
        wire = replace(wire, barrier=both)
    else:
        wire = replace(wire, **{name: getattr(wire, name) + change})
    return averages(wire, **at)


def expected(name, *point):
    """Central differences, extrapolated twice, and an estimate of their error."""
    steps = STEPS[name] / 2.0 ** np.arange(3)
    table = [(changed(name, h, *point) - changed(name, -h, *point)) / (2 * h) for h in steps]
    for order in (1, 2):
        previous = table
        table = [(4**order * b - a) / (4**order - 1) for a, b in pairwise(table)]
    return table[0], abs(table[0] - previous[1]).max() + FINE / steps[-1]


def slopes_of(gradient, name):
    point = gradient.isel(mu=0, B=0)
    return np.stack([point[f"d{G}_d{name}"] for G in CONDUCTANCES], axis=-1)


def largest_slope(gradient, names):
    return max(abs(slopes_of(gradient, name)).max() for name in names)


def assert_right(wire, mu, B, temperature, names, share):
    along = np.cos(np.pi * 3 * (np.arange(wire.sites) + 0.5) / wire.sites)
    found = conductance_gradient(wire, mu, B, BIAS, temperature, parameters=names)
    assert found.gradient_error.item() < share
    for name in names:
        ours = slopes_of(found, name)
        if name == "V":  # (bias, site, conductance)
            ours = np.einsum("bsc,s->bc", ours, along)
        slope, error = expected(name, wire, mu, B, temperature, along)
        smallest = SMALL + share * abs(slope).max()
        assert_allclose(ours, slope, rtol=0, atol=smallest + 3 * error)


@pytest.mark.brute_force
@pytest.mark.parametrize("name", sorted(set(STEPS) - {"dissipation"}))
def test_each_derivative_is_that_of_the_quadrature(name):
    wire = replace(random_wire(3, sites=300), critical_field=2.0)
    assert_right(wire, 0.3, 0.45, 0.05, [name], share=1e-3)


@pytest.mark.brute_force
@pytest.mark.parametrize("name", STEPS)
def test_so_it_is_where_levels_are_broadened(name):
    wire = replace(random_wire(3, sites=150), critical_field=2.0, dissipation=0.001)
    assert_right(wire, 0.3, 0.45, 0.05, [name], share=1e-3)


@pytest.mark.parametrize("B", [0.0, 0.5])
def test_little_broadening_changes_little(B):
    """Two ways to the same: with all that goes back into its channels, and without."""
    wire = random_wire(4, sites=150)
    without = conductance_gradient(wire, 0.2, B, BIAS)
    little = conductance_gradient(replace(wire, dissipation=1e-9), 0.2, B, BIAS)
    by_energies = ("mu", "gamma", "delta0", "bias", "V", "barrier_left", "barrier_right")
    largest = largest_slope(without, by_energies)
    share = without.gradient_error.item() + little.gradient_error.item()
    assert share < 0.01
    for name in by_energies:
        ours, theirs = slopes_of(little, name), slopes_of(without, name)
        assert_allclose(ours, theirs, rtol=0, atol=share * largest)


@settings(max_examples=5)
@given(seeds, mus, fields, st.floats(0.03, 0.06), st.sampled_from(sorted(STEPS)))
@example(11, 0.0, 0.0, 0.05, "V")
@example(2, 0.4, 0.3, 0.05, "dissipation")
def test_wires_of_any_kind_have_them(seed, mu, B, temperature, name):
    rng = np.random.default_rng(seed)
    wire = replace(
        random_wire(seed, sites=150),
        g=rng.uniform(10, 40),
        gamma=rng.uniform(0.1, 0.2),
        delta0=rng.uniform(0.13, 0.16),
        barrier=tuple(rng.uniform(2, 20, 2)),
        lead_alpha=rng.choice([None, 5.0]),
        lead_g=rng.choice([None, 10.0]),
        critical_field=rng.choice([np.inf, 3.0]),
        dissipation=0.001 if name == "dissipation" else rng.choice([0.0, 0.0005]),
    )
    found = conductance_gradient(wire, mu, B, BIAS, temperature)
    share = max(3e-3, found.gradient_error.item())
    if share < 0.1:  # else it says so
        assert_right(wire, mu, B, temperature, [name], share=1.01 * share)


def test_levels_that_the_ends_hardly_see_do_no_harm():
    """Poles of 1e-8 to 1e-6 meV: the model has them at places that are off by more than that."""
    wire = Nanowire(np.random.default_rng(0).normal(0, 0.2, 300))
    for B in (0.275, 0.5):
        found = conductance_gradient(wire, 0.0, B, BIAS)
        assert found.gradient_error.item() < 1e-2
        ours, (slope, _) = slopes_of(found, "mu"), expected("mu", wire, 0.0, B, 0.05, None)
        assert_allclose(ours, slope, rtol=0, atol=1e-3 * abs(slope).max())


def test_moving_all_sites_moves_mu():
    wire = random_wire(5, sites=200)
    found = conductance_gradient(wire, [0.1, 0.4], [0.2, 0.6], BIAS)
    for name in CONDUCTANCES:
        assert_allclose(found[f"d{name}_dV"].sum("site"), -found[f"d{name}_dmu"], atol=1e-9)


def test_the_mirror_image_has_the_mirrored_gradient():
    wire = replace(random_wire(6, sites=200), barrier=(10.0, 20.0))
    mirrored = replace(wire, potential=wire.potential[::-1], barrier=(20.0, 10.0))
    ours, theirs = (conductance_gradient(w, 0.2, 0.5, BIAS) for w in (wire, mirrored))
    for name, other in [("G_LL", "G_RR"), ("G_LR", "G_RL")]:
        a, b = ours[f"d{name}_dV"], theirs[f"d{other}_dV"][..., ::-1]
        assert_allclose(a, b, rtol=0, atol=1e-4 * abs(a).max().item())
        assert_allclose(
            ours[f"d{name}_dbarrier_left"], theirs[f"d{other}_dbarrier_right"], atol=1e-6
        )


def test_the_grid_gives_what_its_points_give():
    wire = random_wire(7, sites=100)
    mu, B = np.linspace(0, 0.6, 9), np.linspace(0.1, 0.7, 8)
    seen = []
    whole = conductance_gradient(
        wire, mu, B, BIAS, progress=lambda done, all_: seen.append((done, all_))
    )
    assert sum(done for done, _ in seen) == 72
    assert {all_ for _, all_ in seen} == {72}
    point = conductance_gradient(wire, mu[3], B[5], BIAS)
    for name, values in point.data_vars.items():
        here = whole[name].isel(mu=[3], B=[5])
        assert_allclose(here, values, rtol=0, atol=1e-9 * (1 + abs(values).max().item()))


def test_both_modes_are_products_with_the_jacobian():
    wire = random_wire(8, sites=60)
    grids = np.array([0.1, 0.3]), np.array([0.2, 0.5]), BIAS
    whole = conductance_gradient(wire, *grids)
    change = {"V": np.random.default_rng(1).normal(size=60), "g": 0.5, "temperature": 1e-3}
    along = conductance_gradient(wire, *grids, direction=change)
    shape = 2, 2, BIAS.size
    weights = xr.Dataset(
        {name: (AXES, np.random.default_rng(2).normal(size=shape)) for name in CONDUCTANCES}
    )
    of_sum = conductance_gradient(wire, *grids, weights=weights)
    total = 0.0
    for name in CONDUCTANCES:
        by_V = (whole[f"d{name}_dV"] * xr.DataArray(change["V"], dims="site")).sum("site")
        expected_change = by_V + 0.5 * whole[f"d{name}_dg"] + 1e-3 * whole[f"d{name}_dtemperature"]
        assert_allclose(along[f"d{name}"], expected_change, atol=1e-12)
        total += (along[f"d{name}"] * weights[name].to_numpy()).sum().item()
    dot = of_sum["V"].to_numpy() @ change["V"] + 0.5 * of_sum["g"] + 1e-3 * of_sum["temperature"]
    assert dot.item() == pytest.approx(total, rel=1e-9)
    assert of_sum.V.dims == ("site",)
    assert of_sum.gamma.dims == ()


def test_wires_that_leak_alone_have_differences():
    """Without their parent, where the closed form does not reach."""
    wire = random_wire(9, sites=6)
    lossy = replace(wire, dissipation=0.002, parent_dissipation=0.0)
    found = conductance_gradient(lossy, 0.2, 0.3, 0.02, 0.05, parameters=["dissipation", "mu"])
    h = 1e-4
    for name, other in (
        ("dissipation", [replace(lossy, dissipation=0.002 + s) for s in (-h, h)]),
        ("mu", [replace(lossy, potential=lossy.potential - s) for s in (-h, h)]),
    ):
        down, up = (conductance(w, 0.2, 0.3, 0.02, 0.05).G_LL.item() for w in other)
        assert found[f"dG_LL_d{name}"].item() == pytest.approx((up - down) / (2 * h), rel=1e-3)
    alone = replace(wire, dissipation=0.002, parent_dissipation=0.002)
    G = [
        conductance(replace(alone, dissipation=0.002 + s), 0.2, 0.3, 0.02, 0.05).G_LL.item()
        for s in (-h, h)
    ]
    of_wire = conductance_gradient(alone, 0.2, 0.3, 0.02, 0.05, parameters="dissipation")
    assert of_wire.dG_LL_ddissipation.item() == pytest.approx((G[1] - G[0]) / (2 * h), rel=1e-3)
    at_rest = conductance_gradient(wire, 0.2, 0.3, 0.02, 0.05, parameters="dissipation")
    G = [
        conductance(replace(wire, dissipation=x), 0.2, 0.3, 0.02, 0.05).G_LL.item()
        for x in (0, 1e-5)
    ]
    assert at_rest.dG_LL_ddissipation.item() == pytest.approx((G[1] - G[0]) / 1e-5, rel=1e-2)


@pytest.mark.brute_force
@pytest.mark.parametrize(
    ("name", "temperature", "dissipation"),
    [(name, 0.3, 0.0) for name in sorted(set(STEPS) - {"dissipation"})]
    + [(name, 0.2, 1e-3) for name in sorted(STEPS)]
    + [(name, T, 0.0) for name in ("V", "delta0", "gamma", "mu") for T in (0.1, 0.13, 1.0)],
)
def test_so_it_is_where_the_thermal_window_goes_beyond_the_gap(name, temperature, dissipation):
    wire = replace(
        random_wire(5, sites=100), delta0=0.12, critical_field=2.0, dissipation=dissipation
    )
    found = gradients.at_a_temperature(
        wire, np.array([0.3]), np.array([0.4]), BIAS, temperature, [name], complete=False
    )
    assert np.isfinite(found.gradient_error).all()  # it is no difference
    assert_right(wire, 0.3, 0.4, temperature, [name], share=2e-2 if temperature == 1 else 3e-3)


def test_slopes_at_no_field_and_next_to_the_gap():
    """Poles that are equal, and biases just below the gap and above it."""
    wire = replace(random_wire(5, sites=100), delta0=0.12)
    bias = np.array([-0.3, 0.0, 0.119, 0.121])
    point = np.array([0.3]), np.array([0.0]), bias, 0.1
    found = gradients.at_a_temperature(wire, *point, ["mu", "bias"], complete=False)
    for name in ("mu", "bias"):
        right, error = gradients.difference(wire, *point, name)
        size = abs(right).max()
        share = 3e-3 + error.item() + found.gradient_error.item()
        assert_allclose(found.by[name], right, rtol=0, atol=share * size)
    assert found.gradient_error.item() < 0.1


def test_above_one_kelvin_they_are_differences():
    wire = random_wire(9, sites=6)
    found = conductance_gradient(wire, 0.2, 0.3, 0.02, 2.0, parameters=["mu"])
    h = 1e-3
    moved = [replace(wire, potential=wire.potential - s) for s in (-h, h)]
    down, up = (conductance(w, 0.2, 0.3, 0.02, 2.0).G_LL.item() for w in moved)
    assert found["dG_LL_dmu"].item() == pytest.approx((up - down) / (2 * h), rel=1e-2)
    assert not gradients.has_closed_form(wire, BIAS, 2.0)
    assert gradients.has_closed_form(wire, BIAS, 1.0)


def test_sets_without_a_model_have_differences(monkeypatch):
    wire = random_wire(9, sites=4)
    expected_of = conductance_gradient(wire, 0.2, [0.1, 0.3], 0.02)
    core_of = compiled_gradients.thermal_gradient

    def none_at_first(*arguments):
        found = core_of(*arguments)
        for of in (found.conductance, found.by_V, found.others):
            of[:, 0] = np.nan
        found.error[:, 0] = found.difference[:, 0] = np.inf
        return found

    monkeypatch.setattr(compiled_gradients, "thermal_gradient", none_at_first)
    found = conductance_gradient(wire, 0.2, [0.1, 0.3], 0.02)
    assert found.energies[0, 0] > expected_of.energies[0, 0]
    for name in set(found.data_vars) - {"error", "energies", "gradient_error"}:
        size = abs(expected_of[name]).max().item()
        assert_allclose(found[name], expected_of[name], rtol=0, atol=1e-3 * size + 1e-6)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"parameters": ["beta"]}, "parameters must be names"),
        ({"parameters": []}, "there is none"),
        ({"parameters": ["gamma"], "temperature": 0.0}, "at T = 0"),
        ({"direction": {"V": 1.0}}, "one number for each site"),
        ({"direction": {"mu": np.nan}}, "must be a number"),
        ({"weights": 3.0}, "weights must be a Dataset"),
        ({"weights": xr.Dataset(), "direction": {"mu": 1.0}}, "come without parameters or weights"),
        ({"temperature": -1.0}, "temperature must"),
        ({"progress": 3}, "progress must"),
    ],
)
def test_bad_input_is_one_sentence(arguments, says):
    with pytest.raises(ArgumentError, match=says):
        conductance_gradient(**{"wire": Nanowire(np.zeros(5)), "mu": 0.0, "B": 0.1} | arguments)


def test_wires_of_two_sites_have_them():
    wire = Nanowire(np.array([0.1, -0.2]))
    assert_right(wire, 0.1, 0.2, 0.05, ["mu", "bias", "gamma"], share=5e-3)


def drawn_case(seed, broadened=False, hot=False):
    """Return a wire, mu, B, a temperature, and a direction of V."""
    rng = np.random.default_rng([77, seed])
    components = int(rng.choice([3, 5, 10, 10, 30]))
    wire = Nanowire(
        disorder_realization(rng, components, 300)[1],
        alpha=rng.uniform(6.4, 9.6),
        g=rng.uniform(20, 30),
        gamma=rng.uniform(0.1, 0.2),
        delta0=rng.uniform(0.12, 0.14),
        barrier=tuple(rng.uniform(5, 30, 2)),
    )
    if broadened:
        wire = replace(wire, dissipation=10 ** rng.uniform(-3.5, -2.0))
    T = rng.uniform(0.065, 0.4) if hot else rng.uniform(0.03, 0.065)
    mu, B = rng.uniform(0, 0.6), rng.uniform(0, 0.8)
    along = np.cos(np.pi * rng.integers(1, 12) * (np.arange(300) + 0.5) / 300)
    return wire, mu, B, T, along


@pytest.mark.brute_force
@pytest.mark.parametrize("share_of_gap", [0.93, 0.96])
@pytest.mark.parametrize("seed", [109, 112, 139])
def test_the_thermal_window_may_end_next_to_the_gap(seed, share_of_gap):
    """Where the line above the axis went on beyond the gap, derivatives were nonsense."""
    wire, mu, B, _, _ = drawn_case(seed, hot=True)
    kT = (share_of_gap * wire.delta0 - abs(BIAS).max()) / compiled.core.REACH
    assert_right(wire, mu, B, kT / BOLTZMANN, ["mu", "gamma"], share=2e-3)


@pytest.mark.brute_force
def test_a_pole_may_be_far_wider_than_the_model_has_it():
    """At zero energy, between wider ones: left out for its width, it was missed."""
    wire, mu, B, T, _ = drawn_case(322)
    assert_right(wire, mu, B, T, ["mu", "gamma", "V"], share=1e-3)


@pytest.mark.brute_force
@pytest.mark.parametrize(("seed", "name"), [(11, "gamma"), (24, "gamma"), (15, "delta0")])
def test_what_samples_next_to_the_gap_miss_is_added(seed, name):
    """There all levels move alike with these parameters; samples alone are 1.5 to 2.4e-4 off."""
    wire, mu, B, T, along = drawn_case(seed, hot=True)
    by_energies = ("mu", "gamma", "delta0", "bias", "V")
    found = conductance_gradient(wire, mu, B, BIAS, T, parameters=by_energies)
    largest = largest_slope(found, by_energies)
    slope, error = expected(name, wire, mu, B, T, along)
    assert error < 1e-5 * largest
    assert_allclose(slopes_of(found, name), slope, rtol=0, atol=7e-5 * largest)


@pytest.mark.brute_force
@pytest.mark.parametrize(("seed", "temperature"), [(4, 1.0), (4, 0.5), (5, 0.3)])
@pytest.mark.parametrize("name", ["delta0", "g", "B"])
def test_levels_of_one_spin_next_to_the_gap_may_move_much(seed, temperature, name):
    """V_Z is a little less than Δ₀; alone, the closed form was 50 times as wrong as estimated."""
    V = np.convolve(np.random.default_rng(seed).normal(0, 0.6, 80), np.ones(5) / 5, "same")
    wire, along = Nanowire(V), np.zeros(80)
    point = wire, 0.3, 0.95 * wire.delta0 / wire.zeeman_per_tesla, temperature
    by_energies = ("mu", "gamma", "delta0", "bias", "V")
    found = conductance_gradient(*point[:3], BIAS, temperature, parameters=[*by_energies, name])
    slope, error = expected(name, *point, along)
    unit = {
        "delta0": 1.0,
        "B": wire.zeeman_per_tesla,
        "g": point[2] * wire.zeeman_per_tesla / wire.g,
    }
    wrong = abs(slopes_of(found, name) - slope).max() / unit[name]
    largest = largest_slope(found, by_energies)
    assert error < 1e-3 * largest
    assert wrong < 3 * found.gradient_error.item() * largest
    assert wrong < 1e-2 * largest


@pytest.mark.parametrize("temperature", [0.05, 0.2])
def test_a_wire_without_a_parent_has_them(temperature):
    """What is added of levels next to the gap is not divided by γ, which may be zero."""
    without, little = (
        conductance_gradient(
            replace(random_wire(7, sites=50), gamma=gamma),
            *(0.2, 0.3, BIAS, temperature),
            parameters=["gamma", "delta0", "B"],
        )
        for gamma in (0.0, 1e-9)
    )
    for name in ("gamma", "delta0", "B"):
        slopes = slopes_of(without, name)
        smallest = SMALL + 1e-4 * abs(slopes).max()
        assert_allclose(slopes_of(little, name), slopes, rtol=0, atol=smallest)


def one_case(seed, broadened=False, hot=False):
    """Return errors of two derivatives, estimates, and whether the differences are better.

    Errors are shares of the largest derivative by an energy.
    """
    wire, mu, B, T, along = drawn_case(seed, broadened, hot)
    by_energies = ("mu", "gamma", "delta0", "bias", "V", *(["dissipation"] if broadened else []))
    found = conductance_gradient(wire, mu, B, BIAS, T, parameters=by_energies)
    largest = largest_slope(found, by_energies)
    outcomes = []
    others = ("mu", "gamma", "delta0", "dissipation" if broadened else "bias")
    for name in ("V", others[seed % 4]):
        ours = slopes_of(found, name)
        if name == "V":
            ours = np.einsum("bsc,s->bc", ours, along)
        slope, error = expected(name, wire, mu, B, T, along)
        wrong = abs(ours - slope).max()
        resolved = error < 0.3 * wrong + 1e-5 * largest
        outcomes.append((wrong / largest, found.gradient_error.item(), resolved))
    return outcomes


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cases", "broadened", "hot"), [(5000, False, False), (500, True, False), (500, False, True)]
)
def test_ten_thousand_random_derivatives(cases, broadened, hot):
    """`pytest -m slow -s -k ten_thousand_random_derivatives`: half an hour on two cores."""
    of_case = partial(one_case, broadened=broadened, hot=hot)
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        each = [one for both in pool.map(of_case, range(cases), chunksize=20) for one in both]
    shares, estimates, resolved = np.array(each).T
    print(f"\n{resolved.sum():.0f} of {len(each)} that the differences resolve")
    shares, estimates = shares[resolved == 1], estimates[resolved == 1]
    trusted = estimates < TRUSTED
    for percent in (50, 90, 95, 99, 99.9, 100):
        of_trusted = np.percentile(shares[trusted], percent)
        print(
            f"{percent:5} % within {np.percentile(shares, percent):.1e}, trusted {of_trusted:.1e}"
        )
    print(f"within 1e-4: {(shares < 1e-4).mean():.4f}, within 1e-2: {(shares < 1e-2).mean():.5f}")
    print(f"trusted: {trusted.mean():.4f}; more than estimated: {(shares > estimates).sum()}")
    worst = np.argsort(-shares)[:5]
    print("worst, and estimated:", [(f"{shares[k]:.1e}", f"{estimates[k]:.1e}") for k in worst])
    unforeseen = (shares > np.maximum(3 * estimates, 1e-3)).mean()
    if hot:
        assert (shares < 1e-4).mean() > 0.94
        assert (shares < 1e-3).mean() > 0.98
        assert (shares[trusted] < 2e-2).all()
        assert unforeseen < 0.01
    else:
        assert (shares < 1e-4).mean() > 0.97
        assert (shares < 1e-2).mean() > 0.999
        assert (shares[trusted] < 1e-3).all()
        assert unforeseen == 0
