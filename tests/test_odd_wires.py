"""The search among odd wires, of a few."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "results"))  # as if run as a script

import odd_wires
from exact import exact_conductances

from disorder_landscape import Nanowire
from disorder_landscape.solver import compiled, kwant_reference


def test_cases_are_drawn_from_their_index():
    one, again = odd_wires.any_case(3, 7), odd_wires.any_case(3, 7)
    np.testing.assert_array_equal(one.wire.potential, again.wire.potential)
    assert (one.mu, one.B, one.theta) == (again.mu, again.B, again.theta)
    for index in range(200):
        odd_wires.any_case(0, index)
        odd_wires.warm_case(0, index)


def test_the_search_goes_on_where_it_stopped_and_finds_nothing(tmp_path, capsys):
    with pytest.raises(SystemExit) as first:
        odd_wires.main(["--count", "5", "--warm", "3", "--build", str(tmp_path)])
    assert first.value.code == 0
    assert "5 wires" in capsys.readouterr().out
    files = sorted(tmp_path.iterdir())
    before = [path.read_text() for path in files]
    with pytest.raises(SystemExit):
        odd_wires.main(["--count", "6", "--warm", "3", "--build", str(tmp_path)])
    after = [path.read_text() for path in files]
    assert after[0].startswith(before[0])
    assert after[1].startswith(before[1])


@pytest.mark.parametrize("index", range(8))
def test_the_solver_is_exact(index):
    """In numbers of 600 bits, tilted wires and wires with dissipation among them."""
    wire, mu, B, theta = odd_wires.any_case(20, index)
    omega = np.array([0.3 * wire.delta0])
    found = compiled.bare_conductance([wire], mu, B, omega, theta)[0, 0, 0, 0]
    np.testing.assert_allclose(
        found, exact_conductances(wire, mu[0], B[0], omega[0], theta), rtol=0, atol=1e-8
    )


@pytest.mark.parametrize("index", [12302, 3063, 6798])
def test_the_solver_is_right_where_kwant_is_not(index):
    """Kwant loses modes where a lead's energy is all but at a band edge."""
    wire, mu, B, theta = odd_wires.any_case(7, index)
    omega = np.array([1.2e-10 if index == 6798 else 0.0])
    exact = exact_conductances(wire, mu[0], B[0], omega[0], theta)
    found = compiled.bare_conductance([wire], mu, B, omega, theta)[0, 0, 0, 0]
    of_kwant = kwant_reference.bare_conductance([wire], mu, B, omega, theta)[0, 0, 0, 0]
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-12)
    assert abs(of_kwant - exact).max() > 1e-3


@pytest.mark.parametrize(("index", "omega"), [(884, 1.2e-10), (3705, 6.847e-11), (5926, 1.2e-10)])
def test_modes_of_tilted_leads_cross(index, omega):
    """In 10 µT and less, at a band edge, leads of modes that λ cannot tell apart were left out."""
    wire, mu, B, theta = odd_wires.any_case(7, index)
    found = compiled.bare_conductance([wire], mu, B, np.array([omega]), theta)[0, 0, 0, 0]
    exact = exact_conductances(wire, mu[0], B[0], omega, theta)
    np.testing.assert_allclose(found, exact, rtol=0, atol=odd_wires.CLOSE)


@pytest.mark.parametrize("B", np.geomspace(1e-14, 1e-3, 12))
@pytest.mark.parametrize("energy", [0.0, 1e-12, 1e-8, 1e-4])
def test_tilted_leads_at_a_band_edge(B, energy):
    wire = Nanowire(np.array([0.3, -0.2]), lead_mu=0.0, barrier=(0.0, 0.0))
    arguments = np.array([0.1]), np.array([B]), np.array([energy]), 0.7
    found = compiled.bare_conductance([wire], *arguments)[0, 0, 0, 0]
    exact = exact_conductances(wire, 0.1, B, energy, 0.7)
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-7)


@pytest.mark.parametrize(("B", "g"), [(4e-14, 35.0), (-0.2, 0.05), (0.6, 0.006), (0.1, 1.0)])
def test_leads_at_the_crossing_of_their_spins(B, g):
    """At μ_lead = 0 modes in and out meet at k = 0, but for V_Z: G_LL was off by 0.6."""
    wire = Nanowire(np.random.default_rng(4).normal(0, 0.5, 30), lead_mu=0.0, lead_g=g, gamma=0.7)
    for theta in (-1.4, 2.5):
        arguments = np.array([0.2]), np.array([B]), np.zeros(1), theta
        found = compiled.bare_conductance([wire], *arguments)[0, 0, 0, 0]
        exact = exact_conductances(wire, 0.2, B, 0.0, theta)
        np.testing.assert_allclose(found, exact, rtol=0, atol=1e-7)


def test_what_is_wrong_fails():
    apart = {"index": 1, "error": 1e-3, "unknown": 0.0, "omega": 0.0}
    assert not odd_wires.report([{**apart, "true error": 1e-3, "of Kwant": 0.0}], [])[1]
    assert odd_wires.report([{**apart, "true error": 0.0, "of Kwant": 1e-3}], [])[1]
    assert odd_wires.report([{**apart, "unknown": 1e-4}], [])[1]
    off = {"index": 2, "error": 1e-3, "estimate": 1e-5, "integral": 1e-7}
    text, passed = odd_wires.report([], [off])
    assert not passed
    assert "accepted, of 1 " in text


def test_wrong_arguments_are_one_sentence(capsys):
    with pytest.raises(SystemExit) as end:
        odd_wires.main(["--count", "-1"])
    assert end.value.code == 2
    assert "Argument count must not be negative" in capsys.readouterr().err
