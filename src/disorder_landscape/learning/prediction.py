"""From measured conductances to disorder: what the trained network says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from disorder_landscape.learning.model import TrainedModel, load_model, on_grid_of
from disorder_landscape.learning.scaling import conductance_array
from disorder_landscape.model.disorder import potential_from_components
from disorder_landscape.model.quantities import CONDUCTANCES, with_units
from disorder_landscape.model.stated import check_wire_of_networks


def predict(model: str | Path | TrainedModel, G: xr.Dataset) -> xr.Dataset:
    """Return the disorder and α that a trained network sees in conductances.

    Parameters
    ----------
    model : path or TrainedModel
        Folder of a trained model, or what `load_model` made of it.
    G : Dataset
        Variables G_LL, G_RR, G_LR, G_RL in e²/h on the model's (mu, B, bias) grid, or one that
        holds it, dimensions in any order; one wire, or several along the dimension realization.

    Returns
    -------
    Dataset
        components (component) and potential (site) in meV, alpha in meV nm, each with a leading
        realization where G has one. The potential has mean zero unless the network predicts it
        (`training.predict_mean`); alpha is the configuration's where it is no label.

    Raises
    ------
    ArgumentError
        If G lacks a variable, holds NaN, lacks a point of the grid, or states a wire unlike those
        that the model has seen, or the folder holds no model.
    """
    if not isinstance(model, TrainedModel):
        model = load_model(model)
    dataset = model.config.dataset
    seen = on_grid_of(dataset, G)
    check_wire_of_networks(G.attrs)
    X = conductance_array(seen)
    Y = model.predict_labels(X)
    columns = dict(zip(model.labels.names, Y.T, strict=True))
    components = Y[:, : dataset.components]
    alpha = columns.get("alpha", np.full(len(Y), dataset.alpha_range[0]))
    mean = columns.get("mean", np.zeros(len(Y)))
    potential = potential_from_components(components, dataset.sites, mean)
    data = {
        "components": (("realization", "component"), components),
        "potential": (("realization", "site"), potential),
        "alpha": ("realization", alpha),
    }
    coords = {
        "component": np.arange(1, dataset.components + 1),
        "site": np.arange(dataset.sites),
    }
    predicted = with_units(xr.Dataset(data, coords=coords, attrs={"config_hash": dataset.hash}))
    if all("realization" not in G[name].dims for name in CONDUCTANCES):
        return predicted.isel(realization=0)
    if "realization" in G.coords:
        predicted = predicted.assign_coords(realization=G["realization"])
    return predicted
