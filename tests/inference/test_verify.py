"""Predictions compared with measurements: the truth passes, wrong disorder does not."""

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import disorder_landscape as dl
from disorder_landscape import ArgumentError, Nanowire, conductance
from disorder_landscape.config import DatasetConfig, WireConfig
from disorder_landscape.inference.verification.comparison import scores, table
from disorder_landscape.inference.verification.controls import control_wires, wires_like
from disorder_landscape.model.disorder import cosine_components
from disorder_landscape.model.quantities import CONDUCTANCES

SITES, COMPONENTS, CONTROLS = 100, 3, 19
CONFIG = DatasetConfig(realizations=1, sites=SITES, components=COMPONENTS)
OTHER_LEADS = CONFIG.model_copy(update={"wire": WireConfig(lead_mu=10.0)})
TRUE = control_wires(CONFIG, 1, seed=5)[0]
SETTINGS = {"mu": [0.1, 0.4], "B": [0.2, 0.5], "bias": [-0.03, 0.01, 0.05]}


def measure(wire, theta=0.0, barrier=(15.0, 15.0), noise=0.0, **settings):
    G = conductance(replace(wire, barrier=barrier), **(SETTINGS | settings), theta=theta)
    rng = np.random.default_rng(1)
    for name in CONDUCTANCES:
        G[name] += noise * rng.normal(size=G[name].shape)
    return G


def prediction_of(wire, shift=0.0):
    """What a perfect network says: everything but the mean of V."""
    c = cosine_components(wire.potential)
    return xr.Dataset(
        {
            "potential": ("site", wire.potential - wire.potential.mean() + shift),
            "components": ("component", c[1 : COMPONENTS + 1]),
            "alpha": wire.alpha,
        }
    )


def verify(prediction, *measurements, controls=CONTROLS, **options):
    return dl.verify(prediction, measurements, controls=controls, **options)


def test_the_truth_passes_at_settings_of_every_kind():
    measured = [
        measure(TRUE),
        measure(TRUE, barrier=(20.0, 5.0)),
        measure(TRUE, theta=0.5, mu=0.1, B=0.5),
    ]
    calls = []
    result = verify(prediction_of(TRUE), *measured, progress=lambda *pair: calls.append(pair))
    assert result["mismatch"].dims == ("measurement", "channel")
    assert result["control_mismatch"].shape == (CONTROLS, 3, 4)
    assert result["p_value"] == pytest.approx(1 / (1 + CONTROLS))
    assert result.attrs["verdict"].startswith("The prediction passes: ")
    assert (result["score"] < 0.2 * result["control_score"]).all()
    np.testing.assert_allclose(
        result["ratio"], result["mismatch"] / result["control_mismatch"].median("control")
    )
    done, in_all = (list(numbers) for numbers in zip(*calls, strict=True))
    assert sum(done) == in_all[0] == in_all[-1] == (1 + CONTROLS) * (2 * (13 + 9) * 4 + 1)


def test_exact_knowledge_leaves_no_mismatch():
    whole = prediction_of(TRUE, shift=TRUE.potential.mean())
    result = verify(whole, measure(TRUE, barrier=(12.0, 30.0)), shifts=[0.0])
    assert result["mismatch"].max() < 1e-12
    assert result["shift"] == 0
    tilted = verify(whole, measure(TRUE, theta=-0.8, mu=0.4, B=0.5), shifts=0.0)
    assert tilted["mismatch"].max() < 1e-12


def test_settings_matter():
    """At another angle, barrier or temperature the very wire is another measurement."""
    whole = prediction_of(TRUE, shift=TRUE.potential.mean())
    for name, value in {"theta": 0.8, "barrier": (30.0, 5.0), "temperature": 0.02}.items():
        G = measure(TRUE, mu=0.1, B=0.5)
        G.attrs[name] = value
        assert verify(whole, G, shifts=0.0)["mismatch"].max() > 1e-3


