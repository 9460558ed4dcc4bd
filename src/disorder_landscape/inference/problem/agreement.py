"""Whether what is known and what was measured go together."""

from __future__ import annotations

import numpy as np

from disorder_landscape.arguments import require
from disorder_landscape.inference.problem.distributions import Belief
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.model.parameters import gap_in_field


def check_agreement(name: str, belief: Belief, stated: float | None) -> None:
    """Require that prior and measurement do not say different things of a parameter."""
    if stated is None:
        return
    if isinstance(belief, float):
        must = f"be {belief:g}, as in the prior"
        same = bool(np.isclose(stated, belief, rtol=1e-6, atol=1e-12))
        require(same, name, must, f"the measurement states {stated:g}")
        return
    low, high = belief.range
    must = f"lie from {low:g} to {high:g}, as in the prior"
    require(low <= stated <= high, name, must, f"the measurement states {stated:g}")


def check_biases(
    measurement: Measurement, delta0: float, critical_field: float, offset: float
) -> None:
    """Require that all biases lie below the gap, of the least Δ₀ and B_c and the largest offset."""
    field, largest = (float(abs(axis).max()) for axis in (measurement.B, measurement.bias))
    least = gap_in_field(delta0, critical_field, field)
    must = "lie below the least gap that the parent superconductor may have, offset included"
    but = (
        f"{largest:.4g} + {offset:.4g} meV is not below {least:.4g} meV at {field:g} T: leave "
        "such biases out, or narrow the prior of delta0, critical_field or bias_offset"
    )
    require(largest + offset < least, "bias", must, but)
