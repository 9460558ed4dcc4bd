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
from functools import cached_property
from typing import Any

import numpy as np

from disorder_landscape.inference.optimum import Optimum, chi_square_excess, is_noise
from disorder_landscape.inference.problem.observation import (
    Observation,
    overall_misfit,
    squared_misfits,
)
from disorder_landscape.inference.search.gauss_newton import ROUGHLY, Goal
from disorder_landscape.inference.search.parts import (
    Cut,
    exchanged,
    moved,
    redrawn,
    with_another_part,
)
from disorder_landscape.inference.search.small_steps import SmallSteps
from disorder_landscape.inference.search.steps import Steps
from disorder_landscape.inference.search.wires import Wire, best_of, objective_of, that_stay
from disorder_landscape.inference.stages import SMALL_STEPS, within
from disorder_landscape.inference.streams import Stream
from disorder_landscape.model.parameters import FloatArray

FEW, MORE = (24, 9, 7), (24, 9, 11)
"""Points of μ, B and bias, at most, of the data by which wires are compared: far from the true V,
and near it."""
DRAWS = 12, 300
"""Draws of the prior that a population begins with, and small steps from each."""
CHILDREN = (exchanged, 3), (moved, 5), (redrawn, 2)
"""So many wires of a generation get another part of each kind. Steps go on with the best of each
kind. (The best ones of all kinds would be those that have changed least: after 100 steps wires of
which a part has moved to where it is right have up to nine times the χ² of before.)"""
SMALL = 100, 300, 200
"""Small steps of each of them; of the best ones then; and of these, when nothing is held any more.
"""
FAR = Cut(
    redrawn=(1 / 30, 1 / 2),
    taken=(1 / 15, 2 / 3),
    seam=(1 / 60, 1 / 10),
    held=0.5,
)
NEAR = Cut(
    redrawn=(1 / 30, 1 / 5),
    taken=(1 / 15, 2 / 3),
    seam=(1 / 100, 1 / 100),
    held=0.1,
)
NEAR_CHILDREN, GO_ON = ((exchanged, 6), (redrawn, 2)), 3
"""The same where few Gauss–Newton steps follow at once; with so many of the best they go on."""
IS_NEAR, ALSO_NEAR = 1.5, 3.0
"""Gauss–Newton steps follow instead, when the mean square misfit of the best wire is less, in units
of the noise's; and of which of the others."""
APART_FAR, APART_NEAR = 0.25, 0.12
"""Of wires whose V differs by less, in standard deviations of the prior, root mean square over the
sites, only the best one stays."""
IDLE, STUCK = 2, (6, 10)
"""Generations end where so many have found no better wire: if the best one explains the data; and
if it does not, far and near. (Far, populations that arrived have found better ones in each.)"""
LEAVE = 300
"""Small steps that leave an optimum, towards others near it."""


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
    reports: int = 0
    """How often whom it tells has been told."""
    spread: float = 0.0
    """What it tells: the standard deviation of V among the wires in meV, as `Step.spread`."""
    wires: list[Wire] = field(default_factory=list)
    """The present generation."""

    @cached_property
    def few(self) -> Observation:
        """The data by which wires are compared far from the true V."""
        return self.observation.on_few_points(*FEW)

    @cached_property
    def more(self) -> Observation:
        """The data by which they are near it."""
        return self.observation.on_few_points(*MORE)

    def towards_optimum(self) -> tuple[FloatArray, Goal]:
        """Return the unknowns (unknown,) of the best wire found, and what steps may reach there."""
        self.wires = self._generation(0, self.few, self._drawn)
        number = self._far_generations(1)
        if self._is_far and self.others:
            wires = [*self.wires, *(Wire.at(self.few, one.x) for one in self.others)]
            self.wires = that_stay(self.observation.unknowns, wires, APART_FAR)
            number = self._far_generations(number)
        return (best_of(self.wires).x, "place") if self._is_far else self._near_generations(number)

    @property
    def _is_far(self) -> bool:
        return self._misfit(best_of(self.wires)) >= IS_NEAR

    def _far_generations(self, number: int) -> int:
        """Go on to the true V until no better wires are found; return the next one's number."""
        idle = 0
        while self._is_far and idle < STUCK[0]:
            best = best_of(self.wires)
            self.wires = self._generation(number, self.few, self._next_far)
            idle = _idle(idle, best, self.wires)
            number += 1
        return number

    def _near_generations(self, number: int) -> tuple[FloatArray, Goal]:
        """Do so near it; return unknowns (unknown,), and what steps may reach there."""
        self.wires, idle = self._generation(number, self.more, self._come_near), 0
        while idle < STUCK[1]:
            best = best_of(self.wires)
            if idle == IDLE and is_noise(chi_square_excess(self.more, best.data)):
                x = self._with_all_data(best.x, number)
                if x is not None:
                    return x, "optimum"
            number += 1
            follow = self._exchange_near if number % 2 else self._next_near
            self.wires = self._generation(number, self.more, follow)
            idle = _idle(idle, best, self.wires)
        return best_of(self.wires).x, "place"

    def from_optimum(self, optimum: Optimum) -> tuple[FloatArray, Goal]:
        """Leave an optimum by small steps."""

        def left(rng: np.random.Generator) -> list[Wire]:
            prior = self.observation.unknowns.white_noise
            small = SmallSteps(self.observation, prior, optimum.answer.mean)
            return [self._after(small, LEAVE, rng)]

        return self._generation(0, self.few, left)[0].x, "optimum"

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
        self.spread = float(np.sqrt(V.var(axis=0).mean()))
        return made or [Wire.at(data, np.array(x)) for x in found["x"]]

    def _name_of(self, part: int | str) -> str:
        return ".".join(["population", *map(str, self.name), str(part)])

    def _drawn(self, rng: np.random.Generator) -> list[Wire]:
        """Return wires to which small steps lead from draws of the prior."""
        count, steps = DRAWS
        prior, wires = self.observation.unknowns.white_noise, []
        for x in prior.draw_apart(rng, count):
            small = SmallSteps(self.observation, prior, x)
            wires.append(self._after(small, steps, rng))
        return that_stay(self.observation.unknowns, wires, APART_FAR)

    def _next_far(self, rng: np.random.Generator) -> list[Wire]:
        """Let small steps follow other parts."""
        wires = [*self.wires, *self._small_steps(rng)]
        return that_stay(self.observation.unknowns, wires, APART_FAR)

    def _small_steps(self, rng: np.random.Generator) -> list[Wire]:
        """Return the wires to which small steps lead from other parts: the best of each kind."""
        unknowns = self.observation.unknowns
        first, held, free = SMALL
        children = list[Wire]()
        for kind, count in CHILDREN:
            tried = []
            for _ in range(count):
                start = with_another_part(kind, unknowns, self.wires, FAR, rng)
                small = SmallSteps(self.observation, start.prior, start.x)
                tried.append((self._after(small, first, rng).objective, small))
            _, best = min(tried, key=lambda one: one[0])
            self._after(best, held, rng)
            best.prior = unknowns.white_noise
            children.append(self._after(best, free, rng))
        return children

    def _come_near(self, rng: np.random.Generator) -> list[Wire]:
        """Let Gauss–Newton steps follow."""
        best = best_of(self.wires)
        near = [one for one in self.wires if one is best or self._misfit(one) < ALSO_NEAR]
        return that_stay(
            self.observation.unknowns, [self._ended(one.x, "better") for one in near], APART_NEAR
        )

    def _next_near(self, rng: np.random.Generator) -> list[Wire]:
        """Let small steps and then Gauss–Newton steps follow other parts."""
        children = [self._ended(one.x, "better") for one in self._small_steps(rng)]
        return that_stay(self.observation.unknowns, [*self.wires, *children], APART_NEAR)

    def _exchange_near(self, rng: np.random.Generator) -> list[Wire]:
        """Let Gauss–Newton steps follow other parts."""
        unknowns = self.observation.unknowns
        starts = [
            with_another_part(kind, unknowns, self.wires, NEAR, rng).x
            for kind, count in NEAR_CHILDREN
            for _ in range(count)
        ]
        tried = sorted([self._ended(x, "few") for x in starts], key=objective_of)
        children = [self._ended(one.x, "better") for one in tried[:GO_ON]]
        return that_stay(self.observation.unknowns, [*self.wires, *children], APART_NEAR)

    def _after(self, small: SmallSteps, count: int, rng: np.random.Generator) -> Wire:
        """Return the wire after so many more small steps."""
        small.take(count, rng)
        wire = Wire.at(self.few, small.x)
        report = within(self.steps.progress, self.name[0], SMALL_STEPS)
        report(self.reports, overall_misfit(self.few, wire.data), self.spread)
        self.reports += 1
        return wire

    def _with_all_data(self, x: FloatArray, number: int) -> FloatArray | None:
        """Return where steps with all data end, if these are explained there."""
        name = self._name_of(f"{number}.all")
        end = self.steps.end(self.observation, x, self.name[0], name, goal="better").mean
        data = self.observation.simulate(end[None])[0]
        return end if is_noise(chi_square_excess(self.observation, data)) else None

    def _misfit(self, wire: Wire) -> float:
        """Return the mean square misfit far from the true V in units of the noise's."""
        return float(squared_misfits(self.few, wire.data).mean())

    def _ended(self, x: FloatArray, goal: Goal) -> Wire:
        """Return the wire where Gauss–Newton steps end."""
        return Wire.at(self.more, self.steps.end(self.more, x, self.name[0], goal=goal).mean)


def _idle(before: int, best: Wire, wires: list[Wire]) -> int:
    """Return how many generations have found no better wire, the last one included."""
    return 0 if best_of(wires).objective < best.objective - ROUGHLY else before + 1