def test_wrong_disorder_fails():
    wrong = control_wires(CONFIG, 1, seed=6)[0]
    result = verify(prediction_of(wrong), measure(TRUE))
    assert result["p_value"] > 0.05
    assert result.attrs["verdict"].startswith("The prediction fails: ")
    assert 0.3 < result["score"] < 3


def test_the_mean_of_V_is_found():
    shifted = replace(TRUE, potential=TRUE.potential - TRUE.potential.mean() + 0.02)
    result = verify(prediction_of(TRUE), measure(shifted))
    assert result["shift"] == pytest.approx(0.02)
    assert result["ratio"].max() < 1e-3
    without = verify(prediction_of(TRUE), measure(shifted), shifts=[0.0])
    assert without["ratio"].min() > 0.05


def test_controls_are_those_of_the_seed_and_of_the_model():
    one, two = (control_wires(CONFIG, 3, seed=7) for _ in range(2))
    for a, b in zip(one, two, strict=True):
        np.testing.assert_array_equal(a.potential, b.potential)
    assert one[0].alpha != one[1].alpha
    assert abs(cosine_components(one[0].potential)[COMPONENTS + 1 :]).max() < 1e-12
    measured = measure(TRUE)
    first, same = (verify(prediction_of(TRUE), measured, seed=3) for _ in range(2))
    xr.testing.assert_identical(first, same)
    given = verify(prediction_of(TRUE), measured, seed=3, config=CONFIG)
    xr.testing.assert_identical(first, given)
    other = verify(prediction_of(TRUE), measured, seed=4)
    assert (other["control_mismatch"] != first["control_mismatch"]).any()


def test_noise_is_seen_as_such():
    clean, noisy = (
        verify(prediction_of(TRUE), measure(TRUE, noise=noise), noise=noise)
        for noise in (0.0, 0.05)
    )
    assert noisy["p_value"] <= 0.05  # the local channels still tell
    assert (noisy["mismatch"] > 0.02).all()
    assert noisy["score"] > clean["score"]
    blind = verify(prediction_of(TRUE), measure(TRUE, noise=1.0), noise=1.0)
    assert blind.attrs["verdict"].startswith("Nothing can be said")


def test_noise_is_that_which_each_measurement_states():
    measured = measure(TRUE, noise=0.05)
    each = [0.05, 0.05, 0.01, 0.02]
    given = [measured.assign_attrs(noise=0.05), measured.assign_attrs(noise=each), measured]
    found = verify(prediction_of(TRUE), *given)
    np.testing.assert_array_equal(found["noise"], [4 * [0.05], each, 4 * [0.0]])
    assert "noise: 0, 0.01, 0.02, 0.05 e²/h" in "\n".join(
        table(found.assign_coords(measurement=list("abc")))
    )
    same = verify(prediction_of(TRUE), measured, noise=dict(zip(CONDUCTANCES, each, strict=True)))
    assert same["score"] == verify(prediction_of(TRUE), given[1])["score"]


def test_leads_are_those_of_the_model():
    wire = replace(TRUE, lead_mu=10.0)
    predicted = prediction_of(TRUE, TRUE.potential.mean())
    found = verify(predicted, measure(wire), config=OTHER_LEADS, shifts=[0.0])
    assert found["mismatch"].max() < 1e-9


def test_channels_of_noise_have_no_weight():
    typical = np.array([[0.2, 0.2, 0.01, 0.01]])
    squares = np.array([[0.0, 0.0, 1e-4, 1e-4]])
    none = np.zeros((1, 4))
    assert scores(squares, typical, none + 0.01) == 0
    assert scores(squares, typical, none) == pytest.approx(np.sqrt(0.5))
    assert scores(typical**2, typical, none) == pytest.approx(1.0)


