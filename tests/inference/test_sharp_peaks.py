"""A short wire without pairing, whose conductances are few and sharp peaks."""

import numpy as np

import disorder_landscape as dl
from disorder_landscape.inference.verdict import CONVERGED
from disorder_landscape.model.disorder import disorder_realization
from disorder_landscape.model.quantities import CONDUCTANCES

SITES, COMPONENTS, NOISE = 20, 2, 0.001


def test_it_is_found_where_rounds_lead_nowhere():
    """… and so is its mirror image, since without pairing nothing tells the two apart."""
    V = disorder_realization(np.random.default_rng(3), COMPONENTS, SITES)[1]
    wire = dl.Nanowire(V, gamma=0.0)
    bias = np.array([-0.03, 0.0, 0.03])
    G = dl.conductance(wire, np.linspace(0, 0.6, 10), np.linspace(0, 0.7, 10), bias)
    rng = np.random.default_rng(103)
    for name in CONDUCTANCES:
        G[name] += NOISE * rng.normal(size=G[name].shape)
    found = dl.infer(G.drop_attrs(), dl.Prior(COMPONENTS, SITES, gamma=0.0), NOISE, samples=8)
    assert found.attrs["verdict"] == CONVERGED
    off = [abs(one - V).max() for one in found["potential_maxima"].to_numpy()]
    assert min(off) < 0.003
    assert np.allclose(found["potential_maxima"][0], found["potential_maxima"][1, ::-1], atol=1e-3)
