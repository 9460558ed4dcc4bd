"""What is told of a posterior: evidence, what is left open, gaps, and devices with a gate."""

import re

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose
from scipy.stats import multivariate_normal

import disorder_landscape as dl
from disorder_landscape import ArgumentError
from disorder_landscape.inference.inferred import mean_wire, sample_wires
from disorder_landscape.inference.maxima import maxima_of
from disorder_landscape.inference.optimum import Optimum
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.problem.distributions import Normal, Uniform
from disorder_landscape.inference.report import shares_as_text, summary, verdict_sentence
from disorder_landscape.inference.result import at_limit, evidence, left_open, moments
from disorder_landscape.model.quantities import CONDUCTANCES
from linear_data import DATA, SIZE, UNKNOWNS, posterior

LEVER_ARM, OFFSET, BIAS_OFFSET = 0.12, -0.25, 0.001
NOISE = 0.001


def test_the_evidence_is_that_of_linear_data(linear):
    """Which is normal, too: from samples of the posterior, and from ones that miss a little."""
    exact = posterior(linear)
    covariance = linear.slope.T @ linear.slope + np.diag(linear.variance)
    expected = multivariate_normal(np.zeros(DATA), covariance).logpdf(linear.data)
    for wider in (1.0, 1.1):
        answer = type(exact)(exact.mean, wider**2 * exact.covariance)
        outcome = Outcome([Optimum(answer, linear.data, 0.0, 0.0)])
        X = answer.draw(np.random.default_rng(0), 4000)
        found = evidence(linear, outcome, X)
        assert found["log_evidence"] == pytest.approx(expected, abs=1e-6 if wider == 1 else 0.05)
        assert found["effective_sample_size"] == pytest.approx(
            4000, rel=1e-6 if wider == 1 else 0.1
        )


@pytest.mark.parametrize("belief", [Uniform(2.0, 5.0), Normal(3.0, 0.5)])
def test_moments_are_those_of_samples(belief):
    xi = 0.3 + 0.8 * np.random.default_rng(1).normal(size=100_000)
    mean, std = moments(belief, 0.3, 0.8)
    values = belief.value(xi)
    assert mean == pytest.approx(values.mean(), abs=0.01)
    assert std == pytest.approx(values.std(), rel=0.01)


def test_it_is_said_what_the_data_leave_open():
    """c_1, c_2, c_3, mean and α: all but one combination and α; mean and α go together."""
    covariance = np.diag([1e-4, 1e-4, 0.99, 1e-2, 0.81])
    assert UNKNOWNS.names == ("c_1", "c_2", "c_3", "mean", "alpha")
    covariance[3, 4] = covariance[4, 3] = -0.97 * np.sqrt(1e-2 * 0.81)
    said = left_open(UNKNOWNS, covariance)
    assert said["not_fixed"] == "1 of 4 combinations of the disorder's unknowns, alpha"
    assert said["not_told_apart"] == "mean and alpha (-0.970)"
    assert left_open(UNKNOWNS, 1e-4 * np.eye(SIZE)) == {"not_fixed": "", "not_told_apart": ""}


@pytest.mark.parametrize(
    ("share", "listed", "words"),
    [
        ([0.03, 0.97], [0.97], None),
        ([0.37, 0.03, 0.6], [0.6, 0.37], "60 and 37 % of the posterior"),
        ([0.2] * 5, [0.2] * 5, "20, 20, 20 and 20 % of the posterior, and so on"),
    ],
)
def test_maxima_that_hold_most_of_the_posterior_are_said(linear, share, listed, words):
    answer = posterior(linear)
    optima = [Optimum(answer, linear.data, -2 * np.log(one), 0.0) for one in share]
    found = maxima_of(linear, Outcome(optima))
    assert_allclose(found["share"], listed)
    assert found["alpha_maxima"].shape == (len(listed),)
    if words is not None:
        assert shares_as_text(found) == words


def test_the_most_probable_wire_comes_first(linear):
    """… even if it is so sharp that more of the posterior is about another one."""
    wide = posterior(linear)
    sharp = type(wide)(wide.mean + 1.0, wide.covariance / 9)
    optima = [Optimum(wide, linear.data, 1.0, 0.0), Optimum(sharp, linear.data, 0.0, 0.0)]
    found = maxima_of(linear, Outcome(optima))
    assert found.sizes["maximum"] == 2
    assert found["share"][0] < found["share"][1]
    assert_allclose(found["potential_maxima"][0], linear.unknowns.potential(sharp.mean))


def test_where_no_wire_explains_the_data_the_best_one_stands_alone(linear):
    answer = posterior(linear)
    optima = [Optimum(answer, linear.data, height, 50.0) for height in (0.0, 0.0, 1.0)]
    assert maxima_of(linear, Outcome(optima))["share"].to_numpy().tolist() == [1.0]


