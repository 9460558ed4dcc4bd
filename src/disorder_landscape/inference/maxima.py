"""The maxima of a posterior: each is a wire of its own that explains the data."""

from __future__ import annotations

import numpy as np
import xarray as xr

from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.posterior.samples import posterior_shares
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.parameters import BY_NAME

MOST_OF_IT = 0.95
"""As many maxima are said as hold this share of the posterior together."""


def maxima_of(observation: Observation, outcome: Outcome) -> xr.Dataset:
    """Return the most probable wire, and those at the other maxima that hold most of the posterior.

    The others follow by their share. Where no wire explains the data there is the best one alone.

    Returns
    -------
    Dataset
        share (maximum) of the posterior; potential_maxima (maximum, site) in meV, and each unknown
        parameter (maximum) under its own name with _maxima.
    """
    optima = list(outcome.optima) if outcome.best.fits else [outcome.best]
    share = posterior_shares(observation, optima, outcome.importance_samples)
    by_share = np.argsort(-share, kind="stable").tolist()
    order = sorted(by_share, key=lambda k: optima[k] is not outcome.best)
    order = order[: 1 + np.searchsorted(np.cumsum(share[order]), MOST_OF_IT)]
    X = np.stack([optima[k].answer.mean for k in order])
    unknowns = observation.unknowns
    V = unknowns.potential(X)
    found = xr.Dataset(
        {
            "share": ("maximum", share[order]),
            "potential_maxima": (("maximum", "site"), V),
        }
    )
    for name in unknowns.parameters:
        one = BY_NAME[name]
        attrs = {"long_name": f"{one.long_name} at the maxima", "units": one.unit or "1"}
        found[f"{name}_maxima"] = ("maximum", unknowns.parameter(name, X), attrs)
    return found
