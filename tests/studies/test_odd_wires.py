"""The search among odd wires, of a few."""

import numpy as np
import pytest

from disorder_landscape import ArgumentError, Nanowire
from disorder_landscape.solver import compiled, kwant_reference
from disorder_landscape.studies.exact import exact_conductances
from disorder_landscape.studies.odd_cases import any_case, any_energy, warm_case
from disorder_landscape.studies.odd_wires import CLOSE, report
from disorder_landscape.studies.plan import load_study
from disorder_landscape.studies.runner import carry_out
from disorder_landscape.studies.study import Place

PLAN = """
kind = "odd_wires"
title = "a few"
kwant = 5
quadrature = 3
seed = 0
"""


def test_cases_are_drawn_from_their_index():
    one, again = any_case(3, 7), any_case(3, 7)
    np.testing.assert_array_equal(one.wire.potential, again.wire.potential)
    assert (one.mu, one.B, one.theta) == (again.mu, again.B, again.theta)
    for index in range(200):
        any_case(0, index)
        warm_case(0, index)


def test_the_search_goes_on_where_it_stopped_and_finds_nothing(tmp_path):
    plan, place = tmp_path / "few.toml", Place(tmp_path / "out", tmp_path / "build")
    plan.write_text(PLAN)
    found = carry_out(load_study(plan), place)
    assert found.passed
    assert "5 wires" in found.lines[0]
    table = load_study(plan).table(place)
    before = table.read_text().splitlines()
    plan.write_text(PLAN.replace("kwant = 5", "kwant = 6"))
    carry_out(load_study(plan), place)
    after = table.read_text().splitlines()
    assert len(after) == len(before) + 1
    assert set(before) <= set(after)


@pytest.mark.parametrize("index", range(8))
def test_the_solver_is_exact(index):
    """In numbers of 600 bits, tilted wires and wires with dissipation among them."""
    wire, mu, B, theta = any_case(20, index)
    omega = np.array([0.3 * wire.delta0])
    found = compiled.bare_conductance([wire], mu, B, omega, theta)[0, 0, 0, 0]
    np.testing.assert_allclose(
        found, exact_conductances(wire, mu[0], B[0], omega[0], theta), rtol=0, atol=1e-8
    )


@pytest.mark.parametrize("index", [12302, 3063, 6798])
def test_the_solver_is_right_where_kwant_is_not(index):
    """Kwant loses modes where a lead's energy is all but at a band edge."""
    wire, mu, B, theta = any_case(7, index)
    omega = np.array([1.2e-10 if index == 6798 else 0.0])
    exact = exact_conductances(wire, mu[0], B[0], omega[0], theta)
    found = compiled.bare_conductance([wire], mu, B, omega, theta)[0, 0, 0, 0]
    of_kwant = kwant_reference.bare_conductance([wire], mu, B, omega, theta)[0, 0, 0, 0]
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-12)
    assert abs(of_kwant - exact).max() > 1e-3


@pytest.mark.parametrize(("index", "omega"), [(884, 1.2e-10), (3705, 6.847e-11), (5926, 1.2e-10)])
def test_modes_of_tilted_leads_cross(index, omega):
    """In 10 µT and less, at a band edge, leads of modes that λ cannot tell apart were left out."""
    wire, mu, B, theta = any_case(7, index)
    found = compiled.bare_conductance([wire], mu, B, np.array([omega]), theta)[0, 0, 0, 0]
    exact = exact_conductances(wire, mu[0], B[0], omega, theta)
    np.testing.assert_allclose(found, exact, rtol=0, atol=CLOSE)


@pytest.mark.parametrize(
    ("seed", "index"),
    [(9, 10763), (9, 43697), (10, 1391), (10, 17354), (10, 23579), (10, 34188), (10, 36400)],
)
def test_leads_near_the_edge_of_a_wide_band(seed, index):
    """Where λ cannot tell four modes apart, or rounding opened a closed lead: up to 0.005 off."""
    wire, mu, B, theta = any_case(seed, index)
    omega = any_energy(seed, index)
    found = compiled.bare_conductance([wire], mu, B, omega, theta)[0, 0, 0, 0]
    exact = exact_conductances(wire, mu[0], B[0], omega[0], theta)
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-11)


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
    assert not report([{**apart, "true error": 1e-3, "of Kwant": 0.0}], [])[1]
    assert report([{**apart, "true error": 0.0, "of Kwant": 1e-3}], [])[1]
    assert report([{**apart, "unknown": 1e-4}], [])[1]
    off = {"index": 2, "error": 1e-3, "estimate": 1e-5, "integral": 1e-7}
    text, passed = report([], [off])
    assert not passed
    assert "accepted, of 1 " in text


def test_wrong_numbers_are_one_sentence(tmp_path):
    plan = tmp_path / "few.toml"
    plan.write_text(PLAN.replace("kwant = 5", "kwant = -1"))
    with pytest.raises(ArgumentError, match="kwant is wrong"):
        load_study(plan)
