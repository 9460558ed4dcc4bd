"""Resistances in series with the leads, and how they are taken away again."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import disorder_landscape as dl
from disorder_landscape import ArgumentError
from disorder_landscape.inference.problem.measured_numbers import QUANTUM
from disorder_landscape.inference.problem.series_resistance import in_series
from disorder_landscape.model.quantities import CONDUCTANCES

AXES = {"mu": [0.1, 0.3], "B": [0.2, 0.5, 0.6], "bias": [-0.02, 0.02]}
CONDUCTANCE = arrays(float, (3, 4), elements=st.floats(0, 2))
RESISTANCE = st.floats(0, 5e3)


@pytest.fixture(scope="module")
def wire():
    V = 0.3 * np.random.default_rng(3).normal(size=60)
    return dl.conductance(dl.Nanowire(V), **AXES).drop_vars("error", errors="ignore")


def behind(G, left, right):
    """Return the dataset of a wire that is measured through resistances."""
    stacked = np.stack([G[name].to_numpy() for name in CONDUCTANCES], axis=-1)
    found = in_series((left, right), stacked)
    arrays = {name: found[..., k] for k, name in enumerate(CONDUCTANCES)}
    return G.assign({name: (G[name].dims, of, G[name].attrs) for name, of in arrays.items()})


@given(CONDUCTANCE, RESISTANCE, RESISTANCE, RESISTANCE, RESISTANCE)
def test_resistances_in_series_add_up(G, left, right, more_left, more_right):
    one_after_the_other = in_series((more_left, more_right), in_series((left, right), G))
    both = in_series((left + more_left, right + more_right), G)
    np.testing.assert_allclose(one_after_the_other, both, atol=1e-12)


def test_a_lead_without_the_other_is_in_series_with_its_resistance():
    G = np.array([0.5, 2.0, 0.0, 0.0])
    found = in_series((1 / QUANTUM, 3 / QUANTUM), G)
    np.testing.assert_allclose(found, [1 / (1 / 0.5 + 1), 1 / (1 / 2.0 + 3), 0, 0])


@given(CONDUCTANCE, RESISTANCE, RESISTANCE)
def test_kirchhoffs_laws_hold(G, left, right):
    """For each lead's voltage: four equations for the currents, and the voltages at the wire."""
    for LL, RR, LR, RL in G:
        conducts = QUANTUM * np.array([[LL, -LR], [-RL, RR]])
        laws = np.block([[np.eye(2), -conducts], [np.diag([left, right]), np.eye(2)]])
        currents = np.linalg.solve(laws, np.vstack([np.zeros((2, 2)), np.eye(2)]))[:2] / QUANTUM
        expected = [currents[0, 0], currents[1, 1], -currents[0, 1], -currents[1, 0]]
        np.testing.assert_allclose(
            in_series((left, right), np.array([LL, RR, LR, RL])), expected, atol=1e-9
        )


def test_what_was_measured_through_resistances_is_that_of_the_wire_again(wire):
    """… at a gate voltage too, and whatever the order of the axes is."""
    measured = behind(wire, 4e3, 7e3)
    assert abs(measured["G_LL"] - wire["G_LL"]).max() > 0.02
    found = dl.without_series_resistance(measured, 4e3, 7e3)
    xr.testing.assert_allclose(found, wire, atol=1e-12)
    assert found["G_LR"].attrs == wire["G_LR"].attrs
    assert found.attrs == wire.attrs
    gate = measured.rename(mu="gate").transpose("bias", "gate", "B").isel(B=slice(None, None, -1))
    found = dl.without_series_resistance(gate, 4e3, 7e3)
    np.testing.assert_allclose(found["G_RL"], wire["G_RL"], atol=1e-12)
    np.testing.assert_allclose(found["gate"], wire["mu"])


def test_what_is_missing_stays_so_and_counts_as_zero(wire):
    """… which is a small mistake: nonlocal conductances enter squared."""
    measured = behind(wire, 1e3, 1e3)
    local = dl.without_series_resistance(measured[["G_LL", "G_RR"]], 1e3, 1e3)
    assert set(local) == {"G_LL", "G_RR"}
    for name in local:
        np.testing.assert_allclose(local[name], wire[name], atol=3e-3)
    measured["G_LR"][0, 1, 1] = np.nan
    measured["G_LL"][1, 1, 1] = np.nan
    found = dl.without_series_resistance(measured, 1e3, 1e3)
    for name in CONDUCTANCES:
        np.testing.assert_array_equal(np.isnan(found[name]), np.isnan(measured[name]))
        there = np.isfinite(found[name]).to_numpy()
        np.testing.assert_allclose(found[name].data[there], wire[name].data[there], atol=5e-3)


def test_biases_without_data_are_left_out(wire):
    scalar = behind(wire, 1e3, 1e3).where(wire["bias"] > 0).isel(mu=0)
    found = dl.without_series_resistance(scalar, 1e3, 1e3)
    np.testing.assert_allclose(found["G_LL"], wire["G_LL"][:1, :, 1:], atol=1e-12)


@pytest.mark.parametrize(
    ("change", "left", "message"),
    [
        (lambda G: G, -1.0, "left must be a number from 0 to 1e"),
        (lambda G: G, 9e5, "must be less than the resistance that was measured in all"),
        (lambda G: QUANTUM * G, 1e3, "as if they were in siemens"),
        (lambda G: G.drop_vars("bias"), 1e3, "it lacks bias"),
    ],
)
def test_bad_input_is_said_in_one_sentence(wire, change, left, message):
    with pytest.raises(ArgumentError, match=message):
        dl.without_series_resistance(change(wire), left, 0.0)
