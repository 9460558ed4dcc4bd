"""Simulate disordered Majorana nanowires, and read their disorder off their conductance.

A reproduction of Taylor, Sau and Das Sarma, "Machine Learning the Disorder Landscape of Majorana
Nanowires".
"""

from importlib import import_module
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
    from disorder_landscape.inference.draw_wires import draw_wires
    from disorder_landscape.inference.infer import infer
    from disorder_landscape.inference.inferred import sample_wires
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
    "draw_wires",
    "gap",
    "infer",
    "local_density_of_states",
    "modes",
    "predict",
    "sample_wires",
    "topological_visibility",
    "verify",
    "without_series_resistance",
]


_IMPORTED_LATER = {
    "Normal": ("inference", "inference.problem.distributions"),
    "Prior": ("inference", "inference.problem.prior"),
    "differentiable_conductance": ("learning", "learning.differentiable"),
    "draw_wires": ("inference", "inference.draw_wires"),
    "infer": ("inference", "inference.infer"),
    "predict": ("learning", "learning.prediction"),
    "sample_wires": ("inference", "inference.inferred"),
    "verify": ("inference", "inference.verify"),
    "without_series_resistance": ("inference", "inference.problem.series_resistance"),
}
"""What the simulator does not need and may lack: the part that it belongs to, and its module."""


def __getattr__(name: str) -> Any:
    """Import what may be lacking only when it is asked for."""
    if name not in _IMPORTED_LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    part, module = _IMPORTED_LATER[name]
    with needs(part):
        return getattr(import_module(f"{__name__}.{module}"), name)


def __dir__() -> list[str]:
    """Return the public names, so that Tab completes those that are imported later, too."""
    return __all__
