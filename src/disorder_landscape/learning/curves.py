"""The curves of a training: one record per epoch, as CSV and as a plot."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from itertools import pairwise
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.files import replacing
from disorder_landscape.pictures import write_picture


@dataclass(frozen=True)
class Epoch:
    """What one epoch came to."""

    epoch: int
    """From 1."""
    set: int
    """Set of epochs with one learning rate (S-II.2), from 1."""
    learning_rate: float
    loss: float
    """Mean squared error of standard-scaled Y, averaged over the epoch while it trained."""
    validation_r2: float
    """R² on the test realizations after the epoch, predicted as the finished model predicts."""
    seconds: float
    """Time for the epoch's training and validation."""


def write_curves(path: Path, curves: list[Epoch]) -> None:
    """Write the curves as CSV."""
    with replacing(path) as temporary, open(temporary, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Epoch)])
        writer.writeheader()
        writer.writerows(asdict(epoch) for epoch in curves)


def read_curves(path: Path) -> list[Epoch]:
    """Read what `write_curves` wrote.

    Raises
    ------
    ArgumentError
        If it is something else.
    """
    try:
        with open(path, newline="", encoding="utf-8") as file:
            return [_epoch(row) for row in csv.DictReader(file, strict=True)]
    except (OSError, KeyError, TypeError, ValueError, csv.Error):
        must = "have the curves of a training in curves.csv"
        raise ArgumentError("model", must, f"'{path}' cannot be read") from None


def _epoch(row: Mapping[str, str]) -> Epoch:
    return Epoch(
        int(row["epoch"]),
        int(row["set"]),
        float(row["learning_rate"]),
        float(row["loss"]),
        float(row["validation_r2"]),
        float(row["seconds"]),
    )


def training_seconds(path: Path) -> float:
    """Return how long the training took whose curves are in this file."""
    return sum(epoch.seconds for epoch in read_curves(path))


def plot_curves(path: Path, curves: list[Epoch]) -> None:
    """Draw loss and 1 − R² over the epochs, on a logarithmic axis; path decides PDF or PNG."""
    figure = Figure(figsize=(3.404, 2.4), layout="constrained")
    axes = figure.add_subplot()
    epochs = [epoch.epoch for epoch in curves]
    axes.semilogy(epochs, [epoch.loss for epoch in curves], "o-", ms=3, lw=1, label="training loss")
    validation = [1 - epoch.validation_r2 for epoch in curves]
    axes.semilogy(epochs, validation, "s--", ms=3, lw=1, label="$1 - R^2$, test set")
    for before, after in pairwise(curves):
        if before.set != after.set:  # the learning rate is divided by 10 here
            axes.axvline(before.epoch + 0.5, color="0.7", lw=0.8, zorder=0)
    axes.set_xlabel("epoch", fontsize=8)
    axes.set_ylabel("standard-scaled error", fontsize=8)
    axes.tick_params(which="both", labelsize=8)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend(fontsize=8, frameon=False)
    write_picture(path, figure, dpi=300)
