"""The shipped Kwant reference: the fast solver reproduces it, and it is what it says it is."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from disorder_landscape import Nanowire, conductance, topological_visibility
from disorder_landscape.dataset.store import read_dataset
from disorder_landscape.model.quantities import CONDUCTANCES
from disorder_landscape.runs import REPOSITORY

REFERENCE = read_dataset(Path(REPOSITORY) / "data_small" / "kwant_reference.nc")
GRID = {name: REFERENCE[name].to_numpy() for name in ("mu", "B", "bias")}


@pytest.mark.parametrize("index", range(REFERENCE.sizes["realization"]))
def test_the_fast_solver_reproduces_the_kwant_reference(index):
    stored = REFERENCE.isel(realization=index)
    wire = Nanowire(stored.potential, alpha=stored.alpha.item())
    G = conductance(wire, **GRID, temperature=0)
    for name in CONDUCTANCES:
        assert_allclose(G[name], stored[name], atol=1e-8)
    T = topological_visibility(wire, GRID["mu"], GRID["B"])
    assert_allclose(T, stored.T_IV, atol=1e-7)


def test_kwant_still_gives_the_stored_reference():
    stored = REFERENCE.isel(realization=2, mu=[1], B=[2])
    wire = Nanowire(stored.potential, alpha=stored.alpha.item())
    G = conductance(wire, 0.15, 0.5, GRID["bias"], temperature=0, solver="kwant")
    for name in CONDUCTANCES:
        assert_allclose(G[name], stored[name], atol=1e-10)
    assert np.ptp(stored.potential.to_numpy()) > 0.1
