"""Figure S9: topological visibility and conductance of a pristine wire.

(a) T_IV, and the transition of an infinite wire, V_Z² = μ² + γ², dashed. Conductances (b) at zero
bias, (c) at μ = 0 and (d) at μ = 0.3 meV. The paper's wire with α = 8 meV nm, the same at every
preset.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from command import Request, figure_script
from disorder_landscape import Nanowire, conductance, topological_visibility
from disorder_landscape.estimates import settings_bar
from disorder_landscape.model.parameters import B_MAX, MU_MAX, SITES, TEMPERATURE
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.observables.visibility import transition_field
from disorder_landscape.symbols import T_IV_COLOURS, T_IV_SYMBOL, axis_label, symbol
from plotting import (
    FULL_WIDTH,
    colour_bar,
    conductance_scale,
    conductance_unit,
    draw_map,
    inches,
    outer_labels,
    write,
)

CUTS = {"mu_c": 0.0, "mu_d": 0.3}
"""μ of (c) and (d) in meV."""
LEFT, GAP, BAR = 0.58, 0.07, 0.6
"""Left margin, gap between panels, and room for a colour bar, in inches."""
WIDTH, HEIGHT = (FULL_WIDTH - LEFT - 2 * GAP - 2 * BAR) / 4, 1.15
"""Size of a panel of (b) to (d)."""
VISIBILITY = (2 * WIDTH + GAP, 1.7)
"""Size of panel (a)."""
TOP, ROW = 0.24, 1.78
"""Room above the first row and pitch of the rows, in inches."""


def data(request: Request) -> xr.Dataset:
    """Return what the four panels show.

    Returns
    -------
    xarray.Dataset
        For (a) T_IV (mu_a, B_a) of the left end and transition (mu_a) in T; in e²/h, for (b)
        G_LL_b … G_RL_b (mu, B), for (c) and (d) G_LL_c … G_RL_d (B, bias).
    """
    figures = request.config.figures
    wire = Nanowire(np.zeros(SITES))
    mu, B = (
        np.linspace(0.0, MU_MAX, figures.pristine_mu_points),
        np.linspace(0.0, B_MAX, figures.pristine_B_points),
    )
    fine_mu = np.linspace(0.0, MU_MAX, figures.visibility_refinement * figures.pristine_mu_points)
    fine_B = np.linspace(0.0, B_MAX, figures.visibility_refinement * figures.pristine_B_points)
    bias = np.linspace(-figures.bias_max, figures.bias_max, figures.bias_points)

    with settings_bar("simulate") as progress:
        G = conductance(wire, mu, B, 0.0, progress=progress)
    T_IV = topological_visibility(wire, fine_mu, fine_B).sel(lead="L", drop=True)
    transition = xr.DataArray(
        transition_field(wire, fine_mu),
        dims="mu_a",
        name="transition",
        attrs={"units": "T", "long_name": "field of the bulk transition"},
    )
    panels = [_lettered(G.isel(bias=0, drop=True), "b")]
    for letter in "cd":
        at_cut = conductance(wire, CUTS[f"mu_{letter}"], B, bias)
        panels.append(_lettered(at_cut.isel(mu=0, drop=True), letter))
    merged = xr.merge([T_IV.rename(mu="mu_a", B="B_a"), transition, *panels])
    parameters = {name: getattr(wire, name) for name in ("alpha", "gamma", "delta0", "g")}
    return merged.drop_attrs(deep=False).assign_attrs(CUTS | parameters, length=wire.length)


def _lettered(G: xr.Dataset, letter: str) -> xr.Dataset:
    return G[list(CONDUCTANCES)].rename({name: f"{name}_{letter}" for name in CONDUCTANCES})


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(FULL_WIDTH, TOP + VISIBILITY[1] + 3 * ROW + 0.38))
    bottom = figure.get_figheight() - TOP - VISIBILITY[1]
    _draw_visibility(figure, data, bottom)
    cuts = {letter: rf"$\mu$ = {data.attrs[f'mu_{letter}']:g} meV" for letter in "cd"}
    for letter, cut in {"b": r"$V_\mathrm{bias}$ = 0", **cuts}.items():
        bottom -= ROW
        _draw_conductances(figure, data, letter, bottom)
        write(figure, 0.04, bottom + HEIGHT + 0.19, f"({letter})  {cut}")
    return figure


def _draw_visibility(figure: Figure, data: xr.Dataset, bottom: float) -> None:
    width, height = VISIBILITY
    axes = inches(figure, LEFT, bottom, width, height)
    norm = Normalize(-1.0, 1.0)
    T_IV = data["T_IV"].rename(mu_a="mu", B_a="B")
    draw_map(axes, T_IV, "mu", norm, T_IV_COLOURS)
    label = r"$V_Z^2 = \mu^2 + \gamma^2$"
    (line,) = axes.plot(data["transition"], data["mu_a"], "k", dashes=(4, 2), label=label)
    line.set_path_effects([withStroke(linewidth=1.8, foreground="w")])
    axes.set(xlabel=axis_label("B"), ylabel=axis_label("mu"), xlim=T_IV["B"][[0, -1]])
    place = (LEFT + width + 0.08, bottom, 0.09, height)
    bar = colour_bar(figure, place, norm, T_IV_COLOURS, T_IV)
    bar.ax.set_title(T_IV_SYMBOL, loc="left", pad=6)
    right, top = LEFT + width + BAR + GAP, bottom + height
    figure.legend(
        handles=[line],
        loc="upper left",
        bbox_to_anchor=(right / FULL_WIDTH, top / figure.get_figheight()),
        borderaxespad=0.0,
        fontsize=9,
    )
    parameters = (
        rf"$\alpha$ = {data.attrs['alpha']:g} meV nm, $L$ = {data.attrs['length']:g} µm",
        rf"$\gamma$ = {data.attrs['gamma']:g} meV, $\Delta_0$ = {data.attrs['delta0']:g} meV",
        rf"$g$ = {data.attrs['g']:g}, $T$ = {1e3 * TEMPERATURE:g} mK in (b)–(d)",
    )
    for i, line_of_text in enumerate(parameters, 1):
        write(figure, right + 0.04, top - 0.05 - 0.19 * i, line_of_text)
    write(figure, 0.04, bottom + height + 0.19, "(a)")


def _draw_conductances(figure: Figure, data: xr.Dataset, letter: str, bottom: float) -> None:
    y = "mu" if letter == "b" else "bias"
    panels = np.empty((1, len(CONDUCTANCES)), dtype=object)
    for column, name in enumerate(CONDUCTANCES):
        G = data[f"{name}_{letter}"].rename(name)
        left = LEFT + column * (WIDTH + GAP) + (column // 2) * (BAR - GAP)
        axes = panels[0, column] = inches(figure, left, bottom, WIDTH, HEIGHT)
        scale = conductance_scale(G)  # the same for both ends: the wire is its own mirror image
        draw_map(axes, G, y, *scale)
        axes.set_title(symbol(name))
        if column % 2:
            unit, words = conductance_unit(name)
            place = (left + WIDTH + 0.08, bottom, 0.09, HEIGHT)
            bar = colour_bar(figure, place, *scale, G, unit)
            bar.ax.set_title(words, loc="left", fontsize=8, pad=5)
    outer_labels(panels, "B", y)


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
