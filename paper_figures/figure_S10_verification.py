"""Figure S10: predictions verified by measurements that the network never saw.

(a) How far the conductances of the predicted wires are from those of the test wires of Figure 3, at
other μ and B, at other biases, with other barriers, and with the field at an angle θ to the wire;
each relative to the median of wires with wrong disorder, which are drawn in grey. (b) One of these
measurements: the conductances of the first test wire (measured), of its prediction, and of a wire
with wrong disorder, in a tilted field. The paper proposes such a test and shows none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from tqdm import tqdm

from command import Request, figure_script
from disorder_landscape import Nanowire, conductance, verify
from disorder_landscape.config import Config
from disorder_landscape.inference.defaults import OTHER_ANGLE, OTHER_BARRIERS, shifts
from disorder_landscape.inference.verification.comparison import scores
from disorder_landscape.inference.verification.controls import control_wires
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.symbols import symbol
from plotting import (
    FULL_WIDTH,
    PREDICTION,
    colour_bar,
    conductance_scale,
    conductance_unit,
    draw_map,
    inches,
    keep_labels_inside,
    label_rows,
    outer_labels,
    write,
)
from wires import drawn_realizations, in_rows, letters, wire_of

KINDS = ("mu, B", "bias", "barrier", "theta")
"""What is other than in the measurement that the network has seen."""
ROWS = ("measured", "prediction", "wrong")
MU, B = (0.22, 0.63), (0.37, 0.83)
"""Between the points of the network's grid, as parts of its μ and B."""
OTHER_BIAS = np.array([-0.05, -0.03, -0.01, 0.01, 0.03, 0.05])
"""In meV."""
MARKERS = "osD^vP"

LEFT, RIGHT, GAP, BARS = 0.74, 0.1, 0.06, 0.52
"""Margins, gap between maps, and room for colour bars, in inches."""
TOP, SCATTER, BETWEEN, HEIGHT = 0.1, 1.75, 0.72, 0.95
"""Room above, height of (a), room between (a) and (b), and height of a map, in inches."""


def data(request: Request) -> xr.Dataset:
    """Return what the two panels show.

    Returns
    -------
    xarray.Dataset
        For (a) ratio (realization, kind) and wrong_ratio (realization, control, kind), p_value and
        shift (realization); for (b) G_LL … G_RL (row, B, bias) in e²/h.
    """
    config = request.config
    chosen = drawn_realizations(request.evaluation(), config)
    table = in_rows(chosen)
    verified = []
    for i in tqdm(range(chosen.sizes["realization"]), desc="verify", unit=" wires", delay=2):
        prediction = table.isel(realization=i, row=1, drop=True)
        true = wire_of(table, i, 0, config.dataset.wire)
        measurements = [_measure(true, kind, config) for kind in KINDS]
        result = verify(
            prediction,
            measurements,
            controls=config.figures.verification_controls,
            config=config.dataset,
            shifts=shifts(config.figures.verification_shifts),
        )
        verified.append(_by_kind(result))
    panel_a = xr.concat(verified, "realization").assign_coords(realization=chosen["realization"])
    return xr.merge([panel_a, _maps(table, config)]).assign_attrs(
        barriers=OTHER_BARRIERS, theta=float(np.degrees(OTHER_ANGLE))
    )