def test_the_table_says_it_all():
    result = verify(prediction_of(TRUE), measure(TRUE), measure(TRUE, barrier=(9.0, 3.0)))
    lines = table(result.assign_coords(measurement=["first.nc", "second.nc"]))
    text = "\n".join(lines)
    for text_of in ("first.nc", "second.nc", *CONDUCTANCES, "mean of V", result.attrs["verdict"]):
        assert text_of in text
    assert len(lines) == 1 + 8 + 2
    assert max(len(line) for line in lines[:-1]) <= 100


def changed(**attributes):
    G = measure(TRUE, mu=0.1, B=0.5, bias=0.0)
    G.attrs.update(attributes)
    return G


def lacking(name):
    G = changed()
    del G.attrs[name]
    return G


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"measurements": []}, "measurement must be one Dataset or more, but there is none"),
        ({"measurements": [3]}, "measurement must be a Dataset, but it is 'int'"),
        ({"measurements": changed().drop_vars(CONDUCTANCES)}, "it lacks G_LL, G_RR, G_LR, G_RL"),
        ({"measurements": changed().isel(mu=0, drop=True)}, "it lacks mu"),
        ({"measurements": changed().expand_dims(realization=2)}, "realization"),
        ({"measurements": lacking("theta")}, "must state theta, barrier, temperature"),
        ({"measurements": lacking("barrier")}, "it lacks barrier"),
        ({"measurements": changed(barrier=15.0)}, "barrier must be two numbers in meV"),
        ({"measurements": changed(barrier="high")}, "barrier must be two numbers in meV"),
        ({"measurements": changed(theta=30.0)}, "theta must be a number from -6.28"),
        ({"measurements": changed(temperature=-1.0)}, "temperature must be"),
        ({"measurements": (changed() * np.nan).assign_attrs(changed().attrs)}, "finite numbers"),
        ({"prediction": xr.Dataset()}, "prediction must hold the potential"),
        ({"prediction": None}, "prediction must hold the potential"),
        ({"prediction": prediction_of(TRUE).expand_dims(realization=2)}, "the dims of potential"),
        ({"prediction": prediction_of(TRUE).drop_vars("components")}, "hold the components"),
        ({"prediction": prediction_of(TRUE).isel(site=slice(50)), "config": CONFIG}, "50 sites"),
        (
            {"prediction": prediction_of(TRUE).assign_attrs(config_hash="x"), "config": CONFIG},
            "come from the model",
        ),
        ({"noise": -1.0}, "noise must be a number from 0 to 1 e²/h"),
        ({"controls": 5}, "controls must be a number from 19"),
        ({"shifts": [0.1, 0.0]}, "shifts must be a number or an increasing list"),
        ({"seed": -1}, "seed must"),
    ],
)
def test_bad_input_is_one_sentence(arguments, says):
    usual = {"prediction": prediction_of(TRUE), "measurements": changed()}
    with pytest.raises(ArgumentError, match=r"^Argument .* must .*, but .*\.$") as error:
        dl.verify(**(usual | arguments))
    assert says in str(error.value)


def test_a_wire_of_another_length_is_a_prediction_like_any_other():
    other = Nanowire(np.zeros(60))
    assert verify(prediction_of(other), measure(TRUE))["p_value"] > 0.05


def inversion_of(wire, apart):
    """Return what `infer` would: samples whose V and α are off by these."""
    one = prediction_of(wire, shift=wire.potential.mean())
    off = xr.DataArray(apart, dims="sample")
    return one.assign(
        potential=(one["potential"] + off).transpose("sample", "site"),
        potential_mean=one["potential"],
        alpha=wire.alpha + off,
        alpha_mean=wire.alpha,
    ).assign_attrs(prior=json.dumps(dl.Prior(COMPONENTS, SITES, alpha=(1, 20)).to_dict()))


def test_what_an_inversion_has_found_is_judged_by_its_mean():
    found = inversion_of(TRUE, 1e-4 * np.array([-1.0, 0.0, 1.0]))
    measured = measure(TRUE, barrier=(12.0, 30.0))
    assert verify(found, measured, shifts=[0.0])["mismatch"].max() < 1e-9


