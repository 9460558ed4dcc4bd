"""What `landscape simulate` does: make a wire, collect conductance and T_IV, plot them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from disorder_landscape.arguments import require, whole_number_in
from disorder_landscape.model.disorder import disorder_realization
from disorder_landscape.model.parameters import (
    COMPONENTS,
    MOST_SITES,
    SITES,
    FloatArray,
    Nanowire,
    check_leads,
)
from disorder_landscape.model.quantities import AXES, CONDUCTANCES, with_units
from disorder_landscape.observables.conductance import conductance
from disorder_landscape.observables.grids import Progress
from disorder_landscape.observables.visibility import topological_visibility
from disorder_landscape.parts import needs
from disorder_landscape.pictures import write_picture
from disorder_landscape.potential_file import read_potential
from disorder_landscape.symbols import axis_value, colour_scale, symbol


def chosen_wire(
    potential: Path | None,
    seed: int | None,
    components: int | None,
    sites: int | None,
    **parameters: Any,
) -> Nanowire:
    """Return the wire that the options of a command describe.

    Its potential is that of a file, or is drawn with a seed, or is zero.

    Parameters
    ----------
    potential : Path, optional
    seed : int, optional
    components : int, optional
        Of a drawn potential; by default the paper's five.
    sites : int, optional
        By default those of the file, or the paper's.
    **parameters
        Others of `Nanowire`.

    Raises
    ------
    ArgumentError
        If they do not go together, or one of the numbers cannot be.
    """
    both = "one of --potential and --seed at most"
    require(potential is None or seed is None, "potential", f"come with {both}", "both are given")
    is_pristine = components == 0 and potential is None
    goes = components is None or seed is not None or is_pristine
    require(goes, "components", "come with --seed, which draws them", "there is none")
    if potential is not None:
        V = read_potential(potential)
        fits = sites in (None, V.size)
        require(fits, "potential", f"have {sites} sites, as --sites says", f"it has {V.size}")
        return Nanowire(V, **parameters)
    sites = whole_number_in("sites", SITES if sites is None else sites, 2, MOST_SITES)
    components = COMPONENTS if components is None else components
    if seed is None or components == 0:
        return Nanowire(np.zeros(sites), **parameters)
    components = whole_number_in("components", components, 0, sites - 1)
    V = disorder_realization(np.random.default_rng(seed), components, sites)[1]
    return Nanowire(V, **parameters)


def simulate_wire(
    wire: Nanowire,
    grids: Mapping[str, FloatArray],
    temperature: float,
    solver: str,
    theta: float = 0.0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Return conductance, T_IV (without dissipation) and potential of a wire in one dataset.

    Parameters
    ----------
    wire : Nanowire
    grids : mapping
        mu in meV, B in T, bias in meV.
    temperature : float
        In K.
    solver : {"fast", "kwant"}
    theta : float
        Angle of the field relative to the wire in radians.
    progress : callable, optional
        As in `conductance`.

    Raises
    ------
    ArgumentError
        As `conductance`, or if nothing could conduct.
    """
    check_leads(wire.lead_mu, wire.mass, wire.lattice)
    result = conductance(
        wire,
        grids["mu"],
        grids["B"],
        grids["bias"],
        temperature=temperature,
        solver=solver,
        progress=progress,
        theta=theta,
    )
    if wire.lossless:
        result["T_IV"] = topological_visibility(
            wire, grids["mu"], grids["B"], solver=solver, theta=theta
        )
    result["potential"] = ("site", wire.potential)
    return with_units(result)


@needs("figures")
def plot_simulation(result: xr.Dataset, path: Path) -> None:
    """Draw a quick look: each conductance, as a map or a curve over the two longest axes.

    Raises
    ------
    ArgumentError
        If the file cannot be written.
    """
    from matplotlib.figure import Figure

    axes = sorted(AXES, key=lambda name: result.sizes[name])
    cut = axes[:2] if result.sizes[axes[1]] == 1 else axes[:1]
    shown = result.isel({name: result.sizes[name] // 2 for name in cut})
    *y, x = sorted(set(axes) - set(cut), key=["bias", "mu", "B"].index)
    at = [axis_value(name, f"{float(shown[name]):.3g}") for name in cut]
    if theta := result.attrs.get("theta"):
        at.append(f"field at {np.degrees(theta):.3g}° to the wire")
    figure = Figure(figsize=(12, 3), layout="constrained")
    figure.suptitle(", ".join(at))
    for panel, name in zip(figure.subplots(1, 4), CONDUCTANCES, strict=True):
        G, unit = shown[name], "$e^2/h$"
        if y:
            colours = colour_scale(name, float(abs(G).max()))
            G.plot.pcolormesh(x=x, y=y[0], ax=panel, cbar_kwargs={"label": unit}, **colours)
        else:
            G.plot.line("k.-", x=x, ax=panel)
            panel.set_ylabel(unit)
        panel.set_title(symbol(name))
    write_picture(path, figure, dpi=150)