def _measure(wire: Nanowire, kind: str, config: Config) -> xr.Dataset:
    """Return the conductances of a wire at settings that the network has not seen."""
    dataset = config.dataset
    mu, fields = dataset.mu_max * np.array(MU), dataset.B_max * np.array(B)
    if kind == "bias":  # of the network's settings all but the biases
        mu, fields = (
            dataset.mu[:: dataset.mu_points // 2][:2],
            dataset.B[:: dataset.B_points // 2][1:],
        )
    return conductance(
        replace(wire, barrier=OTHER_BARRIERS) if kind == "barrier" else wire,
        mu[:1] if kind == "theta" else mu,
        fields,
        OTHER_BIAS if kind == "bias" else np.array(dataset.bias),
        dataset.temperature,
        theta=OTHER_ANGLE if kind == "theta" else 0.0,
    )


def _by_kind(result: xr.Dataset) -> xr.Dataset:
    """Return the scores of each kind of measurement by itself."""
    mismatch, wrong = (result[n].to_numpy() for n in ("mismatch", "control_mismatch"))
    typical = np.median(wrong, axis=0)
    no_noise = np.zeros_like(typical)
    kinds = [slice(i, i + 1) for i in range(len(KINDS))]
    ratio = [scores(mismatch[i] ** 2, typical[i], no_noise[i]) for i in kinds]
    of_wrong = [scores(wrong[:, i] ** 2, typical[i], no_noise[i]) for i in kinds]
    return xr.Dataset(
        {
            "ratio": ("kind", ratio),
            "wrong_ratio": (("control", "kind"), np.transpose(of_wrong)),
            "p_value": result["p_value"].variable,
            "shift": result["shift"].variable,
        },
        coords={"kind": list(KINDS)},
    )


def _maps(table: xr.Dataset, config: Config) -> xr.Dataset:
    """Return the maps of the first realization, of its prediction and of a control."""
    figures, dataset = config.figures, config.dataset
    fields = np.linspace(0.0, dataset.B_max, figures.tilted_B_points)
    bias = np.linspace(-figures.bias_max, figures.bias_max, figures.bias_points)
    pair = [wire_of(table, 0, row, dataset.wire) for row in (0, 1)]
    wires = [*pair, control_wires(dataset, 1)[0]]
    G = [
        conductance(
            replace(wire, barrier=OTHER_BARRIERS),
            0.0,
            fields,
            bias,
            dataset.temperature,
            theta=OTHER_ANGLE,
        )
        for wire in tqdm(wires, desc="simulate", unit=" wires", delay=2)
    ]
    maps = xr.concat([g[list(CONDUCTANCES)].isel(mu=0, drop=True) for g in G], "row")
    return maps.assign_coords(row=list(ROWS)).drop_attrs(deep=False)


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    height = TOP + SCATTER + BETWEEN + 3 * HEIGHT + 2 * GAP + 0.36 + BARS
    figure = Figure(figsize=(FULL_WIDTH, height))
    bottom = height - TOP - SCATTER
    axes = inches(figure, LEFT, bottom, FULL_WIDTH - LEFT - RIGHT, SCATTER)
    _draw_ratios(axes, data)
    write(figure, 0.04, height - TOP, "(a)")
    angle, (left, right) = data.attrs["theta"], data.attrs["barriers"]
    settings = rf"$\theta$ = {angle:.0f}°, barriers {left:g}, {right:g} meV, $\mu$ = 0"
    write(figure, 0.04, bottom - BETWEEN + 0.33, f"(b)  {settings}")
    _draw_maps(figure, data, bottom - BETWEEN)
    return figure


def _draw_ratios(axes: Axes, data: xr.Dataset) -> None:
    realizations, kinds = data["ratio"].shape
    for i, letter in enumerate(letters(data)):
        x = np.arange(kinds) + 0.5 * (i + 0.5 - realizations / 2) / realizations
        wrong = data["wrong_ratio"][i].to_numpy()
        label = "wrong disorder" if i == 0 else None
        at = np.broadcast_to(x, wrong.shape).ravel()
        axes.plot(at, wrong.ravel(), ".", color="0.6", ms=3, mew=0, label=label)
        marker = MARKERS[i % len(MARKERS)]
        axes.plot(
            x, data["ratio"][i], marker, color=PREDICTION, ms=4, label=f"prediction ({letter})"
        )
    axes.axhline(1.0, color="0.3", lw=0.6, dashes=(4, 2))
    left, right = data.attrs["barriers"]
    names = (
        "other $\\mu$ and $B$",
        r"other $V_\mathrm{bias}$",
        f"barriers {left:g}, {right:g} meV",
        rf"$\theta$ = {data.attrs['theta']:.0f}°",
    )
    axes.set_xticks(range(kinds), names)
    axes.set(yscale="log", xlim=(-0.5, kinds - 0.5), ylabel="mismatch relative to\nwrong disorder")
    low = min(float(data["ratio"].min()), float(data["wrong_ratio"].min()))
    axes.set_ylim(0.6 * low, 12.0)
    axes.legend(loc="upper center", ncols=realizations + 1, columnspacing=1.2, handletextpad=0.1)


def _draw_maps(figure: Figure, data: xr.Dataset, top: float) -> None:
    columns = len(CONDUCTANCES)
    width = (FULL_WIDTH - LEFT - RIGHT - (columns - 1) * GAP) / columns
    panels = np.empty((len(ROWS), columns), dtype=object)
    for (row, column), _ in np.ndenumerate(panels):
        G = data[CONDUCTANCES[column]]
        left, bottom = LEFT + column * (width + GAP), top - HEIGHT - row * (HEIGHT + GAP)
        axes = panels[row, column] = inches(figure, left, bottom, width, HEIGHT)
        draw_map(axes, G.isel(row=row), "bias", *conductance_scale(G))
        if row == 0:
            axes.set_title(symbol(str(G.name)))
        if row == len(ROWS) - 1:
            unit, words = conductance_unit(str(G.name))
            place = (left + 0.1, bottom - 0.36 - 0.13, width - 0.2, 0.07)
            bar = colour_bar(figure, place, *conductance_scale(G), G, unit)
            keep_labels_inside(bar.ax.xaxis)
            write(figure, left + width / 2, bottom - 0.36 - 0.31, f"$G$ {words}", ha="center")
    outer_labels(panels, "B", "bias")
    label_rows(panels, ROWS, "bias")


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments)


if __name__ == "__main__":
    main()