def test_what_was_not_measured_has_no_weight():
    """… neither channels nor single numbers; and other settings are as they were found."""
    found = inversion_of(TRUE, 1e-3 * np.random.default_rng(2).normal(size=60))
    whole = measure(TRUE, noise=0.01)
    some = whole.drop_vars(["G_LR", "G_RL"])
    some["G_RR"] = some["G_RR"].where(some["bias"] < 0)
    result = verify(found, some, noise=0.01, shifts=[0.0])
    for name in ("mismatch", "control_mismatch", "ratio", "noise"):
        assert np.isnan(result[name].sel(channel=["G_LR", "G_RL"])).all()
    below = verify(found, whole.sel(bias=[-0.03]), noise=0.01, shifts=[0.0])
    local = verify(found, whole, noise=0.01, shifts=[0.0])
    np.testing.assert_allclose(result["mismatch"][0, 0], local["mismatch"][0, 0], rtol=1e-3)
    np.testing.assert_allclose(result["mismatch"][0, 1], below["mismatch"][0, 1], rtol=1e-3)
    assert result["p_samples"] > 0.02
    assert result.attrs["verdict"].startswith("The prediction passes: ")
    lines = table(result.assign_coords(measurement=["some"]))
    assert sum(line.endswith("not measured") for line in lines) == 2
    assert not any("nan" in line for line in lines)


def test_one_value_of_an_axis_may_be_a_scalar():
    found, one = prediction_of(TRUE), measure(TRUE).isel(mu=[1])
    scalar = verify(found, one.isel(mu=0))
    np.testing.assert_array_equal(scalar["mismatch"], verify(found, one)["mismatch"])


def test_settings_that_a_measurement_does_not_state_are_as_an_inversion_has_found_them():
    found = inversion_of(TRUE, np.zeros(60))
    prior = dl.Prior(COMPONENTS, SITES, alpha=(1, 20), temperature=0.04, barrier_left=(10, 20))
    prior = replace(prior, barrier_right=20.0)
    stated = {"temperature": 0.04, "barrier_left": 15.0, "barrier_right": 20.0}
    found = found.assign_attrs(
        prior=json.dumps(prior.to_dict()), theta=0.0, settings=json.dumps(stated)
    )
    found = found.assign(barrier_left_mean=12.0, barrier_left=("sample", np.full(60, 12.0)))
    measured = measure(TRUE, barrier=(12.0, 20.0), temperature=0.04)
    others = measure(TRUE, barrier=(18.0, 20.0), temperature=0.04)
    as_before = measured.assign_attrs(barrier=(15.0, 20.0))
    for one in (measured.drop_attrs(), as_before, others):
        result = verify(found, one, shifts=[0.0])
        assert result["mismatch"].max() < 1e-9
        assert result["p_samples"] > 0.02
    with pytest.raises(ArgumentError, match=r"^Argument prediction .* settings is damaged\.$"):
        verify(found.assign_attrs(settings="[3]"), measured)
    with pytest.raises(ArgumentError, match="g must be 25, as in the prior"):
        verify(
            found.assign_attrs(prior=json.dumps(replace(prior, g=25.0).to_dict())),
            measured.assign_attrs(g=30.0),
        )


def test_settings_that_an_inverted_measurement_did_not_state_are_stated_by_others():
    """… and taken, though they are the usual ones."""
    prior = dl.Prior(COMPONENTS, SITES, alpha=(1, 20), temperature=0.1)
    found = inversion_of(TRUE, np.zeros(60)).assign_attrs(
        prior=json.dumps(prior.to_dict()), settings="{}"
    )
    for temperature, stated in ((0.05, True), (0.1, False)):
        measured = measure(TRUE, temperature=temperature)
        if not stated:
            del measured.attrs["temperature"]
        assert verify(found, measured, shifts=[0.0])["mismatch"].max() < 1e-9


