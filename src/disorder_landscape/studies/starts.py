"""Kind "starts": the same measurement inverted from the network's guess, and from the prior alone.

If a conductance profile has one disorder landscape, both end in the same answer, whatever network
there is. Seeds differ: each start has attempts of its own.
"""

from __future__ import annotations

from typing import Literal

from disorder_landscape.studies.fresh_wires import (
    FreshWiresPlan,
    Task,
    fresh_wire,
    inverted,
    network_of,
)
from disorder_landscape.studies.rows import rounded
from disorder_landscape.studies.study import Place

STARTS = ("network", "prior")
OTHER_SEEDS = 2**20
"""Added to the seed of an inversion from the prior alone."""


class StartsPlan(FreshWiresPlan):
    """Inversions of fresh wires from two starts."""

    kind: Literal["starts"]

    def rows(self, task: Task, place: Place) -> list[dict[str, object]]:
        """Invert the measurement of a fresh wire from both starts.

        Returns
        -------
        list of dict
            `apart`, the root-mean-square difference of both potentials in meV; of each start, how
            far its answer is off, `network_error` and `prior_error`, and the outcome of `Inverted`,
            as `network_spread`, `prior_spread` and so on.
        """
        observation, truth = fresh_wire(task)
        distance = observation.unknowns.site_distance
        from_network = inverted(observation, network_of(task.model, task.noise), task.index)
        found = from_network, inverted(observation, None, OTHER_SEEDS + task.index)
        row: dict[str, object] = {"model": task.model, "noise": task.noise, "index": task.index}
        row["apart"] = distance(found[0].answer.mean, found[1].answer.mean)
        for start, one in zip(STARTS, found, strict=True):
            row[f"{start}_error"] = distance(one.answer.mean, truth)
            row |= {f"{start}_{name}": value for name, value in one.outcome.items()}
        return [rounded(row)]
