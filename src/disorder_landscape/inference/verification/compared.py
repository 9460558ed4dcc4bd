"""What is compared with further measurements: the predicted wire, wrong disorder, and samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import xarray as xr

from disorder_landscape.arguments import number_in, require
from disorder_landscape.config import DatasetConfig
from disorder_landscape.inference.inferred import (
    Sample,
    as_calibrated,
    mean_wire,
    prior_of_result,
    samples_of,
    usual_settings_of,
)
from disorder_landscape.inference.problem.measured_dataset import check_wire, measurement_of
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.verification.comparison import LEAST_SAMPLES
from disorder_landscape.inference.verification.controls import (
    control_wires,
    disorder_model,
    wires_like,
)
from disorder_landscape.model.parameters import Nanowire
from disorder_landscape.model.ranges import PARAMETER_RANGES


class Compared(NamedTuple):
    """Wires and the measurements that they are compared with."""

    wires: Sequence[Nanowire]
    """The predicted one, and then those with wrong disorder."""
    measured: Sequence[Measurement]
    samples: Sequence[Sample] | None
    """Of an inversion's posterior; empty if it has too few to tell, and None of a guess."""


def compared(
    prediction: xr.Dataset,
    given: Sequence[xr.Dataset],
    controls: int,
    seed: int,
    config: DatasetConfig | None,
) -> Compared:
    """Return what is compared, of what an inversion has found or a network has guessed.

    Parameters
    ----------
    prediction : Dataset
    given : sequence of Dataset
        The measurements.
    controls, seed, config
        As in `verify`.

    Raises
    ------
    ArgumentError
        As in `verify`.
    """
    is_dataset = isinstance(prediction, xr.Dataset)
    is_old = is_dataset and "member" in prediction.dims
    must = "have the dim sample, if it is the result of an inversion"
    require(not is_old, "prediction", must, "an older version made it: run infer again")
    is_inversion = is_dataset and "potential_mean" in prediction.variables
    samples: Sequence[Sample] | None = None
    if is_inversion:
        usual = usual_settings_of(prediction)
        stated = [measurement_of(one, usual) for one in given]
        measured = [as_calibrated(prediction, one) for one in stated]
        predicted = mean_wire(prediction)
        enough = prediction.sizes.get("sample", 0) >= LEAST_SAMPLES
        samples = samples_of(prediction, stated) if enough else []
    else:
        measured = [measurement_of(dataset) for dataset in given]
        for measurement in measured:
            check_wire(measurement)
        predicted = _guessed_wire(prediction)
    if is_inversion and config is None:
        wrong = wires_like(predicted, prior_of_result(prediction), controls, seed)
        return Compared([predicted, *wrong], measured, samples)
    model = disorder_model(prediction, predicted, config)
    wrong = control_wires(model, controls, seed)
    if is_inversion:
        wrong = [replace(predicted, potential=one.potential, alpha=one.alpha) for one in wrong]
    else:
        predicted = replace(predicted, lead_mu=model.wire.lead_mu)
    return Compared([predicted, *wrong], measured, samples)


def _guessed_wire(prediction: xr.Dataset) -> Nanowire:
    """Return the wire that a network has predicted."""
    is_dataset = isinstance(prediction, xr.Dataset)
    must = "hold the potential and alpha of one wire, as `landscape predict` writes them"
    for name, dims in {"potential": ("site",), "alpha": ()}.items():
        is_there = is_dataset and name in prediction.variables
        require(is_there, "prediction", must, f"it lacks {name}")
        found = prediction[name].dims
        require(found == dims, "prediction", must, f"the dims of {name} are {found}")
    V, alpha = (prediction[name] for name in ("potential", "alpha"))
    return Nanowire(
        V.to_numpy(), alpha=number_in("alpha", alpha.to_numpy(), *PARAMETER_RANGES["alpha"])
    )
