"""Kind "uniqueness": how many independent combinations of the disorder the data fix.

At a wire of the disorder model the derivatives of all conductances with respect to the unknowns
give the information that data with a certain noise hold. In units of the prior it has one
eigenvalue for each independent combination; where it is above one, the data tell more of that
combination than was known before. The posterior's standard deviation of V follows from the same
matrix: an answer that is unique in this sense may still have others far away.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from disorder_landscape.config import DatasetConfig, Positive
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.inference.problem.measurement import empty_measurement
from disorder_landscape.inference.problem.noise import noise_of_channels
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.search.gauss_newton import linearise
from disorder_landscape.model.parameters import TEMPERATURE, FloatArray
from disorder_landscape.studies.study import Part, Place, Plan
from disorder_landscape.studies.truth import of_realization, unknowns_of


@dataclass(frozen=True, order=True)
class Setting:
    """How many components a wire has, and on which grid it is measured."""

    components: int
    points: int
    """Of μ, and of B."""
    biases: int
    temperature: float
    """In K."""
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
            temperature=self.temperature,
            seed=1,
        )


class Grids(Part):
    """So many wires of each number of components, on each of some grids."""

    components: tuple[Positive, ...]
    points: tuple[Positive, ...]
    """Of μ, and of B."""
    biases: tuple[Positive, ...]
    temperature: tuple[Annotated[float, Field(gt=0, le=1)], ...] = (TEMPERATURE,)
    """In K."""
    count: Positive
    """Of wires."""


class UniquenessPlan(Plan):
    """What the data fix of the disorder, over components, grids and noise."""

    kind: Literal["uniqueness"]
    noise: tuple[Annotated[float, Field(gt=0, le=1)], ...]
    """In e²/h."""
    grids: tuple[Grids, ...]

    keys: ClassVar = ("components", "points", "biases", "temperature", "index")
    common: ClassVar = ("noise",)

    def tasks(self) -> Sequence[Setting]:
        """Return the settings in order."""
        return sorted(
            Setting(components, points, biases, temperature, index)
            for group in self.grids
            for components in group.components
            for points in group.points
            for biases in group.biases
            for temperature in group.temperature
            for index in range(group.count)
        )

    def rows(self, task: Setting, place: Place) -> list[dict[str, object]]:
        """Return a row for each noise."""
        return information_rows(task, self.noise)


def information_rows(setting: Setting, noises: Iterable[float]) -> list[dict[str, object]]:
    """Return for each noise how many combinations the data fix, and how well V is known.

    Returns
    -------
    list of dict
        `unknowns`; `fixed`, how many combinations are known better by the data than by the prior;
        `spread` of the posterior and `prior_spread` in meV, root mean square over the sites.
    """
    config = setting.config
    unknowns = unknowns_of(config)
    truth = of_realization(unknowns, realization(config, setting.index))
    slope = _slopes(config, unknowns, truth)
    prior = unknowns.white_noise.covariance
    root = np.linalg.cholesky(prior)
    rows: list[dict[str, object]] = []
    for noise in noises:
        scaled = root.T @ slope / noise
        eigenvalues, axes = np.linalg.eigh(scaled @ scaled.T)
        turned = root @ axes
        posterior = (turned / (1 + np.maximum(eigenvalues, 0.0))) @ turned.T
        rows.append(
            {
                **asdict(setting),
                "noise": noise,
                "unknowns": truth.size,
                "fixed": int((eigenvalues > 1).sum()),
                "spread": round(unknowns.site_std(posterior), 7),
                "prior_spread": round(unknowns.site_std(prior), 7),
            }
        )
    return rows


def _slopes(config: DatasetConfig, unknowns: Unknowns, truth: FloatArray) -> FloatArray:
    """Return the derivatives of all conductances (unknown, datum)."""
    observation = Observation(empty_measurement(config), unknowns, noise_of_channels(0.0))
    return linearise(observation, truth)[1]