@pytest.mark.parametrize("name", ["mass", "lattice", "lead_mu"])
def test_another_wire_than_the_inverted_one_is_refused(name):
    found = inversion_of(TRUE, np.zeros(60))
    with pytest.raises(ArgumentError, match=f"{name} must be .*, as in the prior"):
        verify(found, measure(TRUE).assign_attrs({name: 9.0}))


@pytest.mark.parametrize("axis", ["mu", "gate"])
def test_a_gate_voltage_is_not_taken_for_mu(axis):
    found, measured = inversion_of(TRUE, np.zeros(60)), measure(TRUE)
    if axis == "mu":
        measured = measured.rename(mu="gate")
    else:
        found = found.assign_coords(gate=[0.1, 0.4])
    other = "gate" if axis == "mu" else "mu"
    message = f"measurement must be over {axis}, .*, but it is over {other}"
    with pytest.raises(ArgumentError, match=message):
        verify(found, measured)


def test_a_result_of_an_older_version_is_refused_in_one_sentence():
    """Its dim was member, and its error bars had other names."""
    old = inversion_of(TRUE, np.zeros(60)).rename(sample="member")
    message = r"^Argument prediction must have the dim sample, .*, but .*: run infer again\.$"
    with pytest.raises(ArgumentError, match=message):
        verify(old, measure(TRUE))


@pytest.mark.parametrize("barrier", [(15.0, 15.0), (12.0, 30.0)])
def test_samples_of_an_inversion_make_the_data_or_not(barrier):
    """Error bars in meV that hold the truth, and others that do not, as the verdict says."""
    noise, bar = 0.01, 1e-3
    apart = bar * np.random.default_rng(3).normal(size=60)
    measured = measure(TRUE, barrier=barrier, noise=noise)
    options = {"noise": noise, "shifts": [0.0]}
    calls = []
    right = verify(
        inversion_of(TRUE, apart), measured, progress=lambda *pair: calls.append(pair), **options
    )
    assert right["p_samples"] > 0.05
    pairs = measured.sizes["mu"] * measured.sizes["B"]
    done, in_all = (list(numbers) for numbers in zip(*calls, strict=True))
    assert sum(done) == in_all[0] == in_all[-1] == (1 + CONTROLS + apart.size) * pairs
    shifted = replace(TRUE, potential=TRUE.potential + 20 * bar)
    wrong = verify(inversion_of(shifted, apart), measured, **options)
    assert wrong["p_samples"] < 0.02
    assert wrong["score"] < 0.5 * wrong["control_score"].median()  # far better, even so
    few = verify(inversion_of(TRUE, apart[:9]), measured, **options)
    results = (right, wrong, few)
    for result, says in zip(
        results, ("posterior predicts", "does not predict", "cannot say"), strict=True
    ):
        assert says in table(result.assign_coords(measurement=["a"]))[-1]


@pytest.mark.parametrize("config", [None, OTHER_LEADS])
def test_wrong_disorder_is_measured_in_a_wire_as_the_inversion_has_found_it(config):
    """… whose gap is another than the paper's, so that biases are too."""
    wire = replace(TRUE, delta0=0.3)
    found = inversion_of(wire, np.zeros(60))
    prior = dl.Prior(COMPONENTS, SITES, alpha=(1, 20), delta0=0.3)
    found = found.assign_attrs(prior=json.dumps(prior.to_dict()))
    measured = measure(wire, bias=[-0.2, 0.1])
    result = verify(found, measured, shifts=[0.0], config=config)
    assert result["mismatch"].max() < 1e-9
    assert result["control_mismatch"].min() > 1e-4
    one, two = (wires_like(wire, prior, 3, seed=7) for _ in range(2))
    assert [w.delta0 for w in one] == [0.3] * 3
    for first, second in zip(one, two, strict=True):
        np.testing.assert_array_equal(first.potential, second.potential)
    assert len({w.alpha for w in one}) == 3
