"""Figure 1: the convolutional network, drawn from the Keras model.

A box is what a layer gives: its height and depth are the points in μ and B, its slices those in
V_bias, and a slice is the thicker the more filters there are. Kernels are written above the
convolutions. The preset decides how wide the network is; the default is the paper's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from command import Request, figure_script
from disorder_landscape.learning.networks.build import build_network
from disorder_landscape.learning.scaling import CHANNELS, label_names
from disorder_landscape.symbols import symbol
from plotting import FULL_WIDTH, inches
from solids import DEPTH, draw_box

COLOURS = {
    "InputLayer": "#D5D5D5",
    "Conv3D": "#6FB7E5",
    "Conv2D": "#4DB88E",
    "MaxPooling3D": "#EDB64A",
    "MaxPooling2D": "#EDB64A",
    "Dense": "#D79BBB",
}
"""Of the layers that are drawn: light tints of Okabe and Ito's."""
LEGEND = {
    "Conv3D": "3D convolution, ReLU",
    "Conv2D": "2D convolution, ReLU",
    "MaxPooling3D": "batch normalization, max pooling",
    "Dense": "dense",
}
RESHAPINGS = {"Reshape": "reshape", "Flatten": "flatten"}
"""Drawn as arrows."""
AXES = 4
"""μ, B, V_bias, channels."""
HEIGHT, MIDDLE, TEXT = 2.2, 1.14, 0.29
"""Of the figure, of the boxes' centres, and of the text below them, in inches."""
LARGEST, DEPTH_SHARE, THICKEST, THINNEST = 1.0, 0.52, 0.13, 0.02
"""Height of the largest box, depth by height, and extremes of a slice's thickness, in inches."""
LEFT, PITCH, GAP = 0.4, 0.18, 0.14
"""Left margin, and room after a box within a set and after a set, in inches."""

SMALL_TEXT: dict[str, Any] = {"fontsize": 8, "linespacing": 1.1}


@dataclass(frozen=True)
class Layer:
    """One layer: Keras' class, and what it gives, convolves and pools, without the zeros."""

    kind: str
    shape: tuple[int, ...]
    kernel: tuple[int, ...]
    pool: tuple[int, ...]


def data(request: Request) -> xr.Dataset:
    """Build the preset's network, untrained, and return the table of its layers.

    Returns
    -------
    xarray.Dataset
        As `layer_table`, with the coordinate label, and the width fraction and the number of
        parameters as attributes.
    """
    dataset, fraction = request.config.dataset, request.config.network.width_fraction
    labels = label_names(dataset.components, dataset.alpha_is_label)
    grid = (dataset.mu_points, dataset.B_points, len(dataset.bias), len(CHANNELS))
    model = build_network(grid, len(labels), fraction)
    table = layer_table(model).assign_coords(label=list(labels))
    return table.assign_attrs(width_fraction=fraction, parameters=model.count_params())


def layer_table(model: Any) -> xr.Dataset:
    """Read a Keras model's layers.

    Returns
    -------
    xarray.Dataset
        Along layer: kind (Keras' class) and name; along layer and axis: shape, kernel and pool,
        filled up with 0 where a layer has fewer axes or no such thing.
    """
    sizes = {
        "shape": [layer.output.shape[1:] for layer in model.layers],
        "kernel": [getattr(layer, "kernel_size", ()) for layer in model.layers],
        "pool": [getattr(layer, "pool_size", ()) for layer in model.layers],
    }
    filled = {
        name: (("layer", "axis"), np.array([[*row, *[0] * (AXES - len(row))] for row in rows]))
        for name, rows in sizes.items()
    }
    kinds = [type(layer).__name__ for layer in model.layers]
    names = [layer.name for layer in model.layers]
    return xr.Dataset({"kind": ("layer", kinds), "name": ("layer", names), **filled})


def draw(data: xr.Dataset) -> Figure:
    """Draw the figure."""
    figure = Figure(figsize=(FULL_WIDTH, HEIGHT))
    axes = inches(figure, 0, 0, FULL_WIDTH, HEIGHT)
    axes.set(xlim=(0, FULL_WIDTH), ylim=(0, HEIGHT))
    axes.axis("off")
    layers = [layer for layer in _layers(data) if layer.kind in COLOURS | RESHAPINGS]
    maps = [layer.shape for layer in layers if len(layer.shape) > 1]
    per_point = LARGEST / max(shape[0] for shape in maps)
    per_root = THICKEST / max(shape[-1] for shape in maps) ** 0.5
    x = LEFT
    for (kind, _), equal in groupby(layers[:-1], key=lambda layer: (layer.kind, layer.shape)):
        if kind in RESHAPINGS:
            x = _draw_reshaping(axes, RESHAPINGS[kind], x)
        else:
            x = _draw_set(axes, list(equal), x, per_point, per_root)
    _draw_output(axes, [str(label) for label in data["label"].to_numpy()], x)
    _draw_input_axes(axes, layers[0], per_point, per_root)
    _draw_legend(figure, data)
    return figure


