"""Inversions of short wires whose disorder is known, and of the fixed wire of docs/infer.md."""

import json
from dataclasses import replace

import keras
import numpy as np
import pytest
import xarray as xr
from threadpoolctl import threadpool_info, threadpool_limits

import disorder_landscape as dl
from disorder_landscape import ArgumentError, Nanowire, conductance
from disorder_landscape.config import Config, DatasetConfig, TrainingConfig
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.files import read_json
from disorder_landscape.inference.given import observation_of
from disorder_landscape.inference.noise_hints import noise_hint, stated_noise_hint
from disorder_landscape.inference.problem.distributions import Uniform
from disorder_landscape.inference.problem.measured_dataset import SETTINGS, measurement_of
from disorder_landscape.inference.problem.measurement import settings_of
from disorder_landscape.inference.problem.noise import noise_of_channels, parse_noise, stated_noise
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.report import summary
from disorder_landscape.inference.search.few_unknowns import InversionSettings
from disorder_landscape.inference.search.first_guess import network_guess
from disorder_landscape.inference.search.network_features import network_features
from disorder_landscape.inference.search.regression_rounds import RoundSettings
from disorder_landscape.inference.verdict import CONVERGED, NOT_CONVERGED, NOT_DESCRIBED
from disorder_landscape.learning.model import TrainedModel
from disorder_landscape.learning.scaling import LabelScaler
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.runs import FIVE, shipped_model
from disorder_landscape.studies.truth import unknowns_of

NOISE = 0.001
DATASET = DatasetConfig(
    realizations=1, components=2, sites=100, mu_points=6, B_points=6, bias=(-0.03, 0.0, 0.03)
)
LABELS = LabelScaler(("c_1", "c_2", "alpha"), np.zeros(3), np.ones(3))
MODEL = TrainedModel(None, LABELS, None, Config(dataset=DATASET))
"""A disorder model without a network."""
TRUE = realization(DATASET, 3)
SOON = InversionSettings(attempts=2, rounds=RoundSettings(rounds=4))


def measure(wire, noise=NOISE, config=DATASET, **options):
    G = conductance(wire, config.mu, config.B, config.bias, **options)
    rng = np.random.default_rng(1)
    for name in CONDUCTANCES:
        G[name] += noise * rng.normal(size=G[name].shape)
    return G


def infer(G, noise=NOISE, **options):
    return dl.infer(G, MODEL, noise, network=False, **options)


def small_network(mu_points):
    """Of one layer, not trained."""
    grid, labels = keras.Input((mu_points, 6, 3, 4)), keras.layers.Dense(len(LABELS.names))
    return keras.Sequential([grid, keras.layers.Flatten(), labels])


def interrupt_at_once(step):
    raise KeyboardInterrupt


def site_error(result, potential=TRUE.potential):
    return float(np.sqrt(((result["potential_mean"] - potential) ** 2).mean()))


@pytest.fixture(scope="module")
def measured():
    return measure(TRUE.wire)


@pytest.fixture(scope="module")
def inferred(measured):
    return infer(measured)


def test_the_disorder_is_found_within_its_error_bars(inferred):
    assert inferred.attrs["verdict"] == CONVERGED
    spread = float(np.sqrt((inferred["potential_std"] ** 2).mean()))
    assert spread < 0.005
    assert site_error(inferred) < 3 * spread
    assert abs(inferred["alpha_mean"] - TRUE.alpha) < 4 * inferred["alpha_std"]
    off = abs(inferred["components_mean"] - TRUE.components)
    assert np.all(off < 4 * inferred["components_std"])
    np.testing.assert_allclose(inferred["misfit"], NOISE, rtol=0.25)


