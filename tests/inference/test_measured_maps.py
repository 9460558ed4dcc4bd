"""What is said of wires that were really measured, where the data are there.

Local conductances of both ends of an InSb wire over B and bias, at one gate voltage (published with
arXiv:2004.08583). Superconductivity is soft there, so that no wire of the model is like it.
"""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import disorder_landscape as dl
from disorder_landscape.inference.inferred import prior_of_result
from disorder_landscape.inference.search.few_unknowns import InversionSettings
from disorder_landscape.inference.verdict import CONVERGED

MEASURED = Path(__file__).parents[3] / "shared" / "measured"
ENDS = {"G_LL": "Fig3a.mtx", "G_RR": "Fig3b.mtx"}
B, BIAS = np.linspace(0, 1.4, 8), np.linspace(-0.2, 0.2, 5)
PRIOR = dl.Prior(
    components=3,
    sites=60,
    alpha=(5, 50),
    g=(20, 60),
    gamma=(0.1, 1.5),
    delta0=(0.5, 1.0),
    temperature=(0.04, 0.3),
    barrier_left=(2, 40),
    barrier_right=(2, 40),
    dissipation=(0.0, 0.1),
    bias_offset=(-0.05, 0.05),
    mu_offset=(-2, 5),
    lever_arm=1.0,
)

pytestmark = pytest.mark.skipif(not MEASURED.exists(), reason="the measured maps are not here")


def conductance_of(name):
    """Return a Spyview map in e²/h; its header has the ranges of B and of the bias in 10 µeV."""
    with (MEASURED / name).open("rb") as file:
        ranges = [part.strip() for part in file.readline().decode().split(",")]
        fields, biases, *_ = map(int, file.readline().split())
        map_ = 2 * np.fromfile(file, "<f8").reshape(fields, biases)
    at_B = np.linspace(float(ranges[3]), float(ranges[4]), fields)
    at_bias = 0.01 * np.linspace(float(ranges[6]), float(ranges[7]), biases)
    return xr.DataArray(map_, {"B": at_B, "bias": at_bias}, ("B", "bias")).interp(B=B, bias=BIAS)


def test_a_real_wire_is_not_said_to_be_understood():
    """… and the best that can be said of it is within the prior and explains a part."""
    both = xr.Dataset({name: conductance_of(file) for name, file in ENDS.items()})
    measured = both.expand_dims(gate=[0.0])
    found = dl.infer(measured, PRIOR, noise=0.02, settings=InversionSettings(attempts=1))
    assert found.attrs["verdict"] != CONVERGED
    for name, belief in prior_of_result(found).unknown.items():
        assert belief.low <= found[f"{name}_mean"] <= belief.high
    for channel, name in enumerate(ENDS):
        assert 0.02 < found["misfit"][channel] < float(measured[name].std())
    assert np.isnan(found["misfit"][2:]).all()
    assert found["T_IV"].dims == ("lead", "map_gate", "map_B")
