"""What a dataset states of the wires in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from disorder_landscape.arguments import number_in, require
from disorder_landscape.model.parameters import Nanowire
from disorder_landscape.model.ranges import PARAMETER_RANGES, STATED

OF_ALL_NETWORKS = tuple(name for name in STATED if name not in ("alpha", "lead_mu"))
"""Those that all wires of this program's networks have in common."""


def stated(wires: Sequence[Nanowire]) -> dict[str, Any]:
    """Return the parameters that wires have in common, by name."""
    each = {name: [getattr(wire, name) for wire in wires] for name in (*STATED, "barrier")}
    each["parent_dissipation"] = [wire.dissipation_of_parent for wire in wires]
    return {name: values[0] for name, values in each.items() if len(set(values)) == 1}


def check_wire_of_networks(said: Mapping[str, Any]) -> None:
    """Require that what is stated of a wire agrees with all wires of the networks.

    Raises
    ------
    ArgumentError
        If one of OF_ALL_NETWORKS has another value, or none that a wire can have.
    """
    for name in OF_ALL_NETWORKS:
        usual = getattr(Nanowire, name)
        value = number_in(name, said.get(name, usual), *PARAMETER_RANGES[name])
        must = f"be {usual:g}, as in all wires that networks here have seen"
        require(bool(np.isclose(value, usual)), name, must, f"the measurement's is {value:g}")