def _layers(data: xr.Dataset) -> list[Layer]:
    columns = [data[name].to_numpy() for name in ("kind", "shape", "kernel", "pool")]
    return [
        Layer(str(kind), *(tuple(int(n) for n in row if n) for row in rows))
        for kind, *rows in zip(*columns, strict=True)
    ]


def _times(sizes: Sequence[int]) -> str:
    return "×".join(str(n) for n in sizes)


def _draw_set(
    axes: Axes, layers: list[Layer], x: float, per_point: float, per_root: float
) -> float:
    """Draw layers of one kind and shape side by side; return where the next set begins."""
    first, start = layers[0], x
    slices, width, height, depth = _box(first, per_point, per_root)
    bottom = MIDDLE - height / 2
    for layer in layers:
        for i in range(slices):
            corner = (x + i * width / slices, bottom)
            draw_box(axes, corner, (width / slices, height, depth), COLOURS[layer.kind])
        if layer.kernel:
            above = (x + (width + DEPTH[0] * depth) / 2, bottom + height + DEPTH[1] * depth + 0.04)
            axes.text(*above, _times(layer.kernel), ha="center", va="bottom", **SMALL_TEXT)
        x += width + PITCH
    x += DEPTH[0] * depth - PITCH
    _write_below(axes, (start + x) / 2, _described(first))
    return x + GAP


def _draw_reshaping(axes: Axes, name: str, x: float) -> float:
    """Draw an arrow; return where the next set begins."""
    arrow = {"arrowstyle": "->", "lw": 0.7, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (x + 0.2, MIDDLE), (x - 0.06, MIDDLE), arrowprops=arrow)
    axes.text(x + 0.07, MIDDLE - 0.28, name, ha="center", va="baseline", **SMALL_TEXT)
    return x + 0.26


def _write_below(axes: Axes, x: float, lines: tuple[str, str]) -> None:
    for line, y in zip(lines, (TEXT, TEXT - 0.14), strict=True):
        axes.text(x, y, line, ha="center", va="baseline", **SMALL_TEXT)


def _box(layer: Layer, per_point: float, per_root: float) -> tuple[int, float, float, float]:
    """Return the number of slices, and width, height and depth in inches."""
    if len(layer.shape) == 1:
        return 1, 0.1, 0.8 * LARGEST, 0.1
    mu, B, *bias, channels = layer.shape
    slices = bias[0] if bias else 1
    thickness = max(THINNEST, per_root * channels**0.5)
    return slices, slices * thickness, mu * per_point, DEPTH_SHARE * B * per_point


def _described(layer: Layer) -> tuple[str, str]:
    """Return what stands below a set."""
    if layer.pool:
        return "pool", _times(layer.pool)
    if layer.kind == "Dense":
        return "dense", str(layer.shape[0])
    named = "channels" if layer.kind == "InputLayer" else "filters"
    return _times(layer.shape[:-1]), f"{layer.shape[-1]} {named}"


def _draw_output(axes: Axes, labels: list[str], x: float) -> None:
    """Draw one circle per label Y."""
    pitch = min(0.2, LARGEST * 1.2 / len(labels))
    for i, label in enumerate(labels):
        y = MIDDLE + ((len(labels) - 1) / 2 - i) * pitch
        name = r"$\alpha$" if label == "alpha" else f"${label}$"
        axes.plot(x + 0.06, y, "o", ms=60 * pitch, mfc=COLOURS["Dense"], mec="k", mew=0.5)
        axes.text(x + 0.18, y, name, ha="left", va="center", **SMALL_TEXT)
    _write_below(axes, x + 0.12, ("labels", str(len(labels))))


def _draw_input_axes(axes: Axes, layer: Layer, per_point: float, per_root: float) -> None:
    """Name the axes of the input's box, and its channels."""
    _, width, height, depth = _box(layer, per_point, per_root)
    bottom = MIDDLE - height / 2
    axes.text(LEFT - 0.05, MIDDLE, r"$\mu$", ha="right", va="center")
    axes.text(LEFT + width / 2, bottom - 0.03, r"$V_\mathrm{bias}$", ha="right", va="top")
    back = (LEFT + width + DEPTH[0] * depth / 2 + 0.05, bottom + DEPTH[1] * depth / 2 - 0.03)
    axes.text(*back, "$B$", ha="left", va="top")
    top = bottom + height + DEPTH[1] * depth + 0.04
    names = [symbol(name) for name in CHANNELS]
    text = ", ".join(names[:2]) + ",\n" + ", ".join(names[2:])
    axes.text(LEFT - 0.3, top, text, ha="left", va="bottom", **SMALL_TEXT)


def _draw_legend(figure: Figure, data: xr.Dataset) -> None:
    handles = [Patch(fc=COLOURS[kind], ec="k", lw=0.5, label=LEGEND[kind]) for kind in LEGEND]
    width = data.attrs["width_fraction"]
    figure.legend(
        handles=handles,
        loc="upper right",
        title=f"width fraction {width:g}, {data.attrs['parameters'] / 1e6:.3g} million parameters",
        title_fontsize=8,
        ncols=2,
        columnspacing=1.0,
        handlelength=1.0,
        borderaxespad=0.2,
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments, preset="paper")


if __name__ == "__main__":
    main()
