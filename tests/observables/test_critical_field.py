"""A gap that closes with the field: at each field a wire is that of the gap that is left."""

import numpy as np
import pytest
import xarray as xr

from disorder_landscape import (
    ArgumentError,
    Nanowire,
    conductance,
    conductance_gradient,
    gap,
    local_density_of_states,
    modes,
    topological_visibility,
)

V = np.random.default_rng(3).normal(0, 0.2, 40)
ALUMINIUM = Nanowire(V, critical_field=1.0)
FIELDS = [0.0, 0.3, 0.6]
CALLS = {
    "bare": lambda wire, B: conductance(wire, [0.1, 0.3], B, [-0.02, 0.05], temperature=0.0),
    "exact": lambda wire, B: conductance(wire, [0.1, 0.3], B, [-0.02, 0.0], temperature=0.05),
    "hot": lambda wire, B: conductance(wire, 0.1, B, 0.02, temperature=0.2),
    "tilted": lambda wire, B: conductance(wire, 0.1, B, 0.0, temperature=0.03, theta=0.2),
    "Kwant": lambda wire, B: conductance(wire, 0.1, B, 0.02, temperature=0.0, solver="kwant"),
    "visibility": lambda wire, B: topological_visibility(wire, [0.1, 0.3], B).to_dataset(),
    "density": lambda wire, B: local_density_of_states(wire, [0.1, 0.3], B, [0.0, 0.09, 0.12]),
    "warm density": lambda wire, B: local_density_of_states(wire, 0.1, B, 0.1, temperature=0.1),
}


@pytest.mark.parametrize("name", CALLS)
def test_each_field_has_a_wire_of_its_own(name):
    found = CALLS[name](ALUMINIUM, FIELDS)
    for k, field in enumerate(FIELDS):
        left = Nanowire(V, delta0=0.12 * np.sqrt(1 - field**2))
        xr.testing.assert_allclose(found.isel(B=[k]), CALLS[name](left, field), rtol=1e-12)


def test_modes_and_gaps_are_those_of_the_gap_that_is_left():
    left = Nanowire(V, delta0=0.12 * 0.8)
    np.testing.assert_allclose(
        modes(ALUMINIUM, 0.1, 0.6, 2).level, modes(left, 0.1, 0.6, 2).level, atol=2e-12
    )
    found, expected = gap(ALUMINIUM, 0.1, [0.3, 0.6]), gap(left, 0.1, 0.6)
    for name in ("E_1", "E_2", "excitation_gap", "transport_gap"):
        assert float(found[name][0, 1]) == pytest.approx(expected[name].item(), abs=2e-12)


def test_several_wires_have_a_gap_each():
    wires = [ALUMINIUM, Nanowire(V)]
    both = conductance(wires, 0.1, FIELDS, 0.01)
    for k, wire in enumerate(wires):
        xr.testing.assert_allclose(both.isel(realization=k), conductance(wire, 0.1, FIELDS, 0.01))


@pytest.mark.parametrize("B", [1.0, -1.5, [0.0, 0.99999]])
def test_beyond_the_critical_field_is_one_sentence(B):
    says = (
        r"B must stay below the critical field of 1 T, where the gap closes, but at .* T it is less"
    )
    for call in CALLS.values():
        with pytest.raises(ArgumentError, match=says):
            call(ALUMINIUM, B)


def test_a_bias_beyond_the_gap_that_is_left_is_one_sentence():
    with pytest.raises(ArgumentError, match=r"bias must lie between -0\.0359"):
        conductance(Nanowire(V, critical_field=1.0), 0.1, 0.954, 0.05)


def test_what_has_no_slopes_is_one_sentence():
    with pytest.raises(ArgumentError, match="have no critical field for slopes"):
        conductance_gradient(ALUMINIUM, 0.1, 0.3, temperature=0)
