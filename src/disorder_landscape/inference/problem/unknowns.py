"""What is unknown of a wire, as one vector: c₁ … c_n, α where it varies, and the mean of V.

The mean of V is none of the paper's labels (S-II.1). But a measurement does not state it, and it
shifts μ by more than kT.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from disorder_landscape.arguments import require
from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset.realizations import Realization
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.model.disorder import component_covariance, potential_from_components
from disorder_landscape.model.parameters import PARAMETER_RANGES, FloatArray, Nanowire


@dataclass(frozen=True, eq=False)
class Unknowns:
    """The unknowns of a disorder model, in the order c₁ … c_n, α where it varies, mean of V.

    Parameters
    ----------
    config : DatasetConfig
        Of the dataset that the network was trained on: disorder model, range of α, leads.
    """

    config: DatasetConfig

    @property
    def names(self) -> tuple[str, ...]:
        """One name each, as those of the network's labels."""
        components = tuple(f"c_{n}" for n in range(1, self.config.components + 1))
        return (*components, *(["alpha"] if self.config.alpha_is_label else []), "mean")

    @cached_property
    def prior(self) -> Gaussian:
        """The disorder model's distribution; of α, which is uniform, the mean and the variance."""
        c, n = self.config, self.config.components
        covariance = np.zeros((len(self.names), len(self.names)))
        disorder = [*range(n), len(self.names) - 1]
        covariance[np.ix_(disorder, disorder)] = component_covariance(
            n, c.sites, c.correlation_length, c.amplitude
        )
        mean = np.zeros(len(self.names))
        if c.alpha_is_label:
            low, high = c.alpha_range
            mean[n], covariance[n, n] = (low + high) / 2, (high - low) ** 2 / 12
        return Gaussian(mean, covariance)

    def components(self, x: FloatArray) -> FloatArray:
        """Return c₁ … c_n in meV, shape (…, component)."""
        return x[..., : self.config.components]

    def alpha(self, x: FloatArray) -> FloatArray:
        """Return α in meV nm, shape (…,), within the range that a wire accepts."""
        if not self.config.alpha_is_label:
            return np.full(x.shape[:-1], self.config.alpha_range[0])
        return np.asarray(np.clip(x[..., self.config.components], *PARAMETER_RANGES["alpha"][:2]))

    def alpha_std(self, covariance: FloatArray) -> float:
        """Return the standard deviation of α in meV nm, zero where it is known."""
        n = self.config.components
        return float(np.sqrt(covariance[n, n])) if self.config.alpha_is_label else 0.0

    def potential(self, x: FloatArray) -> FloatArray:
        """Return V_dis in meV, shape (…, site)."""
        return potential_from_components(self.components(x), self.config.sites, x[..., -1])

    def wires(self, X: FloatArray, barrier: tuple[float, float]) -> list[Nanowire]:
        """Return the wires of samples X (sample, unknown)."""
        return [
            Nanowire(V, alpha=alpha, barrier=barrier, lead_mu=self.config.wire.lead_mu)
            for V, alpha in zip(self.potential(X), self.alpha(X), strict=True)
        ]

    def site_std(self, covariance: FloatArray) -> float:
        """Return the root mean square over the sites of the standard deviation of V in meV.

        The cosine basis is orthonormal, so that the components alone give it.
        """
        n = self.config.components
        of_components = np.trace(covariance[:n, :n]) / self.config.sites
        return float(np.sqrt(of_components + covariance[-1, -1]))

    def site_distance(self, x: FloatArray, other: FloatArray) -> float:
        """Return the root-mean-square difference of two potentials in meV."""
        return self.site_std(np.outer(x - other, x - other))

    def of_realization(self, one: Realization) -> FloatArray:
        """Return the unknowns of a realization, shape (unknown,)."""
        values = {f"c_{n}": c for n, c in enumerate(one.components, start=1)}
        values |= {"alpha": np.asarray(one.alpha)} if self.config.alpha_is_label else {}
        return self.vector({**values, "mean": one.potential.mean()})

    def vector(self, values: dict[str, FloatArray]) -> FloatArray:
        """Return the vectors (…, unknown) of named values; what is missing is the prior's mean.

        Raises
        ------
        ArgumentError
            If one of the values is no unknown.
        """
        unknown = [name for name in values if name not in self.names]
        must = f"predict some of {', '.join(self.names)}"
        require(not unknown, "model", must, f"it predicts {', '.join(unknown)}")
        shape = np.shape(next(iter(values.values())))
        x = np.broadcast_to(self.prior.mean, (*shape, len(self.names))).copy()
        for name, value in values.items():
            x[..., self.names.index(name)] = value
        return x
