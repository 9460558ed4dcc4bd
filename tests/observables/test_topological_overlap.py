"""At how many chemical potentials and fields wires are topological, and both of a pair."""

import numpy as np

from disorder_landscape import Nanowire
from disorder_landscape.observables import topological_overlap
from disorder_landscape.observables.topological_overlap import topological_points


def test_a_wire_agrees_with_itself_and_not_with_one_far_off_in_mu(monkeypatch):
    monkeypatch.setattr(topological_overlap, "POINTS", (9, 9))
    wire, far = (Nanowire(np.full(300, V)) for V in (0.0, 9.0))
    both, either = topological_points([wire], [wire], 1.2, 1.2)
    assert 0 < both == either < 81
    assert topological_points([wire, wire], [far, wire], 1.2, 1.2) == (both, 2 * either)


def test_below_the_transition_no_wire_is_topological(monkeypatch):
    monkeypatch.setattr(topological_overlap, "POINTS", (5, 5))
    wire = Nanowire(np.zeros(300))
    assert topological_points([wire], [wire], 1.2, 0.1) == (0, 0)