@pytest.fixture(scope="module")
def device():
    """A wire, and its conductances as a device shows them, whose gate and bias are off."""
    rng = np.random.default_rng(4)
    V = 0.2 * np.cos(np.pi * (np.arange(80) + 0.5) / 80)
    wire = dl.Nanowire(V, alpha=8.3, g=24.0)
    mu, B, bias = np.linspace(0, 0.5, 7), np.linspace(0.1, 0.8, 7), np.array([-0.03, 0.0, 0.03])
    G = dl.conductance(wire, mu, B, bias)
    for name in CONDUCTANCES:
        G[name] += NOISE * rng.normal(size=G[name].shape)
    off = {"gate": ("gate", (mu - OFFSET) / LEVER_ARM, {"units": "V"}), "bias": bias - BIAS_OFFSET}
    return wire, G.rename(mu="gate").assign_coords(off)


@pytest.fixture(scope="module")
def inferred(device):
    prior = dl.Prior(
        1,
        80,
        alpha=8.3,
        g=(23, 27),
        lever_arm=(0.11, 0.13),
        mu_offset=(-0.3, -0.2),
        bias_offset=Normal(0, 0.002),
    )
    return dl.infer(device[1], prior, NOISE)


def test_a_device_is_found_with_its_offsets(device, inferred):
    wire, _ = device
    assert inferred.attrs["verdict"] == "converged"
    truth = {"g": 24.0, "lever_arm": LEVER_ARM, "bias_offset": BIAS_OFFSET}
    for name, value in truth.items():
        assert abs(inferred[f"{name}_mean"] - value) < 4 * inferred[f"{name}_std"]
        assert inferred[name].dims == ("sample",)
        assert_allclose(inferred[name].std(), inferred[f"{name}_std"], rtol=0.4)
    assert inferred["lever_arm"].attrs["units"] == "meV/V"
    assert "mean and mu_offset" in inferred.attrs["not_told_apart"]
    said = verdict_sentence(inferred)
    assert re.search(r"V is known to \d+ µeV .*, and to [0-9.]+ µeV but for its mean\.", said)
    shape = inferred["potential_mean"] - inferred["potential_mean"].mean()
    assert np.sqrt(((shape - wire.potential) ** 2).mean()) < 0.002
    assert inferred.sizes["maximum"] == 1
    assert inferred["share"] == 1
    assert abs(inferred["g_maxima"][0] - inferred["g_mean"]) < inferred["g_std"]
    lines = "\n".join(summary(inferred))
    assert "g             " in lines
    assert "before: 23 to 27" in lines
    assert "before: 0 ± 0.002" in lines


def test_what_was_measured_over_a_gate_is_explained_over_it(device, inferred):
    _, G = device
    assert inferred["G_LL"].dims == ("gate", "B", "bias")
    assert inferred["P_topological"].dims == ("map_gate", "map_B")
    for name in CONDUCTANCES:
        assert np.sqrt(((inferred[name] - G[name]) ** 2).mean()) == pytest.approx(NOISE, rel=0.3)


def test_gaps_are_those_of_the_samples(inferred):
    P = inferred["P_gap"]
    assert P.dims == ("gap", "gate", "B")
    assert (P.diff("gap") <= 0).all()
    assert (P[-1] == 0).all()
    mu = LEVER_ARM * inferred["gate"].to_numpy() + OFFSET
    levels = dl.gap(mean_wire(inferred), mu, inferred["B"].to_numpy())
    T_IV = dl.topological_visibility(mean_wire(inferred), mu, inferred["B"].to_numpy())[0]
    gap = np.where(T_IV < 0, levels["E_2"], levels["E_1"])
    certain = (P > 0.95).sum("gap").to_numpy(), (P > 0.05).sum("gap").to_numpy()
    index = np.searchsorted(P["gap"].to_numpy(), np.nan_to_num(gap, nan=0.12))
    assert ((index >= certain[0] - 1) & (index <= certain[1] + 1)).mean() > 0.9


def test_wires_of_a_result_are_those_of_its_variables(inferred):
    wire, samples = mean_wire(inferred), sample_wires(inferred)
    assert_allclose(wire.potential, inferred["potential_mean"])
    assert (wire.g, wire.alpha) == (float(inferred["g_mean"]), 8.3)
    assert [one.g for one in samples] == inferred["g"].to_numpy().tolist()
    with pytest.raises(ArgumentError, match="another version's: run infer again"):
        mean_wire(inferred.assign_attrs(prior="x"))
    with pytest.raises(ArgumentError, match="it lacks g_mean"):
        mean_wire(inferred.drop_vars("g_mean"))


