"""Wires that are drawn from a prior: to see what a measurement would tell of them."""

from __future__ import annotations

import numpy as np

from disorder_landscape.arguments import require, shown, whole_number_in
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.model.parameters import TEMPERATURE, Nanowire

MOST = 100_000
"""Wires at a time."""


def draw_wires(prior: Prior, count: int = 1, seed: int = 0) -> list[Nanowire]:
    """Return wires that are drawn from a prior.

    Their V, and what else of a wire the prior leaves unknown, are random; what it does not say is
    the paper's. The same seed gives the same wires.

    Parameters
    ----------
    prior : Prior
        What it says of the measurement (temperature, offsets, lever arm) has no effect.
    count : int
        How many, up to 100,000.
    seed : int

    Raises
    ------
    ArgumentError
        If the prior is something else, a number is out of range, or nothing could conduct.
    """
    require(isinstance(prior, Prior), "prior", "be a Prior", f"it is {shown(prior)}")
    count = whole_number_in("count", count, 1, MOST)
    rng = np.random.default_rng(whole_number_in("seed", seed, 0, 2**53))
    zero = np.zeros(1)
    barrier = Nanowire.barrier
    nothing = Measurement(np.zeros((1, 1, 1, 4)), zero, zero, zero, 0.0, barrier, TEMPERATURE)
    unknowns = Unknowns(prior.for_measurement(nothing))
    X = unknowns.white_noise.draw_apart(rng, count)
    return [device.wire for device in unknowns.devices(X, nothing)]
