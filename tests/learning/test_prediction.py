"""From conductances to disorder, with bad input refused."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
import xarray as xr

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.learning.mirror import mirrored_labels
from disorder_landscape.learning.model import TrainedModel, load_model
from disorder_landscape.learning.networks.build import build_network
from disorder_landscape.learning.prediction import predict
from disorder_landscape.learning.scaling import LabelScaler, conductance_array, label_names
from disorder_landscape.model.disorder import potential_from_components
from synthetic import synthetic_dataset, tiny_config


@pytest.fixture(scope="module")
def model(trained):
    return load_model(trained)


@pytest.fixture(scope="module")
def G(dataset):
    return dataset[["G_LL", "G_RR", "G_LR", "G_RL"]].isel(realization=slice(-40, None))


def test_prediction_has_names_units_and_the_realizations_of_G(model, G):
    G = G.assign_coords(realization=np.arange(360, 400))
    Y = predict(model, G)
    assert Y["components"].dims == ("realization", "component")
    assert Y["potential"].dims == ("realization", "site")
    assert Y.sizes == {"realization": 40, "component": 5, "site": 60}
    assert [Y[name].attrs["units"] for name in ("components", "alpha")] == ["meV", "meV nm"]
    np.testing.assert_array_equal(Y["realization"], G["realization"])
    np.testing.assert_array_equal(Y["component"], [1, 2, 3, 4, 5])


def test_prediction_is_close_to_the_truth(model, G, dataset):
    Y = predict(model, G)
    truth = dataset.isel(realization=slice(-40, None))
    assert float(abs(Y["alpha"] - truth["alpha"]).mean()) < 0.3  # its own deviation is 0.92
    assert float((Y["potential"] - truth["potential"]).std()) < 0.3 * truth["potential"].std()


def test_potential_is_that_of_the_components(model, G):
    Y = predict(model, G)
    V = potential_from_components(Y["components"].to_numpy(), 60)
    np.testing.assert_allclose(Y["potential"], V, atol=1e-15)
    np.testing.assert_allclose(Y["potential"].mean("site"), 0, atol=1e-15)


def test_folder_and_loaded_model_say_the_same(trained, model, G):
    assert predict(trained, G).identical(predict(str(trained), G))
    assert predict(trained, G).identical(predict(model, G))


def test_order_of_dimensions_and_number_of_wires_do_not_matter(model, G):
    Y = predict(model, G)
    assert predict(model, G.transpose("bias", "mu", "realization", "B")).identical(Y)
    one = predict(model, G.isel(realization=7))
    assert one["components"].dims == ("component",)
    for name in one.data_vars:
        np.testing.assert_allclose(one[name], Y[name][7], atol=1e-5)


def test_prediction_of_the_mirrored_wire_is_the_mirrored_prediction(model, G):
    swapped = G.rename(G_LL="G_RR", G_RR="G_LL", G_LR="G_RL", G_RL="G_LR")
    Y, Y_swapped = predict(model, G), predict(model, swapped)
    expected = mirrored_labels(Y["components"].to_numpy(), 5)
    np.testing.assert_allclose(Y_swapped["components"], expected, atol=1e-12)
    np.testing.assert_allclose(Y_swapped["alpha"], Y["alpha"], atol=1e-12)


def test_alpha_is_the_configs_where_it_is_no_label():
    config = tiny_config(realizations=4, width_fraction=0.01, mirror=False, compress_inputs=False)
    fixed = config.dataset.model_copy(update={"alpha_range": (7.5, 7.5)})
    config = config.model_copy(update={"dataset": fixed})
    names = label_names(5, alpha_is_label=False)
    network = build_network((8, 8, 5, 4), 5, 0.01)
    model = TrainedModel(network, LabelScaler(names, np.zeros(5), np.ones(5)), None, config)
    Y = predict(model, synthetic_dataset(config))
    assert Y["alpha"].values.tolist() == [7.5] * 4
    assert Y.sizes["component"] == 5


def test_the_potential_has_the_mean_that_the_network_predicts():
    config = tiny_config(realizations=4, width_fraction=0.01, mirror=True, predict_mean=True)
    names = label_names(5, alpha_is_label=True, mean_is_label=True)
    labels = LabelScaler(names, np.arange(7.0), np.ones(7))
    model = TrainedModel(build_network((8, 8, 5, 4), 7, 0.01), labels, None, config)
    G = synthetic_dataset(config)
    said = model.predict_labels(conductance_array(G))
    Y = predict(model, G)
    np.testing.assert_allclose(Y["potential"].mean("site"), said[:, 6])
    np.testing.assert_array_equal(Y["alpha"], said[:, 5])
    swapped = G.rename(G_LL="G_RR", G_RR="G_LL", G_LR="G_RL", G_RL="G_LR")
    np.testing.assert_allclose(predict(model, swapped)["potential"], Y["potential"][:, ::-1])


@pytest.mark.parametrize(
    ("change", "axes"),
    [
        (lambda G: G.assign_coords(mu=G["mu"] + 0.01), "mu"),
        (lambda G: G.isel(B=slice(0, 7)), "B"),
        (lambda G: G.assign_coords(mu=2 * G["mu"], bias=G["bias"] / 2), "mu, bias"),
        (lambda G: G.drop_vars("B"), "B"),
        (lambda G: G.assign_coords(mu=G["mu"].where(G["mu"] > 0)), "mu"),
    ],
)
def test_another_grid_is_refused(model, G, change, axes):
    with pytest.raises(ArgumentError, match=rf"trained on .*, but it differs in {axes}\.$"):
        predict(model, change(G))


def test_conductances_with_nan_are_refused(model, G):
    with pytest.raises(ArgumentError, match="G must be finite"):
        predict(model, G.where(G["G_LL"] < G["G_LL"].max()))


def test_a_missing_folder_is_refused(tmp_path, G):
    with pytest.raises(ArgumentError, match="model must be a folder written by `landscape train`"):
        predict(tmp_path / "nothing", G)


@pytest.mark.parametrize("name", ["network.keras", "scaler.json", "config.json"])
def test_a_truncated_file_is_refused(trained, tmp_path, G, name):
    folder = tmp_path / "damaged"
    shutil.copytree(trained, folder)
    whole = (folder / name).read_bytes()
    (folder / name).write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ArgumentError, match=f"model must .*{name}"):
        predict(folder, G)


def test_of_a_larger_grid_the_network_sees_its_own_points(model, G):
    between = G.assign_coords(mu=G["mu"] + 0.01, B=G["B"] + 0.02)
    larger = xr.concat([G, between], "mu", join="outer").sortby("mu").fillna(-1.0)
    assert larger.sizes["B"] == 2 * G.sizes["B"]
    assert predict(model, larger).equals(predict(model, G))


@pytest.mark.parametrize("g", [20.0, "25 or so", np.nan])
def test_conductances_of_another_wire_are_refused(model, G, g):
    with pytest.raises(ArgumentError, match="Argument g must be "):
        predict(model, G.assign_attrs(g=g))
