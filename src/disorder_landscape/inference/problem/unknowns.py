"""What is unknown of a device, as one vector ξ of standard normal numbers.

The disorder is V = Lξ: with n components, these and the mean of V are a triangular matrix times ξ;
of the whole landscape, L holds the principal components of V's covariance. So the prior of ξ is
white noise. (The covariance of V itself has eigenvalues that are 2·10⁹ apart.) Parameters of the
device are functions of one ξ each (`distributions`).

The mean of V is none of the paper's labels (S-II.1). But a measurement does not state it, and it
shifts μ by more than kT.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_triangular

from disorder_landscape.arguments import require
from disorder_landscape.inference.problem.distributions import Distribution
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.problem.parameters import PARAMETERS, Setup, nanowire
from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.model.disorder import component_covariance, potential_from_components
from disorder_landscape.model.parameters import FloatArray, Nanowire

LEFT_OUT = 1e-3
"""In meV, root mean square over the sites: of the whole landscape, principal components that amount
to less than this together are left out, which is less than the error bar of any measurement so
far."""
FEW_PARAMETERS = 1
"""Of the device. Of more than these that are unknown the posterior may bend while V is sharp, and
wrong answers may fit. (Of 72 wires with six, one was 8.0 µeV off with an error bar of 1.0; that was
next to Γ = 0. Of 28 devices with eleven, and noise of 0.005 e²/h, two starts agreed on V 89 and
67 µeV off of two, which the noise explained.)"""


class Device(NamedTuple):
    """A wire, and the settings at which it is measured in truth."""

    wire: Nanowire
    setup: Setup

    def as_set_up(self, measurement: Measurement) -> Measurement:
        """Return a measurement at the settings that it has in truth."""
        setup = self.setup
        return replace(measurement, mu=setup.mu, bias=setup.bias, temperature=setup.temperature)


@dataclass(frozen=True, eq=False)
class Unknowns:
    """The unknowns of a prior: the disorder's first, then the parameters, as they enter.

    Parameters
    ----------
    prior : Prior
        With all parameters said (`Prior.for_measurement`).
    """

    prior: Prior

    @cached_property
    def _disorder(self) -> tuple[FloatArray, FloatArray]:
        """L (site, unknown), and the triangle (label, unknown) of components and mean, if any."""
        p = self.prior
        count = p.sites - 1 if p.components is None else p.components
        covariance = component_covariance(
            count, p.sites, p.correlation_length, noise_std=p.amplitude, mean_std=p.mean_std
        )
        to_sites = np.zeros((p.sites, count + 1))
        to_sites[:, :-1] = potential_from_components(np.eye(count), p.sites).T
        to_sites[:, -1] = 1.0
        if not self.is_whole_landscape:
            triangle = np.linalg.cholesky(covariance)
            return np.asarray(to_sites @ triangle), np.asarray(triangle)
        variance, axes = np.linalg.eigh(to_sites @ covariance @ to_sites.T)
        left_out = np.cumsum(np.maximum(variance, 0.0)) < LEFT_OUT**2 * p.sites
        kept = np.flatnonzero(~left_out)[::-1]
        return np.asarray(axes[:, kept] * np.sqrt(variance[kept])), np.empty((0, kept.size))

    @property
    def to_potential(self) -> FloatArray:
        """L of V = Lξ in meV, shape (site, number of the disorder's unknowns)."""
        return self._disorder[0]

    @property
    def of_disorder(self) -> int:
        """How many of the unknowns are the disorder's."""
        return int(self.to_potential.shape[1])

    @property
    def is_whole_landscape(self) -> bool:
        """Whether V of every site is unknown, and not a number of components."""
        return self.prior.components is None

    @cached_property
    def parameters(self) -> dict[str, Distribution]:
        """The parameters that are unknown, by name."""
        return self.prior.unknown

    @property
    def has_several_parameters(self) -> bool:
        """Whether more than FEW_PARAMETERS of the device are unknown."""
        return len(self.parameters) > FEW_PARAMETERS

    @cached_property
    def names(self) -> tuple[str, ...]:
        """One name each: c_1 …, mean, and the parameters; of a whole landscape V_1 … first."""
        n = self.of_disorder
        if self.is_whole_landscape:
            disorder = tuple(f"V_{k}" for k in range(1, n + 1))
        else:
            disorder = (*(f"c_{k}" for k in range(1, n)), "mean")
        return (*disorder, *self.parameters)

    @cached_property
    def white_noise(self) -> Gaussian:
        """What the prior is of ξ."""
        return Gaussian(np.zeros(len(self.names)), np.eye(len(self.names)))

    def potential(self, x: FloatArray) -> FloatArray:
        """Return V_dis in meV, shape (…, site)."""
        return np.asarray(x[..., : self.of_disorder] @ self.to_potential.T)

    def mirrored(self, x: FloatArray) -> FloatArray:
        """Return the unknowns (unknown,) of the wire with its ends exchanged."""
        found, n = x.copy(), self.of_disorder
        found[:n] = np.linalg.lstsq(self.to_potential, self.potential(x)[::-1], rcond=None)[0]
        left, right = (self.parameters.get(f"barrier_{end}") for end in ("left", "right"))
        if left is not None and right is not None:
            at = [self.names.index(f"barrier_{end}") for end in ("left", "right")]
            found[at] = left.standard(right.value(x[at[1]])), right.standard(left.value(x[at[0]]))
        return found

    def components(self, x: FloatArray) -> FloatArray:
        """Return c₁ … c_n in meV, shape (…, component)."""
        return np.asarray(x[..., : self.of_disorder] @ self._disorder[1][:-1].T)

    def parameter(self, name: str, x: FloatArray) -> FloatArray:
        """Return a parameter of the device, known or not, shape (…,)."""
        if name not in self.parameters:
            return np.full(x.shape[:-1], getattr(self.prior, name))
        return self.parameters[name].value(x[..., self.names.index(name)])

    def devices(self, X: FloatArray, measurement: Measurement) -> list[Device]:
        """Return the devices of samples X (sample, unknown), as they are measured."""
        fixed = self.prior.fixed
        values = [(one, self.parameter(one.name, X)) for one in PARAMETERS]
        found = []
        for k, V in enumerate(self.potential(X)):
            setup = Setup(measurement.mu, measurement.bias)
            for one, of_samples in values:
                one.enters(setup, float(of_samples[k]))
            found.append(Device(nanowire(V, setup, fixed), setup))
        return found

    def slopes(
        self, x: FloatArray, measurement: Measurement, by: Mapping[str, FloatArray]
    ) -> FloatArray:
        """Return derivatives by ξ at x, shape (…, unknown), from those by V and parameters.

        Parameters
        ----------
        x : array, shape (unknown,)
        measurement : Measurement
        by : mapping
            Derivatives by "V", with a last axis site, and by the `derivative` of each parameter
            that is unknown; the first axis is μ.
        """
        columns = [by["V"] @ self.to_potential]
        for one in PARAMETERS:
            if one.name not in self.parameters:
                continue
            slope = by[one.derivative]
            if one.of_measured_mu:
                slope = slope * measurement.mu.reshape(-1, *[1] * (slope.ndim - 1))
            at = x[self.names.index(one.name)]
            columns.append((slope * self.parameters[one.name].slope(at))[..., None])
        return np.concatenate(columns, axis=-1)

    @property
    def derivatives(self) -> list[str]:
        """By what conductances have to be differentiated for `slopes`."""
        of = {one.derivative for one in PARAMETERS if one.name in self.parameters}
        return ["V", *sorted(of)]

    @cached_property
    def alike(self) -> FloatArray:
        """Changes of ξ that change the conductances as 1 meV of V does, roughly (unknown,)."""
        rms = np.sqrt((self.to_potential**2).mean(axis=0))
        of_parameters = [
            one.alike / self.parameters[one.name].std
            for one in PARAMETERS
            if one.name in self.parameters
        ]
        return np.concatenate([1 / rms, of_parameters])

    @cached_property
    def _mean_square(self) -> FloatArray:
        return np.asarray(self.to_potential.T @ self.to_potential / self.prior.sites)

    def site_std(self, covariance: FloatArray) -> float:
        """Return the root mean square over the sites of the standard deviation of V in meV."""
        n = self.of_disorder
        mean_square = float((self._mean_square * covariance[:n, :n]).sum())
        return float(np.sqrt(max(0.0, mean_square)))

    def potential_std(self, covariance: FloatArray) -> FloatArray:
        """Return the standard deviation of V on each site in meV, shape (site,)."""
        n, L = self.of_disorder, self.to_potential
        variance = np.einsum("si,ij,sj->s", L, covariance[:n, :n], L)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))

    @property
    def label_std(self) -> FloatArray:
        """Standard deviations of the labels in the prior, shape (label,)."""
        disorder = np.sqrt((self._disorder[1] ** 2).sum(axis=1))
        return np.concatenate([disorder, [one.std for one in self.parameters.values()]])

    def label_slopes(self, x: FloatArray) -> FloatArray:
        """Return the derivatives of the labels by ξ at x, shape (label, unknown)."""
        n, slopes = self.of_disorder, np.zeros((x.size, x.size))
        slopes[:n, :n] = self._disorder[1]
        for k, (name, belief) in enumerate(self.parameters.items(), start=n):
            slopes[k, k] = belief.slope(x[self.names.index(name)])
        return slopes

    def vector(self, values: Mapping[str, FloatArray | float]) -> FloatArray:
        """Return the vectors (…, unknown) of named values; what is missing is the prior's middle.

        Raises
        ------
        ArgumentError
            If one of the values is no unknown.
        """
        unknown = [name for name in values if name not in self.names]
        must = f"predict some of {', '.join(self.names)}"
        require(not unknown, "model", must, f"it predicts {', '.join(unknown)}")
        shape, n = np.shape(next(iter(values.values()))), self.of_disorder
        x = np.zeros((*shape, len(self.names)))
        for name, value in values.items():
            k = self.names.index(name)
            x[..., k] = value if k < n else self.parameters[name].standard(value)
        triangle = self._disorder[1]
        given = n if "mean" in values else n - 1
        disorder = x[..., :given].reshape(-1, given).T
        x[..., :given] = solve_triangular(triangle[:given, :given], disorder, lower=True).T.reshape(
            *shape, given
        )
        return x


def share_settings(devices: Sequence[Device]) -> bool:
    """Return whether all devices are measured at the same settings."""
    first = devices[0].setup
    return all(
        one.setup.temperature == first.temperature
        and np.array_equal(one.setup.mu, first.mu)
        and np.array_equal(one.setup.bias, first.bias)
        for one in devices[1:]
    )
