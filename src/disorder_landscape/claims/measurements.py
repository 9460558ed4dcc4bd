"""Quick measurements of the claims: functions that return one number, by the names in claims.toml.

Here are those that only calculate with the paper's own numbers.
"""

from __future__ import annotations

from collections.abc import Callable

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.claims import (
    measurements_of_models,
    measurements_of_time,
    measurements_of_wires,
)
from disorder_landscape.claims.claim import Measured, paper_value


def core_hours_of_dataset(sets: float, realizations: str, seconds: str) -> float:
    """Return the core-hours of a dataset by the paper's numbers, given by the ids of its claims."""
    return sets * paper_value(realizations) * paper_value(seconds) / 3600


def core_hours_of_components(
    components: float, sets: float, prefactor: str, exponent: str, seconds: str
) -> float:
    """Return the core-hours for R² = 0.77 by the paper's own fit of Fig. 2 and time per set."""
    realizations = float(paper_value(prefactor) * components ** paper_value(exponent))
    return realizations * sets * paper_value(seconds) / 3600


MEASUREMENTS: dict[str, Callable[..., float]] = {
    function.__name__: function
    for function in (
        measurements_of_wires.components_required,
        measurements_of_wires.transition,
        measurements_of_wires.mean_spread,
        measurements_of_wires.r2_of_mean_from_components,
        measurements_of_wires.potential_spread_from_scores,
        core_hours_of_dataset,
        core_hours_of_components,
        measurements_of_time.kwant_set_seconds,
        measurements_of_time.speed_of_exact_set,
        measurements_of_time.parallel_efficiency,
        measurements_of_time.kwant_exponent,
        measurements_of_time.generation_over_training,
        measurements_of_models.model_score,
        measurements_of_models.loss_by_noise,
        measurements_of_models.conductance_match,
        measurements_of_models.visibility_match,
    )
}
"""What a claim can name, by name."""


def measure(source: Measured) -> float:
    """Return the value of a quick measurement.

    Raises
    ------
    ArgumentError
        If there is no such function, or it takes other arguments.
    """
    must = f"name one of {', '.join(MEASUREMENTS)}"
    if source.measure not in MEASUREMENTS:
        raise ArgumentError("measure", must, f"it is '{source.measure}'")
    return float(MEASUREMENTS[source.measure](**source.arguments))