def test_the_samples_are_what_the_result_says_of_them(inferred):
    V = inferred["potential"]
    assert V.dims == ("sample", "site")
    assert V.sizes == {"sample": 64, "site": 100}
    for name, samples in inferred[["potential", "components", "alpha"]].items():
        mean, std = inferred[f"{name}_mean"], inferred[f"{name}_std"]
        np.testing.assert_allclose(samples.mean("sample"), mean, atol=1e-12)
        np.testing.assert_allclose(samples.std("sample"), std, rtol=0.4)
    sample = Nanowire(V[5].to_numpy(), alpha=float(inferred["alpha"][5]))
    maps = inferred["map_mu"], inferred["map_B"]
    T = dl.topological_visibility(sample, *maps).isel(lead=0)
    certain = inferred["P_topological"].isin([0.0, 1.0]).to_numpy()
    assert certain.mean() > 0.9
    np.testing.assert_array_equal(
        T.to_numpy()[certain] < 0, inferred["P_topological"].to_numpy()[certain]
    )
    mean = Nanowire(inferred["potential_mean"].to_numpy(), alpha=float(inferred["alpha_mean"]))
    G = conductance(mean, DATASET.mu, DATASET.B, DATASET.bias)
    for name in CONDUCTANCES:
        np.testing.assert_allclose(inferred[name], G[name], atol=1e-6)


def test_channels_and_numbers_may_be_missing(measured):
    G = measured.drop_vars(["G_LR", "G_RL"])
    G["G_LL"] = G["G_LL"].where(G["mu"] != G["mu"][2])
    G = G.where(G["bias"] != G["bias"][0]).assign_attrs(G.attrs)  # one of the network's own
    result = dl.infer(G, MODEL, NOISE)  # the network would be used if it could
    assert result.attrs["verdict"] == CONVERGED
    assert "some are missing" in result.attrs["start"]
    assert site_error(result) < 0.01
    np.testing.assert_array_equal(np.isnan(result["misfit"]), [False, False, True, True])
    said = summary(result)
    assert f"misfit of {CONDUCTANCES[3]}  not measured" in said


def test_settings_are_the_measurements_own(measured):
    wire = replace(TRUE.wire, barrier=(30.0, 10.0))
    result = infer(measure(wire, temperature=0.04))
    assert result.attrs["verdict"] == CONVERGED
    assert site_error(result) < 0.02
    G = measured.drop_attrs()
    assert "barrier" not in G.attrs
    assert infer(G).attrs["barrier_left"] == 15.0


@pytest.mark.parametrize("unmodelled", ["gap", "components"])
def test_what_the_model_cannot_explain_is_flagged(unmodelled):
    more_components = realization(DATASET.model_copy(update={"components": 12}), 3)
    wire = {"gap": replace(TRUE.wire, delta0=0.096), "components": more_components.wire}[unmodelled]
    G = measure(wire)
    G.attrs = {name: G.attrs[name] for name in SETTINGS}  # what is known of a device
    result = infer(G, settings=SOON)
    assert result.attrs["verdict"] in (NOT_DESCRIBED, NOT_CONVERGED)
    assert result.attrs["attempts"] == 2
    assert result.attrs["excess"] > 10


def test_what_it_explains_is_not(measured):
    """… with as few rounds."""
    assert infer(measured, settings=SOON).attrs["verdict"] == CONVERGED


def test_the_whole_landscape_has_no_network(measured):
    whole = dl.Prior(components=None, sites=DATASET.sites)
    with pytest.raises(ArgumentError, match="network must be none where V of every site"):
        dl.infer(measured, whole, NOISE, network=MODEL)


def test_much_noise_takes_importance_sampling(tmp_path):
    """Interrupted while its samples are drawn, it comes to the same."""
    noise, file = 0.05, tmp_path / "unfinished.json"
    noisy = measure(TRUE.wire, noise).isel(mu=[0, 3, 5], B=[1, 3, 5], bias=[1, 2])

    def interrupt(step):
        if step.stage == "importance sampling":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        infer(noisy, noise, checkpoint=file, progress=interrupt)
    result, again = infer(noisy, noise, checkpoint=file), infer(noisy, noise)
    xr.testing.assert_identical(result, again)
    assert result.attrs["verdict"] == CONVERGED
    assert result.attrs["effective_sample_size"] >= 100
    spread = float(np.sqrt((result["potential_std"] ** 2).mean()))
    assert spread > 0.0043  # kT
    assert site_error(result) < 3 * spread
    np.testing.assert_allclose(result["misfit"], noise, rtol=0.5)


