"""Simulate disordered Majorana nanowires, and read their disorder off their conductance.

A reproduction of Taylor, Sau and Das Sarma, "Machine Learning the Disorder Landscape of Majorana
Nanowires".
"""

from typing import TYPE_CHECKING, Any

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.model.parameters import Nanowire
from disorder_landscape.observables.conductance import conductance
from disorder_landscape.observables.density_of_states import local_density_of_states
from disorder_landscape.observables.gap import gap
from disorder_landscape.observables.gradient import conductance_gradient
from disorder_landscape.observables.modes import modes
from disorder_landscape.observables.visibility import topological_visibility
from disorder_landscape.parts import MissingPartError, needs

if TYPE_CHECKING:
    from disorder_landscape.inference.infer import infer
    from disorder_landscape.inference.problem.distributions import Normal
    from disorder_landscape.inference.problem.prior import Prior
    from disorder_landscape.inference.problem.series_resistance import without_series_resistance
    from disorder_landscape.inference.verify import verify
    from disorder_landscape.learning.differentiable import differentiable_conductance
    from disorder_landscape.learning.prediction import predict

__all__ = [
    "ArgumentError",
    "MissingPartError",
    "Nanowire",
    "Normal",
    "Prior",
    "conductance",
    "conductance_gradient",
    "differentiable_conductance",
    "gap",
    "infer",
    "local_density_of_states",
    "modes",
    "predict",
    "topological_visibility",
    "verify",
    "without_series_resistance",
]


def __getattr__(name: str) -> Any:
    """Import what the simulator does not need, and may lack, only when it is asked for."""
    if name == "infer":
        with needs("inference"):
            from disorder_landscape.inference.infer import infer
        return infer
    if name in ("Normal", "Prior"):
        with needs("inference"):
            from disorder_landscape.inference.problem import distributions, prior
        return {"Normal": distributions.Normal, "Prior": prior.Prior}[name]
    if name == "differentiable_conductance":
        with needs("learning"):
            from disorder_landscape.learning.differentiable import differentiable_conductance
        return differentiable_conductance
    if name == "predict":
        with needs("learning"):
            from disorder_landscape.learning.prediction import predict
        return predict
    if name == "verify":
        from disorder_landscape.inference.verify import verify

        return verify
    if name == "without_series_resistance":
        from disorder_landscape.inference.problem.series_resistance import without_series_resistance

        return without_series_resistance
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
