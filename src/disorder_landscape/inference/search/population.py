"""V of every site where µ is low: a population of wires that exchange parts.

Where V scatters electrons back at each µ, data tell first of the ends of the wire, and no way leads
from high µ to all. But wires to which small steps lead from draws of the prior become right at
their ends, each elsewhere. So they exchange parts, and parts of them are drawn anew; small steps
follow, and the better wires stay.

Near the true V, wires differ from it by a few wells each. Then Gauss–Newton steps with few data
follow, and exchange mends what another wire has right.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np

from disorder_landscape.inference.optimum import Optimum, chi_square_excess, is_noise
from disorder_landscape.inference.problem.observation import Observation
from disorder_landscape.inference.search.gauss_newton import ROUGHLY, Goal
from disorder_landscape.inference.search.generations import Generations
from disorder_landscape.inference.search.steps import Steps
from disorder_landscape.inference.search.wires import Wire, best_of
from disorder_landscape.inference.streams import Stream
from disorder_landscape.model.parameters import FloatArray

FEW, MORE = (24, 9, 7), (24, 9, 11)
"""Points of μ, B and bias, at most, of the data by which wires are compared: far from the true V,
and near it."""
IS_NEAR = 1.5
"""Gauss–Newton steps follow when the mean square misfit of the best wire is less, in units of the
noise's."""
IDLE, STUCK = 2, (6, 10)
"""Generations end where so many have found no better wire: if the best one explains the data; and
if it does not, far and near. (Far, populations that arrived have found better ones in each.)"""


@dataclass(eq=False)
class Population:
    """The search for a wire near the true one.

    Each generation has random numbers of its own, so that an interrupted search goes on alike.

    Parameters
    ----------
    observation : Observation
    steps : Steps
    seed : int
    name : tuple of int
        The number of this population, and that of a start from an optimum, if it is one.
    others : sequence of Wire
        Of former populations, which join where no better wires are found.
    """

    observation: Observation
    steps: Steps
    seed: int
    name: tuple[int, ...]
    others: Sequence[Wire] = ()
    wires: list[Wire] = field(default_factory=list)
    """The present generation."""
    joined: bool = False
    """Whether wires of former ones have, so that this is no attempt of its own."""

    @cached_property
    def few(self) -> Observation:
        """The data by which wires are compared far from the true V."""
        return self.observation.on_few_points(*FEW)

    @cached_property
    def more(self) -> Observation:
        """The data by which they are near it."""
        return self.observation.on_few_points(*MORE)

    @cached_property
    def next(self) -> Generations:
        """What follows the wires of a generation."""
        return Generations(self.observation, self.few, self.more, self.steps, self.name[0])

    def towards_optimum(self) -> tuple[FloatArray, Goal]:
        """Return the unknowns (unknown,) of the best wire found, and what steps may reach there."""
        self.wires = self._generation(0, self.few, self.next.drawn)
        number = self._far_generations(1)
        if self._is_far and self.others:
            wires = [*self.wires, *(Wire.at(self.few, one.x) for one in self.others)]
            self.wires, self.joined = self.next.that_stay_far(wires), True
            number = self._far_generations(number)
        return (best_of(self.wires).x, "place") if self._is_far else self._near_generations(number)

    @property
    def _is_far(self) -> bool:
        return self.next.misfit(best_of(self.wires)) >= IS_NEAR

    def _far_generations(self, number: int) -> int:
        """Go on to the true V until no better wires are found; return the next one's number."""
        idle = 0
        while self._is_far and idle < STUCK[0]:
            best = best_of(self.wires)
            follow = partial(self.next.by_small_steps, self.wires)
            self.wires = self._generation(number, self.few, follow)
            idle = _idle(idle, best, self.wires)
            number += 1
        return number

    def _near_generations(self, number: int) -> tuple[FloatArray, Goal]:
        """Do so near it; return unknowns (unknown,), and what steps may reach there."""
        far, idle = self.wires, 0
        self.wires = self._generation(number, self.more, lambda rng: self.next.come_near(far))
        while idle < STUCK[1]:
            best = best_of(self.wires)
            if idle == IDLE and is_noise(chi_square_excess(self.more, best.data)):
                x = self._with_all_data(best.x, number)
                if x is not None:
                    return x, "optimum"
            number += 1
            kind = self.next.near_by_exchange if number % 2 else self.next.near_by_small_steps
            self.wires = self._generation(number, self.more, partial(kind, self.wires))
            idle = _idle(idle, best, self.wires)
        return best_of(self.wires).x, "place"

    def from_optimum(self, optimum: Optimum) -> tuple[FloatArray, Goal]:
        """Leave an optimum by small steps."""
        follow = partial(self.next.left, optimum.answer.mean)
        return self._generation(0, self.few, follow)[0].x, "optimum"

    def _generation(
        self,
        number: int,
        data: Observation,
        make: Callable[[np.random.Generator], list[Wire]],
    ) -> list[Wire]:
        """Return the wires of a generation, from an interrupted run or made now."""
        rng = np.random.default_rng([self.seed, Stream.SEARCH, *self.name, number])
        made = list[Wire]()

        def calculate() -> dict[str, Any]:
            made.extend(make(rng))
            return {"x": [one.x.tolist() for one in made]}

        found = self.steps.cache(self._name_of(number), calculate)
        V = self.observation.unknowns.potential(np.array(found["x"]))
        self.next.spread = float(np.sqrt(V.var(axis=0).mean()))
        return made or [Wire.at(data, np.array(x)) for x in found["x"]]

    def _name_of(self, part: int | str) -> str:
        return ".".join(["population", *map(str, self.name), str(part)])

    def _with_all_data(self, x: FloatArray, number: int) -> FloatArray | None:
        """Return where steps with all data end, if these are explained there."""
        name = self._name_of(f"{number}.all")
        end = self.steps.end(self.observation, x, self.name[0], name, goal="better").mean
        data = self.observation.simulate(end[None])[0]
        return end if is_noise(chi_square_excess(self.observation, data)) else None


def _idle(before: int, best: Wire, wires: list[Wire]) -> int:
    """Return how many generations have found no better wire, the last one included."""
    return 0 if best_of(wires).objective < best.objective - ROUGHLY else before + 1