def test_an_interrupted_run_goes_on(measured, inferred, tmp_path):
    checkpoint = tmp_path / "unfinished.json"
    first, second = [], []

    def interrupt(step):
        first.append(step)
        if len(first) == 6:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        infer(measured, checkpoint=checkpoint, progress=interrupt)
    other = infer(measured, noise=0.002, checkpoint=checkpoint)  # ignores what is another run's …
    assert other.identical(infer(measured, noise=0.002))
    result = infer(measured, checkpoint=checkpoint, progress=second.append)
    rounds = [[step for step in steps if step.stage == "round"] for steps in (first, second)]
    assert rounds[1][: len(rounds[0])] == rounds[0]  # … and leaves it there
    assert len(rounds[1]) == inferred.attrs["rounds"]
    stages = [step.stage for step in second]
    assert stages[-2:] == ["Gauss–Newton", "maps"]
    assert second[-1].misfit < 1.1 * NOISE
    spread = float(np.sqrt((inferred["potential_std"] ** 2).mean()))
    assert second[-1].spread == pytest.approx(spread, rel=0.1)
    assert result.identical(inferred)


def test_a_checkpoint_of_an_older_version_is_ignored(measured, inferred, tmp_path):
    """Its settings had other names, so that its fingerprint differs; it stays in the file."""
    wide = {"mean": [0.0] * 4, "covariance": np.eye(4).tolist()}
    old = {"polish.0": wide, "near.0.0.3": {"spread": 0.001}}
    old["round.0.0.0"] = {"distribution": wide, "misfit": 1.0, "unexplained": 9.0, "spread": 0.1}
    checkpoint = tmp_path / "unfinished.json"
    checkpoint.write_text(json.dumps({64 * "0": old}))
    assert infer(measured, checkpoint=checkpoint).identical(inferred)
    runs = read_json(checkpoint, "checkpoint", "be one")
    assert runs.pop(64 * "0") == old
    (new,) = runs.values()
    assert any(name.startswith("gauss_newton.0") for name in new)


def test_a_run_with_another_network_starts_anew(measured, tmp_path):
    checkpoint = tmp_path / "unfinished.json"
    network = small_network(6)
    model = replace(MODEL, network=network)
    for runs in 1, 1, 2:
        if runs == 2:  # as after another training with the same configuration
            network.set_weights([2 * weights for weights in network.get_weights()])
        with pytest.raises(KeyboardInterrupt):
            dl.infer(measured, model, NOISE, checkpoint=checkpoint, progress=interrupt_at_once)
        assert len(read_json(checkpoint, "checkpoint", "be one")) == runs


