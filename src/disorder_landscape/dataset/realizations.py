"""What one realization is: a wire drawn from the disorder model, and its conductances (S-II.1)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import xarray as xr

from disorder_landscape.config import DatasetConfig, WireConfig
from disorder_landscape.model.disorder import disorder_realization
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.model.quantities import CONDUCTANCES, with_units
from disorder_landscape.observables.conductance import conductance

STORED_AS = {**dict.fromkeys((*CONDUCTANCES, "error"), np.float32), "energies": np.int32}
"""What files keep of the conductances, and in which precision."""


@dataclass(frozen=True, eq=False)
class Realization:
    """One Y: components c₁ … c_n (component) in meV, α in meV nm, V_dis(x) (site) in meV."""

    components: FloatArray
    alpha: float
    potential: FloatArray
    fixed: WireConfig
    """The wire's other parameters."""

    @property
    def wire(self) -> Nanowire:
        """The wire with this disorder."""
        return self.fixed.with_disorder(self.potential, self.alpha)


def realization(config: DatasetConfig, index: int) -> Realization:
    """Return realization `index`, a function of (seed, index) and the disorder model alone."""
    return drawn(config, np.random.default_rng([config.seed, index]))


def drawn(config: DatasetConfig, rng: np.random.Generator) -> Realization:
    """Return a realization of a dataset's disorder model, which need not be in the dataset."""
    alpha = rng.uniform(*config.alpha_range)
    components, potential = disorder_realization(
        rng, config.components, config.sites, config.correlation_length, config.amplitude
    )
    return Realization(components, alpha, potential, config.wire)


def simulate(config: DatasetConfig, indices: Iterable[int]) -> xr.Dataset:
    """Return the realizations with these indices and their conductances.

    Each wire is solved by itself, so that the numbers do not depend on its neighbours.

    Returns
    -------
    xarray.Dataset
        G_LL, G_RR, G_LR, G_RL (realization, mu, B, bias) as float32 in e²/h, components
        (realization, component) and potential (realization, site) in meV, alpha (realization) in
        meV nm. Exact averages also have what `conductance` says of them: error (realization, mu, B)
        as float32 in e²/h, and energies (realization, mu, B).
    """
    index = np.array(list(indices))
    wires = [realization(config, i) for i in index]
    solved = [
        conductance(
            one.wire,
            config.mu,
            config.B,
            config.bias,
            config.temperature,
            energy_spacing=config.energy_spacing,
        )
        for one in wires
    ]
    numbers = {name: STORED_AS[name] for name in STORED_AS if name in solved[0]}
    data = {
        **{
            name: (
                ("realization", *solved[0][name].dims),
                np.stack([of_wire[name].to_numpy().astype(kind) for of_wire in solved]),
            )
            for name, kind in numbers.items()
        },
        "components": (("realization", "component"), np.array([one.components for one in wires])),
        "alpha": ("realization", np.array([one.alpha for one in wires])),
        "potential": (("realization", "site"), np.array([one.potential for one in wires])),
    }
    coords = {
        "realization": index,
        "mu": config.mu,
        "B": config.B,
        "bias": np.array(config.bias),
        "component": np.arange(1, config.components + 1),
        "site": np.arange(config.sites),
    }
    return with_units(xr.Dataset(data, coords=coords))
