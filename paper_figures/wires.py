"""The test realizations a figure shows: their true and predicted wires, simulated alike."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
import xarray as xr
from tqdm import tqdm

from disorder_landscape import Nanowire
from disorder_landscape.arguments import require
from disorder_landscape.config import Config, WireConfig
from disorder_landscape.model.quantities import DRAWN

ROWS = ("input", "prediction")
"""The wire itself, and the wire with the disorder and α that the network predicts."""
SUFFIX = {"input": "", "prediction": "_predicted"}


def drawn_realizations(evaluation: xr.Dataset, config: Config) -> xr.Dataset:
    """Return the configuration's choice of test realizations.

    Raises
    ------
    ArgumentError
        If there are not as many test realizations.
    """
    chosen, there = config.figures.realizations, evaluation.sizes["realization"]
    must = f"be below {there}, the number of test realizations"
    require(max(chosen) < there, "figures.realizations", must, f"it is {list(chosen)}")
    return evaluation.isel(realization=list(chosen))


def simulate_rows(
    chosen: xr.Dataset, fixed: WireConfig, simulate: Callable[[Nanowire], xr.Dataset]
) -> xr.Dataset:
    """Simulate the true and the predicted wire of each realization, with a progress bar.

    Parameters
    ----------
    chosen : Dataset
        Of `drawn_realizations`.
    fixed : WireConfig
        What all wires have in common.
    simulate : callable
        Gives what is to be drawn of one wire.

    Returns
    -------
    xarray.Dataset
        What simulate gives, with leading dims (realization, row), and alpha (realization, row) in
        meV nm.
    """
    table = in_rows(chosen)
    wires = [
        wire_of(table, i, j, fixed)
        for i in range(table.sizes["realization"])
        for j in range(len(ROWS))
    ]
    simulated = [simulate(wire) for wire in _progress(wires)]
    pairs = [xr.concat(simulated[i : i + 2], "row") for i in range(0, len(wires), 2)]
    stacked = xr.concat(pairs, "realization").assign_coords(
        row=table["row"], realization=table["realization"]
    )
    return stacked.assign(alpha=table["alpha"])


def in_rows(chosen: xr.Dataset) -> xr.Dataset:
    """Return components, alpha and potential with a dim row: input, prediction.

    Returns
    -------
    xarray.Dataset
        components (realization, row, component) and potential (realization, row, site) in meV,
        alpha (realization, row) in meV nm.
    """
    rows = [
        xr.Dataset({name: chosen[name + end].variable for name in DRAWN}) for end in SUFFIX.values()
    ]
    table = xr.concat(rows, "row", combine_attrs="override").transpose("realization", "row", ...)
    coords = {name: chosen[name] for name in ("realization", "component", "site")}
    return table.assign_coords({"row": list(ROWS), **coords})


def wire_of(table: xr.Dataset, i: int, row: int, fixed: WireConfig) -> Nanowire:
    """Return the wire of realization i in a row of `in_rows`."""
    return fixed.with_disorder(table["potential"][i, row].to_numpy(), float(table["alpha"][i, row]))


def letters(data: xr.Dataset) -> list[str]:
    """Return a, b, c, … for the realizations."""
    return [chr(ord("a") + i) for i in range(data.sizes["realization"])]


def alphas(data: xr.Dataset, i: int) -> str:
    """Return what a realization's α is and what the network says, for a title.

    Nothing where it is fixed, and so known.
    """
    if len(np.unique(data["alpha"])) == 1:
        return ""
    true, predicted = (float(alpha) for alpha in data["alpha"][i])
    return rf"$\alpha$ = {true:.2f}, predicted {predicted:.2f} meV nm"


def _progress(wires: list[Nanowire]) -> Iterable[Nanowire]:
    bar: Iterable[Nanowire] = tqdm(wires, desc="simulate", unit=" wires", delay=2)
    return bar
