"""Random wires and random points, for hypothesis."""

from __future__ import annotations

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

from disorder_landscape import Nanowire
from disorder_landscape.model.disorder import disorder_realization

settings.register_profile("default", deadline=None, derandomize=True)
settings.load_profile("default")


def random_wire(seed: int, sites: int = 300) -> Nanowire:
    """Return a wire of one of five kinds: pristine, 5, 10, 30 components, uncorrelated noise."""
    rng = np.random.default_rng([2, seed])
    kind = rng.integers(5)
    strength = rng.choice(["sum", "double"])
    if kind == 0:
        V = np.zeros(sites)
    elif kind == 4:
        V = rng.normal(0.0, rng.uniform(0.1, 2.0), sites)
    else:
        components = min((5, 10, 30)[kind - 1], sites - 1)
        V = disorder_realization(rng, components, sites, amplitude=strength)[1]
    return Nanowire(V, alpha=rng.uniform(6.4, 9.6))


seeds = st.integers(0, 2**32 - 1)
mus = st.floats(0.0, 0.6)
fields = st.floats(0.0, 0.8)
energies = st.floats(0.0, 0.11)
