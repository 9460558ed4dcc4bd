"""How many independent combinations of the disorder the data fix, from the Jacobian.

At a wire of the disorder model the derivatives of all conductances with respect to the unknowns
give the information that data with a certain noise hold. In units of the prior it has one
eigenvalue for each independent combination. Where it is above one, the data constrain that
combination more than the prior does. The posterior's standard deviation of V follows from the same
matrix. An answer that is unique in this sense may still have others far away.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.measurement import empty_measurement
from disorder_landscape.inference.problem.observation import Observation, noise_of_channels
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.search.gauss_newton import linearise
from disorder_landscape.model.parameters import FloatArray

NOISE = (0.001, 0.01, 0.1)
"""In e²/h; the first is the noise floor of the experiment that the paper cites."""
NARROW = 1e-12
"""Variance of a distribution across which the differences have their least length."""


@dataclass(frozen=True)
class Setting:
    """How many components a wire has, and on which grid it is measured."""

    components: int
    points: int
    """Of μ, and of B."""
    biases: int
    index: int
    """Of the wire."""

    @property
    def config(self) -> DatasetConfig:
        """The disorder model, and the grid within the paper's ranges."""
        return DatasetConfig(
            realizations=1,
            components=self.components,
            alpha_range=(8.0, 8.0),
            mu_points=self.points,
            B_points=self.points,
            bias=tuple(np.linspace(-0.04, 0.04, self.biases)),
            seed=1,
        )


def information_rows(setting: Setting) -> list[dict[str, float]]:
    """Return for each noise how many combinations the data fix, and how well V is known.

    Returns
    -------
    list of dict
        `unknowns`; `fixed`, how many combinations are known better by the data than by the prior;
        `spread` of the posterior and `prior_spread` in meV, root mean square over the sites.
    """
    config = setting.config
    unknowns = Unknowns(config)
    truth = unknowns.of_realization(realization(config, setting.index))
    slope = _slopes(unknowns, truth)
    prior = unknowns.prior.covariance
    root = np.linalg.cholesky(prior)
    rows = []
    for noise in NOISE:
        scaled = root.T @ slope / noise
        eigenvalues, axes = np.linalg.eigh(scaled @ scaled.T)
        turned = root @ axes
        posterior = (turned / (1 + np.maximum(eigenvalues, 0.0))) @ turned.T
        rows.append(
            {
                **vars(setting),
                "noise": noise,
                "unknowns": truth.size,
                "fixed": int((eigenvalues > 1).sum()),
                "spread": unknowns.site_std(posterior),
                "prior_spread": unknowns.site_std(prior),
            }
        )
    return rows


def _slopes(unknowns: Unknowns, truth: FloatArray) -> FloatArray:
    """Return the derivatives of all conductances (unknown, datum)."""
    observation = Observation(empty_measurement(unknowns.config), unknowns, noise_of_channels(0.0))
    return linearise(observation, Gaussian(truth, NARROW * np.eye(truth.size)))[1]