def test_a_device_is_verified_at_other_settings(device, inferred):
    """With its gate and its bias as they are."""
    wire, _ = device
    further = dl.conductance(wire, [0.2, 0.31], [0.3, 0.6], [-0.02, 0.01]).rename(mu="gate")
    gate, bias = (further[name].to_numpy() for name in ("gate", "bias"))
    off = {"gate": (gate - OFFSET) / LEVER_ARM, "bias": bias - BIAS_OFFSET}
    further = further.assign_coords(off)
    found = dl.verify(inferred, further, NOISE, controls=19, shifts=[0.0])
    assert float(found["mismatch"].max()) < 0.02
    assert found.attrs["verdict"].startswith("The prediction passes: ")
    assert found["p_samples"] > 0.02


@pytest.mark.parametrize("dissipation", [0.001, (0.0, 0.002)])
def test_maps_are_those_of_the_wire_without_its_dissipation(dissipation):
    """… known or not, since otherwise there is no det r = ±1."""
    wire = dl.Nanowire(np.zeros(50), dissipation=0.001)
    G = dl.conductance(wire, [0.1, 0.3, 0.5], [0.0, 0.4, 0.8], [-0.03, 0.0, 0.03]).drop_attrs()
    found = dl.infer(G, dl.Prior(1, 50, dissipation=dissipation), NOISE, samples=8)
    most_probable = dl.Nanowire(found["potential_maxima"][0])
    T_IV = dl.topological_visibility(most_probable, found["map_mu"], found["map_B"])
    assert_allclose(found["T_IV"], T_IV, atol=1e-9)


def test_axes_and_gaps_say_what_they_are(inferred):
    assert inferred["gate"].attrs == {"long_name": "gate voltage", "units": "V"}
    assert inferred["lever_arm_std"].attrs["units"] == "meV/V"
    assert inferred["gap"].attrs["units"] == "meV"


def test_no_gap_is_beyond_the_parents_in_a_field():
    """Without pairing there is no level below it here."""
    wire = dl.Nanowire(np.zeros(20), gamma=0.0, critical_field=0.75)
    G = dl.conductance(wire, [0.1, 0.4], [0.0, 0.7], [-0.02, 0.0]).drop_attrs()
    prior = dl.Prior(1, 20, gamma=0.0, critical_field=0.75)
    P = dl.infer(G, prior, NOISE, samples=2)["P_gap"]
    parent = 0.12 * np.sqrt(1 - (0.7 / 0.75) ** 2)
    assert (P.sel(B=0.7).where(P["gap"] > parent, 0.0) == 0).all()


@pytest.mark.parametrize("name", ["lead_g", "lead_alpha", "parent_dissipation"])
def test_leads_and_parents_that_are_not_as_the_wire_are_refused(device, name):
    prior = dl.Prior(1, 80, 3.0, alpha=8, g=24, dissipation=0, lever_arm=0.12, mu_offset=OFFSET)
    of_wire = {"lead_g": "g", "lead_alpha": "alpha", "parent_dissipation": "dissipation"}[name]
    alone = device[1].drop_attrs(deep=False).assign_attrs({name: 1.0})
    with pytest.raises(ArgumentError, match=f"{of_wire} must be .* the measurement states 1"):
        dl.infer(alone, prior, NOISE)
    both = device[1].assign_attrs({name: 1.0, of_wire: 2.0})
    with pytest.raises(ArgumentError, match=f"{name} must be the wire's .* the measurement's is 1"):
        dl.infer(both, prior, NOISE)


@pytest.mark.parametrize(
    ("mean", "std", "said"),
    [
        (0.1998, 0.001, {"delta0": "0.2 meV"}),
        (0.151, 0.001, {"delta0": "0.15 meV"}),
        (0.175, 0.0005, {}),
        (0.175, 0.0144, {}),  # as little known as before
    ],
)
def test_limits_of_the_prior_are_named(mean, std, said):
    """… but not those that a parameter has of its own, as dissipation has at zero."""
    parameters = {"delta0": Uniform(0.15, 0.2), "dissipation": Uniform(0.0, 0.002)}
    found = {"delta0_mean": mean, "delta0_std": std, "dissipation_mean": 1e-6}
    result = xr.Dataset(found | {"dissipation_std": 1e-6})
    assert at_limit(result, parameters) == said


def test_what_is_at_a_limit_is_not_called_open():
    covariance = np.diag([1e-4, 1e-4, 1e-4, 1e-4, 0.81])
    assert left_open(UNKNOWNS, covariance)["not_fixed"] == "alpha"
    assert left_open(UNKNOWNS, covariance, ["alpha"])["not_fixed"] == ""


@pytest.mark.parametrize("nothing", [None, list, "result.nc"])
def test_what_is_no_result_has_no_samples(nothing):
    with pytest.raises(ArgumentError, match=r"prediction must .*, but it is "):
        sample_wires(nothing)