def test_linear_algebra_has_one_thread(measured):
    """… while the simulation has all."""
    threads = set()

    def progress(step):
        threads.update(one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas")
        raise KeyboardInterrupt

    with threadpool_limits(2, user_api="blas"), pytest.raises(KeyboardInterrupt):
        infer(measured, progress=progress)
    assert threads == {1}


def test_the_seed_decides(measured, inferred):
    other = infer(measured, seed=1)
    assert not other.identical(inferred)
    np.testing.assert_allclose(
        other["potential_mean"],
        inferred["potential_mean"],
        atol=float(inferred["potential_std"].max()),
    )


@pytest.mark.parametrize(
    ("change", "options", "message"),
    [
        (lambda G: G, {"noise": -0.1}, "noise must be a number from 0 to 1 e²/h, but it is -0.1"),
        (
            lambda G: G,
            {"noise": {"G_LL": 0.1}},
            "noise must be one number in e²/h, or one for each of",
        ),
        (lambda G: G, {"samples": 3}, "samples must be an even number"),
        (
            lambda G: G * 3.874e-5,
            {},
            "in e²/h, which is 3.874e-05 S, .* as if they were in siemens",
        ),
        (lambda G: G.assign(G_LL=G["G_LL"].assign_attrs(units="S")), {}, "units of G_LL are S"),
        (lambda G: G.assign(G_LL=G["G_LL"].assign_attrs(units="mA/V")), {}, "of G_LL are mA/V"),
        (lambda G: G * 38.74, {}, "more than one subband can carry"),
        (
            lambda G: G * (5 / abs(G["G_LL"]).max()),
            {},
            "be at most 4 e²/h, which is what one subband",
        ),
        (
            lambda G: G.assign_coords(mu=G["mu"].assign_attrs(units="eV")),
            {},
            "mu must be in meV, but its units are eV",
        ),
        (lambda G: G * np.nan, {}, "hold finite numbers, but it holds none"),
        (lambda G: G / 0.0, {}, "hold finite numbers"),
        (lambda G: G.isel(mu=0, drop=True), {}, "it lacks mu, and has B, bias"),
        (lambda G: G.stack(point=("mu", "B", "bias")).reset_index("point"), {}, "set_index"),
        (lambda G: G.rename(mu="gate").expand_dims("repeat"), {}, "B, bias, gate, repeat"),
        (lambda G: G.assign_coords(bias=1e-3 * G["bias"]), {}, "as if they were in V"),
        (lambda G: G.assign_coords(bias=1e3 * G["bias"]), {}, "as if they were in µV"),
        (lambda G: G.drop_vars(CONDUCTANCES), {}, "it lacks G_LL, G_RR, G_LR, G_RL"),
        (lambda G: G.isel(mu=slice(5)), {"network": True}, "it differs in mu"),
        (lambda G: G.isel(B=[0, 1, 1, 2, 3, 4]), {}, "B must be .* 0.16 T occurs twice"),
        (lambda G: G.isel(mu=slice(5)), {"network": True}, "--from-prior"),
        (lambda G: G.assign_attrs(g=14.7), {}, "g must be 25, as in the prior, .* states 14.7"),
        (lambda G: G.assign_attrs(delta0=0.2), {}, "delta0 must be 0.12"),
        (lambda G: G.assign_attrs(alpha="large"), {}, "alpha must be a number"),
        (lambda G: G.assign_attrs(barrier=[15.0, np.nan]), {}, "barrier must be a number"),
        (lambda G: G.assign_attrs(barrier=[15.0, 1e9]), {}, "barrier must be a number"),
        (lambda G: G.assign(G_LL=G["G_LL"].assign_attrs(units="2e^2/h")), {}, "G_LL are 2e.2/h"),
        (lambda G: G + 0j, {}, "hold finite numbers or NaN, but G_LL holds something else"),
        (lambda G: G.assign_attrs(noise=[0.1, 0.2]), {"noise": None}, "measurement states 2"),
        (lambda G: G, {"noise": True}, "noise must be a number .* it is True"),
        (lambda G: G, {"samples": 2.5}, "samples must be a whole number"),
    ],
)
def test_bad_input_is_refused_in_one_sentence(measured, change, options, message):
    options = {"noise": NOISE, "network": False} | options
    with np.errstate(all="ignore"):
        G = change(measured)
    with pytest.raises(ArgumentError, match=message):
        dl.infer(G, MODEL, **options)


def test_a_measurement_of_another_alpha_is_no_data_of_a_model_that_knows_it(measured):
    known = DATASET.model_copy(update={"alpha_range": (8.0, 8.0)})
    model = replace(MODEL, config=Config(dataset=known))
    message = "alpha must be 8, as in the prior, but the measurement states 7"
    with pytest.raises(ArgumentError, match=message):
        dl.infer(measured.assign_attrs(alpha=7.0), model, NOISE, network=False)


def test_the_network_guesses_if_nothing_is_missing_of_what_it_is_shown(measured, tmp_path):
    """It knows every second μ; a number is missing, first between these, then among them."""
    fewer = DATASET.model_copy(update={"mu_points": 3, "mu_max": DATASET.mu[4]})
    model = replace(MODEL, network=small_network(3), config=Config(dataset=fewer))
    for missing, guessed in (1, True), (2, False):
        checkpoint = tmp_path / f"{missing}.json"
        G = measured.assign(G_LL=measured["G_LL"].where(measured["mu"] != measured["mu"][missing]))
        with pytest.raises(KeyboardInterrupt):
            dl.infer(G, model, NOISE, checkpoint=checkpoint, progress=interrupt_at_once)
        (notes,) = read_json(checkpoint, "checkpoint", "be one").values()
        assert ("guess" in notes) == guessed


class FirstNumbers:
    """Instead of a network: the first numbers of its input."""

    def predict_on_batch(self, x):
        return x.reshape(len(x), -1)[:, :3]

    def get_weights(self):
        return []


def test_the_network_is_shown_its_own_points_of_a_larger_grid():
    model, unknowns = replace(MODEL, network=FirstNumbers()), unknowns_of(DATASET)
    larger = DATASET.model_copy(update={"mu_points": 11, "bias": (-0.03, 0.0, 0.01, 0.03)})
    guesses = [
        network_guess(
            model,
            Observation(
                measurement_of(measure(TRUE.wire, 0.0, config), settings_of(DATASET)),
                unknowns,
                np.zeros(4),
            ),
            np.random.default_rng(0),
        )
        for config in (DATASET, larger)
    ]
    for part in ("mean", "covariance"):
        one, other = (getattr(guess, part) for guess in guesses)
        np.testing.assert_allclose(one, other, atol=1e-4)


def test_a_network_of_few_points_makes_features_of_each_wire():
    model, larger = replace(MODEL, network=FirstNumbers()), {"mu_points": 11, "B_points": 16}
    G = measure(TRUE.wire, config=DATASET.model_copy(update=larger))
    whole = measurement_of(G, settings_of(DATASET))
    observation = Observation(whole, unknowns_of(DATASET), np.full(4, NOISE))
    assert network_features(None, observation, 0.25) is None
    assert network_features(model, observation, 0.2) is None
    features = network_features(model, observation, 0.25)
    np.testing.assert_array_equal(features.on_grid.measurement.G, whole.G[::2, ::3])
    np.testing.assert_allclose(features.features_of_data, whole.G[0, 0, 0, :3], atol=1e-6)
    Y = np.zeros((200, features.on_grid.data.size))
    labels = features.features_of_samples(Y, np.random.default_rng(0))
    np.testing.assert_allclose(labels.std(axis=0), NOISE, rtol=0.2)

    inferred = dl.infer(G, model, NOISE)
    assert inferred.attrs["start"] == "the network's guess"
    assert inferred.attrs["verdict"] == CONVERGED
    assert site_error(inferred) < 0.005


def test_noise_from_the_command_line():
    assert parse_noise("0.01") == 0.01
    assert parse_noise("0.01,0.02,0.003,0.004")["G_LR"] == 0.003
    for text in ("much", "0.1,0.2", ""):
        with pytest.raises(
            ArgumentError, match="noise must be one number in e²/h, or one for each"
        ):
            parse_noise(text)


def test_noise_is_what_the_measurement_states():
    """As one number, or as `infer` writes it."""
    assert stated_noise({}) == 0.001
    assert stated_noise({"noise": 0.01}) == stated_noise({"noise": np.array([0.01])}) == 0.01
    each = stated_noise({"noise": np.array([0.1, 0.2, 0.3, 0.4])})
    np.testing.assert_array_equal(noise_of_channels(each), [0.1, 0.2, 0.3, 0.4])


def test_sweeps_may_go_either_way(measured):
    """And axes in any order."""
    backward = measured.isel(B=slice(None, None, -1), mu=[3, 1, 0, 2, 5, 4])
    there, back = (measurement_of(G) for G in (measured, backward))
    for name in ("G", "mu", "B", "bias"):
        np.testing.assert_array_equal(getattr(there, name), getattr(back, name))


def test_a_network_says_what_errors_it_knows():
    clean, noisy = TrainingConfig(noise=0.001), TrainingConfig(noise=0.005, noise_up_to=0.1)
    assert noise_hint(clean, 0.001) == noise_hint(noisy, 0.1) == noise_hint(noisy, 0.5) == ""
    errors = dict.fromkeys(CONDUCTANCES, 0.001) | {"G_RL": 0.01}
    assert "errors of up to 0.001 e²/h: for 0.01 e²/h" in noise_hint(clean, errors)


@pytest.mark.parametrize(
    ("misfit", "says"),
    [
        ([0.0101, 0.01, 0.0099, np.nan], "10 times the noise in all channels alike"),
        ([0.0006, 0.0006, 0.00061, 0.0006], "was stated: smaller, and so the error bars"),
        (
            [0.0001, 0.0004, 0.00031, 0.0001],
            "0.4 times the noise at most: the noise may be smaller",
        ),
        ([0.00102, 0.00099, 0.001, 0.001], ""),
        ([0.01, 0.02, 0.01, 0.02], ""),  # something else is wrong
        ([np.nan] * 4, ""),
    ],
)
def test_noise_that_is_other_than_stated_is_noticed(misfit, says):
    hint = stated_noise_hint(np.array(misfit), np.full(4, 0.001), excess=10.0)
    assert says in hint
    assert bool(says) == bool(hint)
    assert stated_noise_hint(np.array(misfit), np.zeros(4), excess=10.0) == ""
    few_data = stated_noise_hint(np.array(misfit), np.full(4, 0.001), excess=-2.0)
    assert few_data == ""  # as many unknowns explain whatever the noise is


def test_one_channel_is_not_alike():
    """Whatever the model lacks, its misfit is larger; a smaller one is a sign of less noise."""
    noise, one = np.full(4, 0.001), np.array([1.0, np.nan, np.nan, np.nan])
    assert stated_noise_hint(0.004 * one, noise, excess=10.0) == ""
    assert "smaller" in stated_noise_hint(0.0004 * one, noise, excess=-10.0)


def test_the_summary_says_it_all(inferred):
    failed = inferred.assign_attrs(verdict=NOT_DESCRIBED)
    assert "neither error bars nor P(topological)" in summary(failed)[1]
    lines = "\n".join(summary(inferred))
    assert "neither" not in lines
    assert "verdict         converged" in lines
    assert "; before: 6.4 to 9.6 meV nm\n" in lines
    assert "from            the prior\nattempts        1, rounds: " in lines
    assert lines.count("noise: 0.001 e²/h") == 4


def test_the_shipped_network_and_the_rounds_find_a_fixed_wire():
    """The paper's sizes, the network's guess and an error of 0.01 e²/h: some µeV."""
    from disorder_landscape.learning.model import load_model

    model = load_model(shipped_model(FIVE, 0.01))
    config = model.config.dataset.model_copy(update={"seed": 2026})
    true = realization(config, 1)
    G = measure(true.wire, 0.01, config)
    guess = dl.predict(model, G)
    result = dl.infer(G, model, 0.01)
    assert result.attrs["verdict"] == CONVERGED
    assert result.attrs["start"] == "the network's guess"
    assert site_error(result, true.potential) < 0.002
    assert float(np.sqrt(((guess["potential"] - true.potential) ** 2).mean())) > 0.004


def test_a_prior_is_read_from_its_file(measured, tmp_path):
    path = tmp_path / "prior.toml"
    path.write_text("components = 1\nsites = 50\ng = [23, 27]\n")
    by_file = observation_of(measured, path, {"G_LL": 0.01, "G_RR": 0.01, "G_LR": 0.1, "G_RL": 0.1})
    assert by_file.unknowns.prior.g == Uniform(23, 27)
    local = observation_of(measured[["G_LL", "G_RR"]], str(path), {"G_LL": 0.02, "G_RR": 0.01})
    assert local.noise[:2].tolist() == [0.02, 0.01]
    with pytest.raises(ArgumentError, match="noise must be one number in e²/h, or one for each"):
        observation_of(measured, path, {"G_LL": 0.02, "G_RR": 0.01})


def test_biases_without_data_are_left_out(measured):
    """… so that they may be beyond the gap."""
    bias = measured["bias"].to_numpy()
    beyond = measured.assign_coords(bias=[*bias[:-1], 0.5])
    beyond = beyond.where(beyond["bias"] < 0.4).assign_attrs(measured.attrs)
    found = measurement_of(beyond)
    np.testing.assert_array_equal(found.bias, bias[:-1])
    np.testing.assert_array_equal(found.G[..., 1], measured["G_RR"][:, :, :-1])
