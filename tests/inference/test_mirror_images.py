"""Data that a wire and its mirror image explain alike: both are in the answer."""

import re

import numpy as np
import pytest

import disorder_landscape as dl
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.report import summary, verdict_sentence
from disorder_landscape.inference.verdict import CONVERGED
from disorder_landscape.model.disorder import disorder_realization

SITES, COMPONENTS = 60, 3
V = disorder_realization(np.random.default_rng(1), COMPONENTS, SITES)[1]


@pytest.mark.parametrize("components", [COMPONENTS, None])
def test_the_mirror_image_of_a_wire_has_its_potential_backwards(components):
    ends = {"barrier_left": (10.0, 40.0), "barrier_right": (8.0, 45.0)}
    prior = dl.Prior(components, 20, alpha=8.0, **ends)
    values = dict.fromkeys(("g", "gamma", "delta0", "temperature", "lever_arm"), 1.0)
    prior = dl.Prior.from_mapping(prior.to_dict() | values)
    unknowns = Unknowns(prior)
    x = 0.3 * np.random.default_rng(0).normal(size=len(unknowns.names))
    image = unknowns.mirrored(x)
    np.testing.assert_allclose(unknowns.potential(image), unknowns.potential(x)[::-1], atol=1e-9)
    right = unknowns.parameter("barrier_right", x)
    np.testing.assert_allclose(unknowns.parameter("barrier_left", image), right, atol=1e-6)
    np.testing.assert_allclose(unknowns.mirrored(image), x, atol=1e-6)


def test_both_are_found_where_the_data_do_not_tell_them_apart():
    """Nonlocal conductances without a bias are equal, and those of both."""
    wire = dl.Nanowire(V)
    G = dl.conductance(wire, np.linspace(0, 0.6, 7), np.linspace(0, 0.8, 7), 0.0)
    rng = np.random.default_rng(9)
    for name in ("G_LR", "G_RL"):
        G[name] += 0.001 * rng.normal(size=G[name].shape)
    found = dl.infer(G[["G_LR", "G_RL"]], dl.Prior(COMPONENTS, SITES), noise=0.001)
    assert found.attrs["verdict"] == CONVERGED
    potentials = found["potential"].to_numpy()
    off = [abs(potentials - one).max(axis=1) < 0.02 for one in (V, V[::-1])]
    assert off[0].mean() == pytest.approx(0.5, abs=0.2)
    assert off[1].mean() == pytest.approx(0.5, abs=0.2)
    assert abs(found["potential_mean"] - (V + V[::-1]) / 2).max() < 0.1
    assert found["share"].to_numpy() == pytest.approx([0.5, 0.5], abs=0.2)
    assert found["share"][0] >= found["share"][1]
    one, other = found["potential_maxima"].to_numpy()
    np.testing.assert_allclose(one, other[::-1], atol=1e-3)
    shares = r"\d\d and \d\d % of the posterior"
    begins = f"Converged: 2 wires explain the data within their noise, with {shares}; V is known"
    assert re.match(begins, verdict_sentence(found))
    assert re.search(f"maxima          2, with {shares}; the mean", "\n".join(summary(found)))
